"""Stamps rounded to a coarse step: the step is told, and an even course tells when rows were read."""

import numpy as np
import pytest

from nxt_twin.recording.rounded import course_through, rounding_s


def polled(rows=1500, poll_s=0.0123, jitter_s=2e-4, seed=1):
    """Moments of a host that sleeps after each poll, s."""
    rng = np.random.default_rng(seed)
    return np.cumsum(poll_s + jitter_s * rng.standard_normal(rows))


def rounded(time_s, step_s):
    return np.round(time_s / step_s) * step_s


@pytest.mark.parametrize("step_s", [0.002, 0.005, 0.01, 1.0 / 64.0])
def test_the_step_of_rounded_stamps_is_told(step_s):
    assert rounding_s(np.round(rounded(polled(), step_s), 6)) == pytest.approx(step_s, abs=2e-6)


def test_fine_stamps_have_no_step():
    assert rounding_s(np.round(polled(), 5)) == 0.0
    assert rounding_s(rounded(polled(poll_s=0.02), 0.001)) == 0.0


@pytest.mark.parametrize("dropped", [0.0, 0.05])
def test_an_even_timer_rounds_nothing(dropped):
    kept = np.random.default_rng(2).random(2000) >= dropped
    assert rounding_s(0.01 * np.arange(2000)[kept]) == 0.0


def test_too_few_or_backward_stamps_tell_no_step():
    assert rounding_s(rounded(polled(rows=40), 0.01)) == 0.0
    assert rounding_s(rounded(polled(), 0.01)[::-1]) == 0.0


@pytest.mark.parametrize(
    ("poll_s", "step_s"), [(0.0123, 0.005), (0.0071, 0.005), (0.033, 0.01), (0.021, 0.02)]
)
def test_a_course_tells_moments_to_a_fraction_of_the_step(poll_s, step_s):
    read_s = polled(poll_s=poll_s)
    course = course_through(rounded(read_s, step_s), step_s)
    off_s = course.time_s - read_s
    assert np.std(off_s) < 0.15 * step_s
    assert np.std(off_s) < 2.0 * np.mean(course.open_s)
    assert np.all(np.diff(course.time_s) >= 0.0)


def test_a_stall_of_the_host_stays_in_the_course():
    read_s = polled()
    read_s[700:] += 0.12
    course = course_through(rounded(read_s, 0.005), 0.005)
    assert np.diff(course.time_s)[699] == pytest.approx(0.12 + 0.0123, abs=0.006)
    assert np.std(course.time_s - read_s) < 1e-3


def test_uneven_polls_leave_moments_open():
    read_s = polled(jitter_s=2e-3)
    course = course_through(rounded(read_s, 0.005), 0.005)
    even = course_through(rounded(polled(), 0.005), 0.005)
    assert np.mean(course.open_s) > 1.5 * np.mean(even.open_s)
    assert np.std(course.time_s - read_s) < 2.0 * np.mean(course.open_s)
