import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.diagnose.fitting.splits import with_blocks_that_check, with_windows_held_out
from nxt_twin.physics.recorded import signals_of
from nxt_twin.recording.recording import Recording, SignalKinds

KINDS = SignalKinds("torque_nm", "position_rad")
PLANT = {"kind": "rigid_body", "inertia": 1e-3, "viscous_friction": 1e-2}


def recording(name, seconds, rate_hz, jitter, read_share, rng):
    count = int(seconds * rate_hz) + 2
    time_s = np.linspace(0.0, seconds, count)
    time_s[1:-1] += jitter * rng.uniform(-0.4, 0.4, count - 2) / rate_hz
    output = np.where(rng.random(count) < read_share, np.sin(time_s), np.nan)
    output[[0, -1]] = 0.0
    return Recording(name, {"time_s": time_s, "input": np.cos(time_s), "output": output}, KINDS)


recordings = st.builds(
    lambda lengths, rate_hz, jitter, read_share, seed: [
        signals_of(
            recording(str(n), seconds, rate_hz, jitter, read_share, np.random.default_rng(seed + n)), None
        )
        for n, seconds in enumerate(lengths)
    ],
    lengths=st.lists(
        st.one_of(
            st.floats(6.0, 60.0), st.floats(60.0, 3600.0), st.sampled_from([12.0, 23.5, 24.0, 24.2, 48.0])
        ),
        min_size=1,
        max_size=8,
    ),
    rate_hz=st.sampled_from([4.0, 10.0]),
    jitter=st.floats(0.0, 1.0),
    read_share=st.sampled_from([1.0, 0.7]),
    seed=st.integers(0, 1000),
)


def kinds_of(signals, split):
    read = np.isfinite(signals.measured)
    assert not (split.held_out & split.check).any()
    return (
        (read & split.held_out).sum(),
        (read & split.check).sum(),
        (read & ~split.held_out & ~split.check).sum(),
    )


@settings(max_examples=60, deadline=None)
@given(recordings)
def test_windows_of_each_recording_are_fitted_checked_and_held_out(read):
    splits, window_s = with_windows_held_out(read)
    assert 0.0 < window_s <= 2.0
    for signals, split in zip(read, splits, strict=True):
        assert min(kinds_of(signals, split)) > 0


@settings(max_examples=60, deadline=None)
@given(recordings)
def test_beside_whole_recordings_held_out_some_readings_check_and_more_are_fitted(read):
    splits = with_blocks_that_check(read)
    counts = np.array([kinds_of(signals, split) for signals, split in zip(read, splits, strict=True)])
    held_out, checked, fitted = counts.sum(axis=0)
    assert held_out == 0
    assert fitted > checked > 0


@pytest.mark.parametrize("seconds", [6.0, 12.0, 23.5, 23.9, 24.0, 24.2, 36.0])
@pytest.mark.parametrize("many", [1, 2])
def test_a_case_of_any_length_leaves_readings_to_fit_to_check_and_to_judge(seconds, many):
    rng = np.random.default_rng(1)
    made = [recording(str(n), seconds, 50.0, 0.5, 1.0, rng) for n in range(many)]
    problem = problem_of("case", PLANT, made, [], None)
    held = sum(int(part.counted.sum()) for part in problem.held_out)
    counts = [
        sum(int(mask.sum()) for mask in target.seen())
        for target in (problem.target, problem.target.checking(), problem.simulated)
    ]
    assert min([held, *counts]) > 0
