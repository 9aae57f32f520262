"""A robot's run in its world as a rerun recording: bodies, floor, echoes, the way it went, and the twin's ghost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Protocol, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import NxtTwinError

_APPLICATION: Final = "nxt-twin-world"
_TIMELINE: Final = "time"
_WAY: Final = (40, 110, 200)
_GHOST: Final = (230, 120, 30)
_ECHO: Final = (220, 60, 60)
_ABOVE_M: Final = 0.002
_GHOST_HALF_M: Final = (0.06, 0.05, 0.04)
_FLUSH_S: Final = 30.0


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


class BodyPath(Protocol):
    """A body and how it moved; `nxt_twin.world.motion.Moved` is one."""

    @property
    def name(self) -> str:
        """Such as ``robot/left``."""
        ...

    @property
    def shapes(self) -> Sequence[DrawnSolid]:
        """The solids that it is made of."""
        ...

    @property
    def place_m(self) -> FloatArray:
        """Of its frame, shape (samples, 3)."""
        ...

    @property
    def quaternion(self) -> FloatArray:
        """Of its frame, x, y, z, w, shape (samples, 4)."""
        ...


@final
class WorldView:
    """Writes one run to a file.

    Args:
        path: of the file, ``.rrd``.
        title: of the recording.

    Raises:
        NxtTwinError: rerun is not installed.
    """

    def __init__(self, path: Path, title: str) -> None:
        try:
            import rerun as rr
        except ImportError:
            mend = "pip install 'nxt-twin[view]'"
            raise NxtTwinError("a world's view needs rerun, which is not installed", mend=mend) from None
        self._rr: Any = rr
        path.parent.mkdir(parents=True, exist_ok=True)
        self._stream: Any = rr.RecordingStream(_APPLICATION)
        layout = rr.blueprint.Blueprint(
            rr.blueprint.Spatial3DView(origin="/world", name=title), collapse_panels=True
        )
        self._stream.set_sinks(rr.FileSink(path), default_blueprint=layout)
        self._stream.send_recording_name(title)
        self._stream.log("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def floor(self, shades: FloatArray, size_m: tuple[float, float]) -> None:
        """The floor's picture: shades 0 to 1, shape (along x, along y), its middle at the origin."""
        right, far = 0.5 * size_m[0], 0.5 * size_m[1]
        grey = np.round(255.0 * np.flipud(shades.T)).astype(np.uint8)
        mesh = self._rr.Mesh3D(
            vertex_positions=[(-right, -far, 0), (right, -far, 0), (right, far, 0), (-right, far, 0)],
            triangle_indices=[(0, 1, 2), (0, 2, 3)],
            vertex_texcoords=[(0, 1), (1, 1), (1, 0), (0, 0)],
            vertex_normals=[(0, 0, 1)] * 4,
            albedo_texture=np.repeat(grey[..., None], 3, axis=2),
        )
        self._stream.log("/world/floor", mesh, static=True)

    def bodies(self, time_s: FloatArray, bodies: Sequence[BodyPath]) -> None:
        """Every body's solids, and where its frame was at each time, shape (samples,)."""
        for body in bodies:
            path = f"/world/{body.name.replace(' ', '_')}"
            for n, solid in enumerate(shape for shape in body.shapes if shape.seen):
                self._stream.log(f"{path}/{n}", *self._drawn(solid), static=True)
            columns = self._rr.Transform3D.columns(translation=body.place_m, quaternion=body.quaternion)
            self._send(path, time_s, columns)

    def echoes(self, time_s: FloatArray, rays_m: Sequence[FloatArray]) -> None:
        """The ways of echoes, for each time of shape (rays, 2, 3)."""
        for time, rays in zip(time_s, rays_m, strict=True):
            self._stream.set_time(_TIMELINE, duration=float(time))
            self._stream.log("/world/echoes", self._rr.LineStrips3D(list(rays), colors=[_ECHO], radii=0.002))

    def way(self, places_m: FloatArray) -> None:
        """The way that the robot went, shape (samples, 2)."""
        self._line("/world/way", places_m, _WAY)

    def ghost(self, time_s: FloatArray, pose: FloatArray) -> None:
        """Where the twin has the robot by its wheels alone: x, y (m) and heading (rad), shape (samples, 3)."""
        self._line("/world/ghost_way", pose[:, :2], _GHOST)
        box = self._rr.Boxes3D(
            centers=[(-0.03, 0.0, 0.07)],
            half_sizes=[_GHOST_HALF_M],
            colors=[_GHOST],
            fill_mode="TransparentFillMajorWireframe",
        )
        self._stream.log("/world/ghost/body", box, static=True)
        still = np.zeros(len(pose))
        turns = np.column_stack([still, still, np.sin(0.5 * pose[:, 2]), np.cos(0.5 * pose[:, 2])])
        places = np.column_stack([pose[:, :2], still])
        columns = self._rr.Transform3D.columns(translation=places, quaternion=turns)
        self._send("/world/ghost", time_s, columns)

    def close(self) -> None:
        """Write what is left."""
        self._stream.flush(timeout_sec=_FLUSH_S)
        self._stream.disconnect()

    def _line(self, path: str, places_m: FloatArray, colour: tuple[int, int, int]) -> None:
        strip = np.column_stack([places_m, np.full(len(places_m), _ABOVE_M)])
        self._stream.log(path, self._rr.LineStrips3D([strip], colors=[colour], radii=0.003), static=True)

    def _drawn(self, solid: DrawnSolid) -> list[Any]:
        from scipy.spatial.transform import Rotation

        rr = self._rr
        turn = rr.Quaternion(xyzw=Rotation.from_euler("xyz", solid.turned_rad).as_quat())
        placed = rr.Transform3D(translation=solid.at_m, quaternion=turn)
        colour = [tuple(round(255 * part) for part in solid.colour)]
        match solid.kind:
            case "box":
                half = [tuple(0.5 * edge for edge in solid.size_m)]
                return [placed, rr.Boxes3D(half_sizes=half, colors=colour, fill_mode="solid")]
            case "cylinder":
                radius, length = solid.size_m
                drawn = rr.Cylinders3D(lengths=[length], radii=[radius], colors=colour, fill_mode="solid")
                return [placed, drawn]
            case _:
                ball = rr.Ellipsoids3D(radii=[solid.size_m[0]], colors=colour, fill_mode="solid")
                return [placed, ball]

    def _send(self, path: str, time_s: FloatArray, columns: Any) -> None:  # noqa: ANN401 - rerun's
        index = self._rr.TimeColumn(_TIMELINE, duration=time_s)
        self._stream.send_columns(path, indexes=[index], columns=columns)
