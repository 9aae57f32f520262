"""What a brick's other motors draw from the battery that all share."""

from dataclasses import replace

import numpy as np
import pytest
from physics_reference import predict
from physics_samples import commanded, motion, nxt

from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.lags import KnownLags
from nxt_twin.recording.recording import Recording

ROWS = 300
TIME_S = np.arange(ROWS) * 0.01
SPEED = 5.0
RESISTANCE, BACK_EMF, SUPPLY_V, INTERNAL = 7.6, 0.4908, 8.0, 0.9
SAGGING = {"battery_sag": {"internal_resistance_ohm": INTERNAL}}


def brick(lags=None, **columns):
    still = {"a_power_pct": np.zeros(ROWS), "a_tacho_deg": np.zeros(ROWS)}
    return Recording("run.csv", {"time_s": TIME_S, **still, **columns}, lags=KnownLags(lags))


def turning(port, power_pct, mode="drive"):
    """A motor's columns: driven from 1 s on, and turning evenly all the time."""
    return {
        f"{port}_power_pct": np.where(TIME_S < 1.0, 0.0, power_pct),
        f"{port}_mode": np.full(ROWS, float(DRIVE_MODES.index(mode))),
        f"{port}_tacho_deg": np.floor(np.degrees(SPEED * TIME_S)),
    }


@pytest.mark.parametrize(
    ("mode", "power_pct", "share", "back"),
    [
        ("drive", 60.0, 0.36, 3.0),
        ("drive", -60.0, 0.36, -3.0),
        ("float", 60.0, 0.6, 3.0),
        ("brake", 60.0, 0.0, 0.0),
        ("coast", 60.0, 0.0, 0.0),
    ],
)
def test_another_motor_loads_by_its_duty_and_speed_while_it_is_driven(mode, power_pct, share, back):
    found = signals_of(brick(**turning("b", power_pct, mode)), "a")
    late = found.others_time_s > 0.999
    np.testing.assert_allclose(found.others_load[~late], 0.0)
    np.testing.assert_allclose(found.others_load[late, 0], share)
    inside = late & (found.others_time_s < 2.9)
    np.testing.assert_allclose(found.others_load[inside, 1], back, atol=0.2)


def test_two_others_load_together():
    found = signals_of(brick(**turning("b", 60.0), **turning("c", 80.0)), "a")
    assert found.others_load[-1, 0] == pytest.approx(0.36 + 0.64)


def test_a_steady_load_is_not_told_anew_at_every_row():
    assert signals_of(brick(**turning("b", 60.0)), "a").others_time_s.size < 40


def test_another_motor_loads_from_when_its_own_command_acts():
    lags = {"row_lags": {"acted_after_s": {"a": 0.001, "b": 0.004}, "read_before_s": {"b": 0.003}}}
    found = signals_of(brick(lags, **turning("b", 60.0)), "a")
    first = found.others_time_s[found.others_load[:, 0] > 0.0][0]
    assert first == pytest.approx(1.004)


@pytest.mark.parametrize(
    "columns",
    [
        {},
        {**turning("b", 0.0)},
        {"b_power_pct": np.full(ROWS, 60.0)},
        {**turning("b", 60.0), "b_tacho_deg": np.where(TIME_S < 0.05, 0.0, np.nan)},
    ],
    ids=["not there", "not driven", "not counted", "hardly counted"],
)
def test_who_is_at_rest_or_unknown_changes_nothing(columns):
    alone, beside = signals_of(brick(), "a"), signals_of(brick(**columns), "a")
    for name, values in vars(alone).items():
        np.testing.assert_array_equal(getattr(beside, name), values)


def test_a_battery_read_while_another_motor_draws_does_not_tell_the_open_circuit_supply():
    readings = np.where(np.arange(ROWS) % 10, np.nan, np.where(TIME_S < 1.05, 8.0, 7.5))
    found = signals_of(brick(battery_v=readings, **turning("b", 80.0)), "a")
    np.testing.assert_allclose(found.command_supply_v, 8.0, rtol=1e-5)


def loaded(share, back, **run):
    """A motor at 60 % while others load the battery, from 0.4 s on."""
    own = commanded([(0.0, 0.6)], seconds=1.5, **run)
    return replace(own, others_time_s=np.array([0.4]), others_load=np.array([[share, back]]))


@pytest.mark.parametrize(("mode", "drawn_share"), [(0, 0.6), (1, 1.0)])
@pytest.mark.parametrize(("share", "back"), [(1.28, 12.0), (0.5, -4.0), (0.04, 3.0)])
def test_what_is_drawn_together_lowers_the_supply_of_all(motor_simulator, mode, drawn_share, share, back):
    run = motion(motor_simulator, nxt(effects=SAGGING), loaded(share, back, mode=mode))
    # The winding of a floating bridge is connected for 60 % of the time, with all of the supply.
    current, speed = run["current"][-1] / (0.6 if mode else 1.0), run["speed"][-1]
    terminal_v = (RESISTANCE * current + BACK_EMF * speed) / drawn_share
    others_a = (share * terminal_v - BACK_EMF * back) / RESISTANCE
    assert terminal_v == pytest.approx(SUPPLY_V - INTERNAL * (0.6 * current + others_a), abs=1e-3)


def test_quicker_others_give_back(motor_simulator):
    plant, alone = nxt(effects=SAGGING), commanded([(0.0, 0.6)], seconds=1.5)
    giving = motion(motor_simulator, plant, loaded(0.04, 3.0))["speed"][-1]
    assert giving > motion(motor_simulator, plant, alone)["speed"][-1]


def test_a_battery_without_resistance_is_not_lowered_by_others(motor_simulator):
    alone = commanded([(0.0, 0.6)], seconds=1.5)
    for each in ("speed", "angle"):
        np.testing.assert_allclose(
            motion(motor_simulator, nxt(), loaded(1.28, 12.0))[each],
            motion(motor_simulator, nxt(), alone)[each],
            rtol=1e-12,
        )


@pytest.mark.parametrize("more", [{}, {"command_delay": {"delay_s": 0.0137}}])
def test_compiled_kernel_agrees_with_plain_python_beside_others(motor_simulator, more):
    rng = np.random.default_rng(4)
    own = commanded([(0.0, 0.6), (0.5, -0.8), (0.9, 0.3)], seconds=1.5)
    at = np.sort(rng.uniform(0.0, 1.5, 60))
    run = replace(own, others_time_s=at, others_load=rng.uniform((0.0, -20.0), (2.0, 20.0), (60, 2)))
    job, plant = free_job(run, at_rest(run)), nxt(effects=SAGGING | more)
    compiled = motor_simulator.trace(plant, job)["predicted"]
    np.testing.assert_allclose(compiled, predict(plant, job)["predicted"], rtol=1e-9, atol=1e-9)
    assert (
        np.abs(compiled - motor_simulator.trace(plant, free_job(own, at_rest(own)))["predicted"]).max() > 0.1
    )


def test_alone_is_the_same_motor_without_the_others():
    beside = signals_of(brick(**turning("b", 60.0)), "a")
    assert beside.others_time_s.size
    alone = beside.alone()
    assert alone.others_time_s.shape == (0,)
    assert alone.others_load.shape == (0, 2)
    np.testing.assert_array_equal(alone.command, beside.command)
