"""Commands that lost their sign: told from those of a motor that runs one way, or that overshoots."""

import numpy as np
import pytest

from nxt_twin.recording.unsigned import lost_sign

HALF = 100


def courses(back):
    """A drive ahead and one back, by `back` times as far; the command holds throughout, without its sign."""
    ahead = np.arange(HALF, dtype=float)
    return np.full(2 * HALF, 60.0), np.concatenate([ahead, ahead[-1] - back * ahead])


@pytest.mark.parametrize(
    ("back", "lost"), [(1.0, True), (0.26, True), (0.24, False), (0.0, False), (4.2, False)]
)
def test_a_fifth_of_the_travel_either_way_tells_it(back, lost):
    assert lost_sign(*courses(back)) is lost


def test_signed_commands_and_resting_ones_tell_nothing():
    command, angle = courses(1.0)
    signed = np.where(np.arange(command.size) < HALF, command, -command)
    assert not lost_sign(signed, angle)
    assert not lost_sign(0.0 * command, angle)
    assert lost_sign(-command, angle)


def test_rows_without_a_reading_are_passed_over():
    command, angle = courses(1.0)
    angle[::3] = np.nan
    assert lost_sign(command, angle)
    assert not lost_sign(command[:1], angle[:1])
