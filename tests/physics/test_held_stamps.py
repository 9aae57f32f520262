"""Readings that a clock which stepped back stamped at once: their moments are unknown."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.physics.held_stamps import without_held_stamps
from nxt_twin.physics.signals import Signals

ROWS = 400


def signals(gaps_s, clump_rows=0.0):
    time_s = np.cumsum(np.concatenate([[0.0], gaps_s]))
    return Signals(
        name="r.csv",
        channel="a_tacho_deg",
        input_kind="duty",
        command_time_s=time_s,
        command=np.ones(time_s.size),
        command_mode=np.zeros(time_s.size, dtype=np.int64),
        command_supply_v=np.full(time_s.size, 8.0),
        time_s=time_s,
        measured=np.arange(time_s.size, dtype=float),
        is_speed=False,
        quantum=0.0,
        clump_rows=clump_rows,
    )


def held(rows, gap_s=1e-4):
    gaps_s = np.full(ROWS - 1, 0.025)
    gaps_s[np.array(rows) - 1] = gap_s
    return gaps_s


@given(st.sets(st.integers(1, ROWS - 1), min_size=1, max_size=15))
def test_a_few_readings_stamped_at_once_are_left_out_with_those_beside_them(rows):
    rows = sorted(rows)
    left = without_held_stamps(signals(held(rows)))
    beside = {row + step for row in rows for step in (-1, 0, 1)} & set(range(ROWS))
    assert set(np.flatnonzero(np.isnan(left.measured))) == beside


def test_it_is_told_when_stamps_stood_still_and_for_how_long():
    told = without_held_stamps(signals(held([40, 41, 42, 90]))).held_s
    time_s = np.cumsum(np.concatenate([[0.0], held([40, 41, 42, 90])]))
    np.testing.assert_allclose(told, [[time_s[40], 0.075], [time_s[90], 0.025]], rtol=1e-6)


@pytest.mark.parametrize(
    "same",
    [
        signals(held([50, 51], gap_s=0.004)),  # a host that catches up
        signals(held(range(2, 60, 2))),  # more than a few come in clumps
        signals(held([50, 51]), clump_rows=2.0),
    ],
)
def test_other_readings_stay(same):
    assert without_held_stamps(same) is same
