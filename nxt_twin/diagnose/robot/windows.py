"""How far a geometry is from the measured pose in windows whose start poses are fitted away.

A window's start pose is free, so that noise of a single measured pose does not turn a whole window. A turned frame
of the markers then shows as a difference between measured heading and direction of travel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import ComplexArray, FloatArray
from nxt_twin.diagnose.robot.stack import PoseWindows, RunStack
from nxt_twin.physics.robot.drive import Geometry

LENGTHS_S: Final = (2.0, 5.0, 20.0)
"""Short windows tell the markers' frame and the clock, long ones the track and the ratio."""

PARAMETERS: Final = (
    "mean_wheel_radius_m",
    "wheel_radius_ratio",
    "track_m",
    "offset_forward_m",
    "offset_left_m",
    "heading_offset_deg",
)
"""Of a geometry, in the order of a fit's vector."""

_PLACE_M: Final = 1.5e-3  # standard deviation of a measured place, by which places and headings are weighed
_HEADING_RAD: Final = np.radians(0.5)
_LEAST_SCALE: Final = (1e-5, 1e-5, 1e-5)
_MAD: Final = 1.4826  # standard deviation of normal values over their median absolute deviation


@final
@dataclass(frozen=True)
class DriveState:
    """The fitted numbers.

    Attributes:
        geometry: values of `PARAMETERS`, shape (6,).
        lag_s: of each run's pose behind its wheels, at the run's middle, shape (runs,).
        rate: by which that lag grows over time, shape (runs,).
    """

    geometry: FloatArray
    lag_s: FloatArray
    rate: FloatArray

    @property
    def as_geometry(self) -> Geometry:
        """The first six as a robot's geometry."""
        return Geometry(**{name: float(value) for name, value in zip(PARAMETERS, self.geometry, strict=True)})


def vector_of(geometry: Geometry) -> FloatArray:
    """A geometry's values in the order of `PARAMETERS`."""
    return np.array([getattr(geometry, name) for name in PARAMETERS])


def lengths_for(stack: RunStack) -> tuple[float, ...]:
    """The lengths of windows that the runs can fill, s."""
    longest = 2.0 * float(stack.half_s.max())
    return tuple(length for length in LENGTHS_S if length <= longest) or (longest,)


def residuals(stack: RunStack, parts: tuple[PoseWindows, ...], state: DriveState) -> FloatArray:
    """Measured minus predicted pose in each window, start poses fitted away.

    Returns:
        Shape (lengths, 3, rows): along the robot in m, to its left in m, and heading in rad.
    """
    place, heading = stack.path(state.as_geometry, *stack.wheels(state.lag_s, state.rate))
    return np.array([_in_windows(stack, windows, place, heading) for windows in parts])


def _in_windows(
    stack: RunStack, windows: PoseWindows, place: ComplexArray, heading: FloatArray
) -> FloatArray:
    def mean(values: ComplexArray) -> ComplexArray:
        return np.asarray(np.add.reduceat(values, windows.first) / windows.counts)

    def centred(values: ComplexArray) -> ComplexArray:
        return np.asarray(values - mean(values)[windows.of_row])

    told, seen = centred(place), centred(stack.place)
    off = stack.heading_rad - heading
    by_heading = np.add.reduceat(off, windows.first) / windows.counts
    moment = mean(seen * np.conj(told)) * np.exp(-1j * by_heading)
    share = np.abs(moment) / _PLACE_M**2
    share = share / (share + 1.0 / _HEADING_RAD**2)
    turn = by_heading + share * np.angle(np.where(moment == 0.0, 1.0, moment))
    turned = turn[windows.of_row]
    error = (seen - np.exp(1j * turned) * told) * np.exp(-1j * stack.heading_rad)
    return np.array([error.real, error.imag, off - turned])


def scales_of(errors: FloatArray) -> FloatArray:
    """A robust standard deviation of each length and channel, shape (lengths, 3, 1)."""
    spread = _MAD * np.median(np.abs(errors), axis=2)
    # Windows in which the robot rests would make the scale vanish: no less than a quarter of the plain spread.
    far = 10.0 * spread[..., None]
    plain = np.sqrt(np.mean(np.clip(errors, -far, far) ** 2, axis=2))
    scale = np.maximum(np.maximum(spread, 0.25 * plain), _LEAST_SCALE)
    return np.asarray(scale[..., None], dtype=np.float64)
