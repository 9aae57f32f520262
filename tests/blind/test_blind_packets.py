"""Recordings of the truth families that came over a link which hands rows over in packets."""

import numpy as np
import pytest

from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.habits import Habits
from nxt_twin.blind.families.packets import Packets, draw_packets, handed_over
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.sets import CasePlan
from nxt_twin.recording.clumps import clump_ends
from nxt_twin.recording.recording import Recording

HABITS = Habits(3, 20.0, 0.0, 100.0, 0.0, 0.0, 0.1, 1.0, 10)


def recording(rows=601):
    time_s = 0.01 * np.arange(rows)
    return Recording("r1.csv", {"time_s": time_s, "a_tacho_deg": 90.0 * time_s})


def draws(habits=HABITS, effects=(), count=400):
    return [draw_packets(np.random.default_rng(seed), habits, effects) for seed in range(count)]


def test_about_one_quick_link_in_seven_makes_packets_counted_or_by_a_timer():
    made = [one for one in draws() if one]
    assert 40 < len(made) < 80
    counted = [one.rows for one in made if one.rows]
    assert 0.3 < len(counted) / len(made) < 0.7
    assert set(counted) == {2, 3, 4, 5, 6}
    assert all(2.2 <= one.period_polls <= 6.0 for one in made)


@pytest.mark.parametrize("effect", ["clock_skew", "stale_samples", "sample_hold"])
def test_no_packets_beside_an_effect_of_stamps_or_at_a_slow_rate(effect):
    assert not any(draws(effects=(effect,)))
    slow = Habits(3, 20.0, 0.0, 79.0, 0.0, 0.0, 0.1, 1.0, 10)
    assert not any(draws(slow))


@pytest.mark.parametrize("size", [2, 5])
def test_counted_packets_have_one_stamp_and_the_last_rows_moment(size):
    given = recording()
    found = handed_over(np.random.default_rng(1), given, Packets(size, 0.0, 0.0, 0.0))
    waits_s = np.diff(found.time_s)
    assert np.mean(waits_s == 0.0) == pytest.approx(1.0 - 1.0 / size, abs=0.01)
    last = np.arange(size - 1, 600, size)
    late_s = found.time_s[last] - given.time_s[last]
    np.testing.assert_allclose(late_s, late_s[0], atol=1e-6)
    np.testing.assert_array_equal(found.columns["a_tacho_deg"], given.columns["a_tacho_deg"])
    assert clump_ends(found.time_s).size == -(-601 // size)


def test_a_timer_sends_what_there_is_at_even_times():
    found = handed_over(np.random.default_rng(1), recording(), Packets(0, 3.4, 0.0, 2e-5))
    waits_s = np.diff(found.time_s)
    came_s = waits_s[waits_s > 1e-3]
    assert found.time_s[0] == 0.0
    np.testing.assert_allclose(came_s, 0.034, atol=2e-4)


def test_a_case_in_packets_differs_from_the_same_without_in_nothing_but_stamps(monkeypatch):
    def made(seed):
        return FAMILIES["workshop"].make(Order("workshop", CasePlan("case", seed, (), "large"), "usb", 5.0))

    def in_packets(case):
        return all(clump_ends(one.time_s).size for one in case.recordings)

    seed, case = next((seed, case) for seed in range(60) if in_packets(case := made(seed)))
    monkeypatch.setattr("nxt_twin.blind.families.packets._CHANCE", 0.0)
    plain = made(seed)
    for one, other in zip(case.recordings, plain.recordings, strict=True):
        assert np.mean(one.time_s != other.time_s) > 0.5
        for name in set(one.columns) - {"time_s"}:
            np.testing.assert_array_equal(one.columns[name], other.columns[name])
