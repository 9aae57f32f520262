"""When something set in, on motors of a simulator that the fit does not know."""

import numpy as np
from diagnose_motors import recorded, settled

from nxt_twin.diagnose.diagnosis import Estimate
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.linear import linearise, signatures, trials_of
from nxt_twin.diagnose.judging.calibrate import clean_cases
from nxt_twin.diagnose.judging.confusion import trace_of, without
from nxt_twin.diagnose.where.moment import moments as named_moments
from nxt_twin.diagnose.where.moment import with_bounds
from nxt_twin.diagnose.where.onset import Direction, onsets
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator

SESSION_S = 12.0  # the recording in which the payload is added is the second that is fitted


def moments(case, *, named=None):
    """Onsets with `named` (an effect and its starting values) in the structure, or of an unnamed change."""
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, final = settled(simulator, case, added=named)
        linear = linearise(simulator, problem, final)
        clean = linear.left_of(clean_cases(linear, np.random.default_rng(0)))
        if named:
            (effect_id,) = named
            trace = trace_of(simulator, linear, without(final.plant, effect_id, problem.plant))
            return onsets(linear, [Direction(effect_id, trace, found=True)], clean)
        slots = [variable.slots[0].symbol for variable in linear.variables]
        load = trials_of(final.plant.layout.effect("constant_load"), problem.scale)[0]
        directions = [
            Direction("inertia", linear.slopes[slots.index("inertia")], found=False),
            Direction("load", signatures(simulator, linear, final.plant, [load])[0], found=False),
        ]
        return onsets(linear, directions, clean)


def test_a_payload_that_is_added_while_it_runs_is_placed_within_three_tenths_of_a_second():
    seed, from_s = 51, 4.2
    case = recorded(
        seed,
        families=("steps", "ramps", "reversals"),
        later={"added_inertia_kg_m2": 8e-4, "added_from_s": from_s},
    )
    found = moments(case)
    assert found[0].recording == "r3.csv"
    assert found[0].what == "inertia"
    assert abs(found[0].time_s - from_s) < 0.3
    assert found[0].low_s <= found[0].time_s <= found[0].high_s
    assert found[0].p_value < 0.02


def test_a_load_that_was_there_from_the_beginning_has_no_onset():
    case = recorded(53, motor={"constant_torque_nm": 0.006})
    assert moments(case, named={"constant_load": {"load": 0.005}}) == ()


def test_a_clean_motor_has_no_onset():
    assert moments(recorded(54)) == ()


def payload_from(seed, from_s, *, families=("steps", "ramps", "reversals")):
    """A payload that is in the structure already, added to the last recording at `from_s`: moments, and interval."""
    later = {"added_inertia_kg_m2": 8e-4, "added_from_s": from_s}
    case = recorded(seed, families=families, later=later)
    started = {"payload_inertia": {"added_inertia": 8e-4, "onset": SESSION_S + from_s + 0.3}}
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, final = settled(simulator, case, added=started)
        linear = linearise(simulator, problem, final)
        effect = final.plant.layout.effect("payload_inertia")
        fitted = {"onset_s": Estimate(final.plant.values[Slot("payload_inertia", "onset")], 55.0, "s")}
        told = with_bounds(simulator, linear, effect, fitted)["onset_s"]
        return named_moments(simulator, linear), told.interval_95


def test_a_named_payload_has_a_moment_with_bounds_that_hold_it():
    seed, from_s = 56, 7.6
    (found,), (low_s, high_s) = payload_from(seed, from_s)
    assert low_s <= SESSION_S + from_s <= high_s
    assert high_s - low_s < 2.5
    assert (found.what, found.recording) == ("payload_inertia", "r3.csv")
    assert abs(found.time_s - from_s) < 0.3
    assert found.low_s <= from_s <= found.high_s
    assert found.high_s - found.low_s < 1.0
    assert found.p_value < 1e-3


def test_a_payload_that_may_have_come_between_two_recordings_has_no_moment():
    while_it_still_rests_s = 0.15
    found, (low_s, high_s) = payload_from(57, while_it_still_rests_s)
    assert found == ()
    assert low_s <= SESSION_S + while_it_still_rests_s <= high_s
    assert high_s - low_s < 2.0
