"""What hangs on the axis, against closed forms."""

import math

import numpy as np
import pytest
from physics_samples import commanded, disc, motion
from scipy.special import ellipk

J = 2e-3
JL = 1e-3


def upward_crossings_s(time_s, values):
    rows = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    share = -values[rows] / (values[rows + 1] - values[rows])
    return time_s[rows] + share * (time_s[rows + 1] - time_s[rows])


def period_s(time_s, values):
    return float(np.diff(upward_crossings_s(time_s, values)).mean())


@pytest.mark.parametrize("amplitude_deg", [5.0, 60.0, 150.0])
def test_an_unbalanced_arm_swings_like_a_pendulum(rotary_simulator, amplitude_deg):
    plant = disc(effects={"gravity_load": {"gravity_torque_nm": 0.05, "phase_deg": 0.0}})
    run = commanded([(0.0, 0.0)], seconds=20.0, kind="torque_nm")
    angle = motion(rotary_simulator, plant, run, angle=math.radians(amplitude_deg))["angle"]
    expected_s = 4.0 * math.sqrt(J / 0.05) * ellipk(math.sin(math.radians(amplitude_deg) / 2.0) ** 2)
    assert period_s(run.time_s, angle) == pytest.approx(expected_s, rel=1e-4)
    assert np.abs(angle[-300:]).max() == pytest.approx(math.radians(amplitude_deg), rel=1e-3)


def test_a_payload_on_an_arm_swings_with_its_own_inertia_too(rotary_simulator):
    payload = {"gravity_torque_nm": 0.05, "added_inertia_kg_m2": 1e-3, "phase_deg": 0.0}
    run = commanded([(0.0, 0.0)], seconds=20.0, kind="torque_nm")
    plant = disc(effects={"hanging_payload": payload})
    angle = motion(rotary_simulator, plant, run, angle=math.radians(5.0))["angle"]
    expected_s = 4.0 * math.sqrt((J + 1e-3) / 0.05) * ellipk(math.sin(math.radians(2.5)) ** 2)
    assert period_s(run.time_s, angle) == pytest.approx(expected_s, rel=1e-4)


def test_a_payload_that_is_hung_on_later_is_an_arm_from_then_on(rotary_simulator):
    payload = {"gravity_torque_nm": 0.05, "added_inertia_kg_m2": 1e-3, "phase_deg": 0.0}
    run = commanded([(0.0, 0.002)], seconds=4.0, kind="torque_nm")
    late, plain = (
        motion(rotary_simulator, disc(effects=effects), run)["angle"]
        for effects in ({"hanging_payload": {**payload, "onset_s": 2.0}}, {})
    )
    np.testing.assert_allclose(late[:201], plain[:201], atol=1e-9)
    assert abs(late[-1] - plain[-1]) > 0.1


def test_a_payload_that_is_taken_off_again_leaves_the_motor_as_it_was(rotary_simulator):
    run = commanded([(0.0, 0.002)], seconds=4.0, kind="torque_nm")
    payload = {"added_inertia_kg_m2": 1e-3, "onset_s": 1.0, "removed_s": 2.0}
    speed, plain, heavy = (
        np.gradient(motion(rotary_simulator, disc(effects=effects), run)["angle"], run.time_s)
        for effects in ({"payload_inertia": payload}, {}, {"payload_inertia": {**payload, "onset_s": 0.0}})
    )
    pull = [np.gradient(one, run.time_s) for one in (speed, plain, heavy)]
    for moment_s, like in ((0.5, 1), (1.5, 2), (3.0, 1)):
        at = round(moment_s * 100)
        assert pull[0][at] == pytest.approx(pull[like][at], rel=1e-3)
    assert pull[1][50] == pytest.approx(pull[2][50] * (J + 1e-3) / J, rel=1e-3)


@pytest.mark.parametrize(("removed_s", "told"), [({}, {}), ({"removed_s": 2.0}, {"removed_s": 2.0})])
def test_a_payload_that_stays_has_no_end_in_a_plant_file(removed_s, told):
    payload = {"added_inertia_kg_m2": 1e-3, "onset_s": 1.0}
    config = disc(effects={"payload_inertia": {**payload, **removed_s}}).to_config()
    assert config["effects"]["payload_inertia"] == pytest.approx({**payload, **told})


def test_an_arm_comes_to_rest_hanging_down_at_its_phase(rotary_simulator):
    plant = disc(
        viscous_friction=0.02, effects={"gravity_load": {"gravity_torque_nm": 0.1, "phase_deg": 40.0}}
    )
    run = commanded([(0.0, 0.0)], seconds=10.0, kind="torque_nm")
    assert math.degrees(motion(rotary_simulator, plant, run)["angle"][-1]) == pytest.approx(-40.0, abs=1e-3)


def test_a_spring_swings_about_where_torque_and_spring_balance(rotary_simulator):
    plant = disc(effects={"spring_load": {"stiffness_nm_per_rad": 0.05, "rest_angle_deg": 20.0}})
    run = commanded([(0.0, 0.01)], seconds=10.0, kind="torque_nm")
    angle = motion(rotary_simulator, plant, run)["angle"]
    centre = math.radians(20.0) + 0.01 / 0.05
    assert (angle.min() + angle.max()) / 2.0 == pytest.approx(centre, rel=1e-3)
    assert period_s(run.time_s, angle - centre) == pytest.approx(
        2.0 * math.pi * math.sqrt(J / 0.05), rel=1e-4
    )


def test_two_masses_on_a_shaft_ring_at_their_resonance_and_speed_up_as_one(rotary_simulator):
    stiffness = 2.0
    plant = disc(
        effects={"shaft_compliance": {"stiffness_nm_per_rad": stiffness, "load_inertia_kg_m2": JL}},
    )
    run = commanded([(0.0, 0.02)], seconds=1.0, kind="torque_nm", every_s=1e-3)
    speed = motion(rotary_simulator, plant, run)["speed"]
    together = 0.02 / (J + JL)
    assert np.polyfit(run.time_s, speed, 1)[0] == pytest.approx(together, rel=0.02)
    early = run.time_s < 0.3
    expected_s = 2.0 * math.pi / math.sqrt(stiffness * (1.0 / J + 1.0 / JL))
    ringing = (speed - together * run.time_s)[early]
    assert period_s(run.time_s[early], ringing) == pytest.approx(expected_s, rel=0.01)


def test_a_load_behind_play_feels_nothing_inside_the_gap(rotary_simulator):
    gap = math.radians(10.0)
    plant = disc(effects={"backlash": {"gap_deg": 10.0, "load_inertia_kg_m2": JL}})
    run = commanded([(0.0, 0.02)], seconds=1.0, kind="torque_nm", every_s=1e-3)
    alone = motion(rotary_simulator, disc(), run)["angle"]
    with_load = motion(rotary_simulator, plant, run)
    inside = alone < gap / 2.0
    np.testing.assert_array_equal(with_load["angle"][inside], alone[inside])
    assert np.all(with_load["angle"][~inside][5:] < alone[~inside][5:])
    settled = run.time_s > 0.5
    acceleration = np.polyfit(run.time_s[settled], with_load["speed"][settled], 1)[0]
    assert acceleration == pytest.approx(0.02 / (J + JL), rel=0.01)


def test_play_is_felt_again_at_each_reversal(rotary_simulator):
    gap = math.radians(10.0)
    plant = disc(effects={"backlash": {"gap_deg": 10.0, "load_inertia_kg_m2": JL}})
    run = commanded([(0.0, 0.02), (0.5, -0.5)], seconds=0.6, kind="torque_nm", every_s=1e-3)
    found = motion(rotary_simulator, plant, run)
    back = (run.time_s >= 0.5) & (run.time_s <= 0.6)
    load_speed = found["speed"][np.flatnonzero(back)[0]]
    elapsed_s = run.time_s[back] - 0.5
    play = found["angle"][back] - found["angle"][back][0] - load_speed * elapsed_s
    crossing = elapsed_s[play > -0.95 * gap]
    assert crossing[-1] == pytest.approx(math.sqrt(2.0 * gap * J / 0.5), abs=3e-3)


def test_a_load_behind_play_moves_along_when_a_run_starts_in_motion(rotary_simulator):
    plant = disc(effects={"backlash": {"gap_deg": 10.0, "load_inertia_kg_m2": JL}})
    run = commanded([(0.0, 0.0)], seconds=1.0, kind="torque_nm")
    angle = motion(rotary_simulator, plant, run, speed=5.0)["angle"]
    np.testing.assert_allclose(angle, 5.0 * run.time_s, rtol=1e-9)


def test_a_load_that_bears_the_friction_rests_while_the_motor_crosses_its_play(rotary_simulator):
    gap = math.radians(10.0)
    borne = {"gap_deg": 10.0, "load_inertia_kg_m2": JL, "load_friction_share": 1.0}
    run = commanded([(0.0, 0.01)], seconds=1.0, kind="torque_nm", every_s=1e-3)
    rubbing, free = (
        motion(rotary_simulator, disc(effects=effects, **friction), run)["angle"]
        for effects, friction in (({"backlash": borne}, {"coulomb_friction": 0.02}), ({}, {}))
    )
    inside = free < gap / 2.0
    np.testing.assert_allclose(rubbing[inside], free[inside], rtol=1e-12)
    kept = J / (J + JL)  # of the energy, as the two strike and go on as one
    slid = kept * 0.01 * gap / 2.0 / (0.02 - 0.01)
    assert rubbing[-1] == pytest.approx(gap / 2.0 + slid, rel=0.01)


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
@pytest.mark.parametrize(
    "behind",
    [("backlash", {"gap_deg": 1.0}), ("shaft_compliance", {"stiffness_nm_per_rad": 5.0})],
    ids=["play", "shaft"],
)
def test_motor_and_load_stop_as_one_whoever_bears_the_friction(rotary_simulator, behind, share):
    name, sizes = behind
    load = {**sizes, "load_inertia_kg_m2": JL, "load_friction_share": share}
    plant = disc(effects={name: load}, coulomb_friction=0.02)
    run = commanded([(0.0, 0.0)], seconds=2.0, kind="torque_nm", every_s=1e-3)
    angle = motion(rotary_simulator, plant, run, speed=10.0)["angle"]
    assert angle[-1] == pytest.approx(0.5 * 10.0**2 * (J + JL) / 0.02, rel=0.01)


@pytest.mark.parametrize(("plays", "twists", "in_all"), [(0.3, 0.2, 1.0), (0.3, 0.7, 1.0), (0.9, 0.6, 1.5)])
def test_two_loads_each_bear_their_share_and_never_drive_the_motor(rotary_simulator, plays, twists, in_all):
    effects = {
        "backlash": {"gap_deg": 1.0, "load_inertia_kg_m2": JL, "load_friction_share": plays},
        "shaft_compliance": {
            "stiffness_nm_per_rad": 5.0,
            "load_inertia_kg_m2": JL,
            "shaft_damping_ratio": 0.3,
            "load_friction_share": twists,
        },
    }
    run = commanded([(0.0, 0.0)], seconds=3.0, kind="torque_nm", every_s=1e-3)
    plant = disc(effects=effects, coulomb_friction=0.02)
    angle = motion(rotary_simulator, plant, run, speed=10.0)["angle"]
    assert angle[-1] == pytest.approx(0.5 * 10.0**2 * (J + 2.0 * JL) / (in_all * 0.02), rel=0.03)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_shaft_twists_by_what_the_load_holds(rotary_simulator, share):
    shaft = {"stiffness_nm_per_rad": 0.5, "load_inertia_kg_m2": JL, "load_friction_share": share}
    plant = disc(effects={"shaft_compliance": {**shaft, "shaft_damping_ratio": 0.3}}, coulomb_friction=0.02)
    run = commanded([(0.0, 0.018)], seconds=2.0, kind="torque_nm", every_s=1e-3)
    angle = motion(rotary_simulator, plant, run)["angle"]
    held = max(0.018 - (1.0 - share) * 0.02, 0.0)  # what the motor's own friction leaves of the torque
    assert 0.0 <= angle[-1] <= 2.0 * held / 0.5 + 1e-9
    assert (angle[-1] > 0.0) == (held > 0.0)
