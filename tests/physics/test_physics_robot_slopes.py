"""Exact slopes of the wheels' angles against differences of the angles themselves."""

import numpy as np
import pytest

from nxt_twin.physics.robot.dynamics import NAMES, wheel_angles
from nxt_twin.physics.robot.slopes import COLUMNS, STARTS, wheel_slopes

VALUES = np.array(
    [
        *(0.49, 0.47, 7.6, 7.2, 8e-3, 9e-3, 2e-3, 1.5e-3, 1.2e-3, 1.1e-3, 1.0, 5e-3),
        *(0.2, 0.02, -0.01, 4e-3, -0.03, 0.3, 8e-3, 0.6, 2e-3, -1e-3, 3e-4, 2e-4, 0.3, 0.2),
    ]
)
SHAPE = np.array([0.028, 0.0275, 0.12, 0.09, 0.055, 0.3])
TIME_S = np.arange(0.0, 4.0, 0.031)
ROWS = TIME_S.size


def drive(off_phase_open):
    """Steps of both voltages, a spell in which the motors are let go, two windows that begin at a speed."""
    volts = np.where((TIME_S // 0.7 % 2 == 0)[:, None], [6.0, 3.0], [-4.0, 5.0])
    volts[(TIME_S > 2.2) & (TIME_S < 2.6)] = np.nan
    begins = np.zeros(ROWS, dtype=bool)
    begins[[0, 70]] = True
    floats = np.full((ROWS, 2), float(off_phase_open))
    return TIME_S, volts, 0.8 * TIME_S, begins, np.tile([0.05, 0.4], (ROWS, 1)), np.full(ROWS, 8.0), floats


@pytest.mark.parametrize("off_phase_open", [False, True])
def test_angles_are_those_of_the_plain_simulation(off_phase_open):
    driven = drive(off_phase_open)
    angles, slopes = wheel_slopes(VALUES, SHAPE, *driven, COLUMNS)
    np.testing.assert_allclose(angles, wheel_angles(VALUES, SHAPE, *driven), rtol=1e-12, atol=1e-12)
    few = wheel_slopes(VALUES, SHAPE, *driven, STARTS)
    np.testing.assert_allclose(few[0], angles, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(few[1], slopes[:, :, :STARTS], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("off_phase_open", [False, True])
@pytest.mark.parametrize("place", range(len(NAMES)), ids=NAMES)
def test_each_slope_is_what_a_small_change_does(place, off_phase_open):
    driven = drive(off_phase_open)
    step = 1e-6 * max(abs(VALUES[place]), 1e-3) * np.eye(len(NAMES))[place]
    ahead, behind = (wheel_angles(VALUES + sign * step, SHAPE, *driven) for sign in (1.0, -1.0))
    expected = (ahead - behind) / (2.0 * step[place])
    found = wheel_slopes(VALUES, SHAPE, *driven, COLUMNS)[1][:, :, STARTS + place]
    assert np.max(np.abs(expected)) > 0.0
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.max(np.abs(expected)))


@pytest.mark.parametrize(("place", "step"), [(0, 1e-6), (1, 1e-6)])
def test_slopes_by_the_starting_speeds(place, step):
    time_s, volts, heading_rad, begins, start, *rest = drive(off_phase_open=False)
    moved = [start + sign * step * np.eye(2)[place] for sign in (1.0, -1.0)]
    ahead, behind = (
        wheel_angles(VALUES, SHAPE, time_s, volts, heading_rad, begins, one, *rest) for one in moved
    )
    found = wheel_slopes(VALUES, SHAPE, time_s, volts, heading_rad, begins, start, *rest, STARTS)[1]
    np.testing.assert_allclose(found[:, :, place], (ahead - behind) / (2.0 * step), rtol=1e-4, atol=1e-5)


def test_a_battery_without_resistance_still_shows_what_one_would_do():
    driven = drive(off_phase_open=False)
    place = NAMES.index("battery_resistance")
    stiff = np.where(np.arange(len(NAMES)) == place, 0.0, VALUES)
    weak = np.where(np.arange(len(NAMES)) == place, 1e-6, VALUES)
    expected = (wheel_angles(weak, SHAPE, *driven) - wheel_angles(stiff, SHAPE, *driven)) / 1e-6
    found = wheel_slopes(stiff, SHAPE, *driven, COLUMNS)[1][:, :, STARTS + place]
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.max(np.abs(expected)))
