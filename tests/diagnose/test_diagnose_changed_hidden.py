"""Changes that look like others, and are named nonetheless; or the other stands beside them."""

import pytest

from nxt_twin.blind.pairs.make import PairPlan, make_pair
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.recording.case import Case


def answered(folder, plan):
    """What `changed` says of a pair that was made by `plan`."""
    pair = make_pair(plan)
    before, after = (
        Case(name, folder, pair.content["plant"], recordings, (), "a")
        for name, recordings in (("before", pair.recordings[:2]), ("after", pair.recordings[2:]))
    )
    (found,) = changed(before, [after])
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_more_inertia_and_viscous_friction_are_told_from_another_resistance(tmp_path, seed):
    found = answered(tmp_path, PairPlan("pair", "bristle", seed, ("viscous_friction", "inertia")))
    assert {change.of for change in found.changes} == {"inertia_kg_m2", "viscous_friction_nm_s_per_rad"}
    assert "The motor did not change." in found.sentence


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "seed", "touches", "named"),
    [
        # A second body lends each window a speed of its own: without play it gains as much.
        ("stiff", 4180661421639318, ("inertia", "constant_load"), {"inertia_kg_m2", "constant_load"}),
        # 3.5 times the viscous friction: a straight line promises other changes more.
        ("bristle", 3295693422651867, ("viscous_friction",), {"viscous_friction_nm_s_per_rad"}),
        # Readings that only check tell drag that came in from drag on both sides.
        ("workshop", 8931666385939929, ("quadratic_drag",), {"quadratic_drag"}),
        # Beside a sag, a load too small to have a name is what the model lacks.
        ("stiff", 8703024939634641, ("battery_sag",), {"battery_sag"}),
        # What the plant lacks on both sides is taken in first: else lost counts and friction stand for the supply.
        ("bristle", 4663513915357895, ("supply",), {"supply_v"}),
        # A sag of 16 ohm simulates well, and a plant of the side's own gains much more: the search goes on.
        ("mujoco", 8842626359934219, ("inertia", "quadratic_drag"), {"inertia_kg_m2", "quadratic_drag"}),
        # Three changes are as likely as two.
        ("mujoco", 4328002123229055, ("supply", "quadratic_drag"), {"supply_v", "quadratic_drag"}),
        # 4 deg of play: errors that do not matter to a user tell it from inertia, and an open gap gains 54 nats.
        ("bristle", 3268525922974599, ("backlash", "supply"), {"backlash", "supply_v"}),
        # Friction that always was a little unequal triples: unequal friction gains 11 nats more.
        ("workshop", 4863887940040308, ("coulomb_friction",), {"coulomb_friction_nm"}),
        # A late command makes readings look held.
        ("bristle", 2217427159867850, ("command_delay", "gravity"), {"gravity_torque_nm", "command_delay"}),
        # 20 % more viscous friction beside a load and its play is what the model lacks.
        ("workshop", 1802064414013001, ("backlash", "gravity_load"), {"backlash", "gravity_load"}),
        # 4 deg of play, as in readings 1 deg apart: an open gap gains 16 nats over a second body without play.
        ("bristle", 6668364234436403, ("backlash",), {"backlash"}),
        # Windows of a second speak against play by 12 nats, and closer ones for it by 131.
        ("stiff", 6056599149518506, ("constant_load", "backlash"), {"constant_load", "backlash"}),
        # Viscous friction of 7 times the size draws shared numbers far off; BEFORE alone shows the drag.
        ("stiff", 6134277554943651, ("quadratic_drag",), {"quadratic_drag"}),
        # Rough readings hide no error that grew to twice its size.
        ("bristle", 6096396146922562, ("stiction",), {"stiction"}),
        ("workshop", 1911161876432503, ("battery_sag",), {"battery_sag"}),
        # Viscous friction 2 % less leaves nothing unexplained; 6 % more is slight within rough readings.
        ("mujoco", 6574696141478356, (), set()),
        ("stiff", 5911302286534596, (), set()),
        # Another friction that brings no window nearer, and 5 % more viscous friction, where nothing changed.
        ("workshop", 6175049087030343, (), set()),
        ("workshop", 4655944039609400, (), set()),
        # Viscous friction 2 % less gains 42 nats, Coulomb friction 14 % more gains 8, and nothing changed.
        ("mujoco", 889060537414059, (), set()),
        ("workshop", 3954628464006430, (), set()),
    ],
)
def test_what_looks_like_another_change_is_named(tmp_path, family, seed, touches, named):
    found = answered(tmp_path, PairPlan("pair", family, seed, touches))
    assert {change.of for change in found.changes} == named
    assert found.verdict == ("changed" if named else "unchanged")


@pytest.mark.slow
def test_an_earlier_command_is_told_from_less_inertia_as_it_goes_with_its_polls(tmp_path):
    found = answered(tmp_path, PairPlan("pair", "workshop", 2127203907632197, ("command_delay",)))
    assert {change.of for change in found.changes} == {"command_delay"}
    assert found.verdict == "changed"


@pytest.mark.slow
def test_a_steady_torque_and_another_rest_of_a_band_are_one_motion_and_both_are_listed(tmp_path):
    found = answered(tmp_path, PairPlan("pair", "mujoco", 8242053332630627, ("constant_load", "spring")))
    assert {change.of for change in found.changes} == {"stiffness_nm_per_rad", "rest_angle_deg"}
    assert ("constant_load", "rest_angle_deg") in [(one.id, one.instead_of) for one in found.alternatives]
