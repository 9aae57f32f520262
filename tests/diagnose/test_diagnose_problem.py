import numpy as np
import pytest

from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.errors import DiagnosisError
from nxt_twin.recording.recording import Recording, SignalKinds

PLANT = {"kind": "rigid_body", "inertia": 1e-3, "viscous_friction": 1e-2}
KINDS = SignalKinds("torque_nm", "position_rad")


def swinging(name, *, seconds=12.0, step_s=0.01, kinds=KINDS):
    time_s = np.arange(0.0, seconds, step_s)
    torque = np.sin(2.0 * time_s)
    return Recording(name, {"time_s": time_s, "input": torque, "output": 5.0 * (1.0 - np.cos(time_s))}, kinds)


def test_named_holdouts_are_never_fitted():
    problem = problem_of("case", PLANT, [swinging("a"), swinging("b")], [swinging("c")], None)
    assert {job.signals.name for job in problem.target.jobs} == {"a", "b"}
    assert [part.signals.name for part in problem.held_out] == ["c"]


def test_of_three_recordings_one_is_held_out_whole():
    problem = problem_of("case", PLANT, [swinging(name) for name in "abc"], [], None)
    assert [part.signals.name for part in problem.held_out] == ["c"]
    assert {job.signals.name for job in problem.target.jobs} == {"a", "b"}


def test_of_one_recording_blocks_of_time_are_held_out_and_not_fitted():
    problem = problem_of("case", PLANT, [swinging("a")], [], None)
    held_out = problem.held_out[0]
    times_held = set(held_out.signals.time_s[held_out.counted])
    assert 0.2 < held_out.counted.mean() < 0.5
    for job, counted, check in zip(problem.target.jobs, problem.target.counted, problem.check, strict=True):
        assert not times_held & set(job.signals.time_s[counted])
        assert not times_held & set(job.signals.time_s[check])


def test_target_and_check_never_share_a_reading():
    problem = problem_of("case", PLANT, [swinging("a"), swinging("b")], [], None)
    for counted, check in zip(problem.target.counted, problem.check, strict=True):
        assert not (counted & check).any()
        assert check.any()


def test_what_is_put_on_in_the_last_of_many_recordings_is_seen_by_a_fit():
    problem = problem_of("case", PLANT, [swinging(str(i)) for i in range(6)], [], None)
    target = problem.target
    for counted, check in zip(target.counted, target.check, strict=True):
        assert check.any()
        assert counted.any()


def test_readings_denser_than_the_plant_s_time_constant_are_thinned():
    problem = problem_of("case", PLANT, [swinging("a", step_s=1e-3), swinging("b", step_s=1e-3)], [], None)
    assert np.median(np.diff(problem.target.jobs[0].signals.time_s)) == pytest.approx(0.0125, rel=0.1)
    assert np.median(np.diff(problem.held_out[0].signals.time_s)) == pytest.approx(1e-3)


def test_recordings_driven_in_different_ways_are_refused():
    other = swinging("b", kinds=SignalKinds("force_n", "position_m"))
    with pytest.raises(DiagnosisError, match="driven by force_n, torque_nm"):
        problem_of("case", PLANT, [swinging("a"), other], [], None)


def test_a_recording_in_which_nothing_moves_is_refused():
    still = Recording(
        "a", {"time_s": np.arange(100.0), "input": np.zeros(100), "output": np.zeros(100)}, KINDS
    )
    with pytest.raises(DiagnosisError, match="nothing moves"):
        problem_of("case", PLANT, [still], [], None)


@pytest.mark.parametrize(
    ("column", "values", "said"),
    [("time_s", np.zeros(100), "never advance"), ("output", np.arange(100.0) * 1e300, "no motor does")],
)
def test_a_recording_that_no_simulation_could_follow_is_refused(column, values, said):
    columns = {"time_s": np.arange(100.0), "input": np.ones(100), "output": np.arange(100.0)}
    odd = Recording("a", {**columns, column: values}, KINDS)
    with pytest.raises(DiagnosisError, match=said):
        problem_of("case", PLANT, [odd], [], None)
