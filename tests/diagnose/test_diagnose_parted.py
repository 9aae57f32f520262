"""Which whole recordings are held out, where a case names none."""

from dataclasses import dataclass
from typing import final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.diagnose.fitting.parted import parted, run_outs_s
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_DRIVE, MODE_FLOAT

LENGTH_S = 10.0


@final
@dataclass(frozen=True)
class Driven:
    """The part of a recording's signals that tells how it was driven: a mode of the drive in its last seconds."""

    name: str
    mode: int = MODE_DRIVE
    lasts_s: float = 2.0

    @property
    def time_s(self):
        return np.linspace(0.0, LENGTH_S, 101)

    @property
    def command_time_s(self):
        return np.array([0.0, LENGTH_S - self.lasts_s])

    @property
    def command_mode(self):
        return np.array([MODE_DRIVE, self.mode])


def held_out(modes, *, second=False):
    fitted, apart = parted([Driven(f"r{n}", mode) for n, mode in enumerate(modes)], second=second)
    assert {one.name for one in fitted}.isdisjoint(one.name for one in apart)
    return [one.name for one in apart]


@pytest.mark.parametrize(
    ("modes", "first", "second"),
    [
        ((MODE_DRIVE,) * 3, ["r2"], ["r1"]),
        ((MODE_DRIVE, MODE_DRIVE, MODE_COAST), ["r1"], ["r0"]),
        ((MODE_DRIVE, MODE_DRIVE, MODE_FLOAT), ["r1"], ["r0"]),
        ((MODE_DRIVE, MODE_COAST, MODE_COAST), ["r2"], ["r1"]),
        ((MODE_DRIVE, MODE_COAST, MODE_FLOAT), ["r0"], ["r2"]),
        ((MODE_DRIVE, MODE_DRIVE, MODE_BRAKE), ["r2"], ["r1"]),
        ((MODE_DRIVE,) * 5 + (MODE_COAST,), ["r1", "r4"], ["r0", "r3"]),
        ((MODE_DRIVE, MODE_DRIVE, MODE_COAST, MODE_COAST), ["r2"], ["r1"]),
    ],
)
def test_what_alone_lets_the_motor_run_out_is_fitted_where_another_can_be_held_out(modes, first, second):
    assert held_out(modes) == first
    assert held_out(modes, second=True) == second


def test_of_one_or_two_recordings_none_is_held_out():
    assert held_out((MODE_DRIVE, MODE_COAST)) == []


@pytest.mark.parametrize(("lasts_s", "told"), [(0.49, {}), (0.5, {MODE_COAST: pytest.approx(0.5)})])
def test_a_coast_down_shorter_than_half_a_second_is_none(lasts_s, told):
    assert run_outs_s([Driven("r0")], Driven("r1", MODE_COAST, lasts_s)) == told
    assert run_outs_s([Driven("r0", MODE_COAST)], Driven("r1", MODE_COAST, lasts_s)) == {}


@given(st.lists(st.sampled_from([MODE_DRIVE, MODE_COAST, MODE_FLOAT, MODE_BRAKE]), min_size=3, max_size=9))
def test_each_recording_is_either_fitted_or_held_out_and_neither_is_empty(modes):
    recordings = [Driven(f"r{n}", mode) for n, mode in enumerate(modes)]
    for second in (False, True):
        fitted, apart = parted(recordings, second=second)
        assert fitted
        assert apart
        assert sorted([*fitted, *apart], key=lambda one: one.name) == recordings
