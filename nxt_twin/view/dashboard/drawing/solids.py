"""Solids, floors, echoes and ways as rerun draws them, for a world that is past and for one that goes on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Protocol

import numpy as np

from nxt_twin.arrays import FloatArray

WAY: Final = (40, 110, 200)
GHOST: Final = (230, 120, 30)
_SEE_THROUGH: Final = (*GHOST, 70)
_ECHO: Final = (220, 60, 60)
_ABOVE_M: Final = 0.002


class DrawnSolid(Protocol):
    """A shape in its body's frame; `nxt_twin.world.assembly.Shape` is one."""

    @property
    def kind(self) -> str:
        """Box, cylinder or sphere."""
        ...

    @property
    def size_m(self) -> tuple[float, ...]:
        """Edges, radius and length, or radius."""
        ...

    @property
    def at_m(self) -> tuple[float, float, float]:
        """Its middle."""
        ...

    @property
    def turned_rad(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw."""
        ...

    @property
    def colour(self) -> tuple[float, float, float, float]:
        """Red, green, blue, opacity, 0 to 1."""
        ...

    @property
    def seen(self) -> bool:
        """Whether it is drawn."""
        ...


def floor(rr: Any, shades: FloatArray, size_m: tuple[float, float]) -> Any:  # noqa: ANN401 - rerun's
    """A floor's picture: shades 0 to 1, shape (along x, along y), its middle at the origin."""
    right, far = 0.5 * size_m[0], 0.5 * size_m[1]
    grey = np.round(255.0 * np.flipud(shades.T)).astype(np.uint8)
    return rr.Mesh3D(
        vertex_positions=[(-right, -far, 0), (right, -far, 0), (right, far, 0), (-right, far, 0)],
        triangle_indices=[(0, 1, 2), (0, 2, 3)],
        vertex_texcoords=[(0, 1), (1, 1), (1, 0), (0, 0)],
        vertex_normals=[(0, 0, 1)] * 4,
        albedo_texture=np.repeat(grey[..., None], 3, axis=2),
    )


def solid(rr: Any, shape: DrawnSolid, *, ghost: bool = False) -> list[Any]:  # noqa: ANN401
    """A solid at its place, see-through where it is a ghost's."""
    from scipy.spatial.transform import Rotation

    turn = rr.Quaternion(xyzw=Rotation.from_euler("xyz", shape.turned_rad).as_quat())
    placed = rr.Transform3D(translation=shape.at_m, quaternion=turn)
    colour = [_SEE_THROUGH if ghost else tuple(round(255 * part) for part in shape.colour)]
    look = {"colors": colour, "fill_mode": "TransparentFillMajorWireframe" if ghost else "solid"}
    match shape.kind:
        case "box":
            return [placed, rr.Boxes3D(half_sizes=[tuple(0.5 * edge for edge in shape.size_m)], **look)]
        case "cylinder":
            radius, length = shape.size_m
            return [placed, rr.Cylinders3D(lengths=[length], radii=[radius], **look)]
        case _:
            return [placed, rr.Ellipsoids3D(radii=[shape.size_m[0]], **look)]


def ghost_parts(
    rr: Any,  # noqa: ANN401
    bodies: Sequence[tuple[str, Sequence[DrawnSolid], FloatArray]],
) -> list[tuple[str, Any]]:
    """A robot's bodies see-through, as paths and what to log there once.

    Args:
        rr: rerun.
        bodies: the robot's, the base first: name, solids, and the frame at one moment, shape (7,).
    """
    from scipy.spatial.transform import Rotation

    base = bodies[0][2]
    back = Rotation.from_quat(base[3:]).inv()
    found: list[tuple[str, Any]] = []
    for name, shapes, frame in bodies:
        path = f"/world/ghost/{name.rpartition('/')[2].replace(' ', '_')}"
        turn = (back * Rotation.from_quat(frame[3:])).as_quat()
        placed = rr.Transform3D(
            translation=back.apply(frame[:3] - base[:3]), quaternion=rr.Quaternion(xyzw=turn)
        )
        found.append((path, [placed]))
        for n, shape in enumerate(one for one in shapes if one.seen):
            found.append((f"{path}/{n}", solid(rr, shape, ghost=True)))
    return found


def path_of(name: str) -> str:
    """Where a body of a world is logged."""
    return f"/world/{name.replace(' ', '_')}"


def frame_columns(rr: Any, place_m: FloatArray, quaternion: FloatArray) -> Any:  # noqa: ANN401
    """A body's frames as columns, shapes (samples, 3) and (samples, 4)."""
    return rr.Transform3D.columns(translation=place_m, quaternion=quaternion)


def ghost_moved(rr: Any, pose: FloatArray) -> Any:  # noqa: ANN401
    """A ghost's frames as columns: x, y (m) and heading (rad), shape (samples, 3)."""
    still = np.zeros(len(pose))
    turns = np.column_stack([still, still, np.sin(0.5 * pose[:, 2]), np.cos(0.5 * pose[:, 2])])
    return frame_columns(rr, np.column_stack([pose[:, :2], still]), turns)


def echoes(rr: Any, rays_m: FloatArray) -> Any:  # noqa: ANN401
    """The ways of echoes, shape (rays, 2, 3)."""
    return rr.LineStrips3D(list(rays_m), colors=[_ECHO], radii=0.002)


def ways(rr: Any, places_m: Sequence[FloatArray], colour: tuple[int, int, int]) -> Any:  # noqa: ANN401
    """Ways on the floor, each of shape (places, 2)."""
    strips = [np.column_stack([places, np.full(len(places), _ABOVE_M)]) for places in places_m]
    return rr.LineStrips3D(strips, colors=[colour] * len(strips), radii=0.003)
