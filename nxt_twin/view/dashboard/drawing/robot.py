"""The robot in space, of plain solids: a brick, its motors, and on each a disc as measured and one as predicted.

Lengths are centimetres. The discs face the viewer, so that their angles can be read like a clock's; a positive
angle turns against the clock.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import rerun as rr

from nxt_twin.recording.columns import Port
from nxt_twin.view.dashboard.columns import Turn
from nxt_twin.view.dashboard.drawing import colours

EYE: Final = (0.0, -31.0, 11.0)
TARGET: Final = (0.0, 0.0, 1.2)

_PLACES: Final[dict[Port, float]] = {"a": -9.0, "b": 0.0, "c": 9.0}
_FRONT: Final = -7.0
_RADIUS: Final = 2.8
_GHOST_RADIUS: Final = 3.9
_UPRIGHT: Final = rr.RotationAxisAngle(axis=(1.0, 0.0, 0.0), degrees=90.0)


def static_parts(ports: Sequence[Port]) -> list[tuple[str, Any]]:
    """Everything that never moves within its own frame, as paths and what to log there once."""
    parts: list[tuple[str, Any]] = [("/robot", rr.ViewCoordinates.RIGHT_HAND_Z_UP), *_brick()]
    for port in ports:
        parts += _motor(port)
    return parts


def turned(port: Port, turn: Turn) -> list[tuple[str, Any]]:
    """Both discs of a motor in a batch, as paths and columns."""
    # Quaternions (x, y, z, w) about the axis that points to the viewer, which is -y.
    hub = (_PLACES[port], _FRONT - 1.6, 0.0)
    found = []
    for disc, degrees in (("disc", turn.measured_deg), ("ghost", turn.predicted_deg)):
        back = 0.0 if disc == "disc" else 0.9
        place = np.tile((hub[0], hub[1] + back, hub[2]), (degrees.size, 1))
        half = 0.5 * np.radians(degrees % 360.0)
        still = np.zeros_like(half)
        turns = np.column_stack([still, -np.sin(half), still, np.cos(half)])
        found.append((f"/robot/{port}/{disc}", rr.Transform3D.columns(translation=place, quaternion=turns)))
    return found


def _brick() -> list[tuple[str, Any]]:
    boxes = rr.Boxes3D(
        centers=[
            (0, 3, 4.5),
            (0, -0.05, 6.2),
            (0, -0.1, 3.4),
            (-1.6, -0.1, 3.4),
            (1.6, -0.1, 3.4),
            (0, -0.1, 2.3),
        ],
        half_sizes=[
            (3.6, 3.0, 4.5),
            (2.4, 0.1, 1.5),
            (0.6, 0.15, 0.6),
            (0.6, 0.15, 0.5),
            (0.6, 0.15, 0.5),
            (0.6, 0.15, 0.35),
        ],
        colors=[
            colours.BRICK,
            colours.SCREEN,
            colours.ORANGE,
            colours.BRICK_DARK,
            colours.BRICK_DARK,
            colours.BRICK_DARK,
        ],
        fill_mode="solid",
    )
    return [("/robot/brick", boxes)]


def _motor(port: Port) -> list[tuple[str, Any]]:
    x = _PLACES[port]
    body = rr.Boxes3D(
        centers=[(x, _FRONT + 2.0, 0.0), (x, _FRONT + 0.2, 0.0)],
        half_sizes=[(1.6, 2.0, 1.6), (1.2, 0.6, 1.2)],
        colors=[colours.BRICK, colours.ORANGE],
        fill_mode="solid",
    )
    cable = rr.LineStrips3D(
        [[(x, _FRONT + 4.0, 0.0), (x, 1.0, -0.3), (0.35 * x, 2.0, 0.0), (0.25 * x, 3.0, 0.4)]],
        radii=0.22,
        colors=[colours.BRICK_DARK],
    )
    label = rr.Points3D(
        [(x, _FRONT - 2.2, -5.2)], radii=0.01, labels=[port.upper()], colors=[colours.FIGURES]
    )
    disc = rr.Cylinders3D(
        lengths=[0.7, 0.8],
        radii=[_RADIUS, 0.7],
        centers=[(0, 0, 0), (0, -0.1, 0)],
        rotation_axis_angles=[_UPRIGHT, _UPRIGHT],
        colors=[colours.BRICK_DARK, colours.ORANGE],
        fill_mode="solid",
    )
    hand = rr.Boxes3D(
        centers=[(0.55 * _RADIUS, -0.45, 0)],
        half_sizes=[(0.4 * _RADIUS, 0.12, 0.28)],
        colors=[colours.HAND],
        fill_mode="solid",
    )
    ghost = rr.Cylinders3D(
        lengths=[0.5],
        radii=[_GHOST_RADIUS],
        rotation_axis_angles=[_UPRIGHT],
        colors=[colours.GHOST],
        fill_mode="TransparentFillMajorWireframe",
    )
    ghost_hand = rr.Boxes3D(
        centers=[(0.86 * _GHOST_RADIUS, -0.3, 0)],
        half_sizes=[(0.13 * _GHOST_RADIUS, 0.12, 0.28)],
        colors=[colours.PREDICTED],
        fill_mode="solid",
    )
    return [
        (f"/robot/{port}/body", body),
        (f"/robot/{port}/cable", cable),
        (f"/robot/{port}/label", label),
        (f"/robot/{port}/disc/wheel", disc),
        (f"/robot/{port}/disc/hand", hand),
        (f"/robot/{port}/ghost/wheel", ghost),
        (f"/robot/{port}/ghost/hand", ghost_hand),
    ]
