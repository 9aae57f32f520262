"""A robot's run in its world as a rerun recording: bodies, floor, echoes, the way it went, and the twin's ghost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Protocol, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import NxtTwinError
from nxt_twin.view.dashboard.drawing import solids
from nxt_twin.view.dashboard.drawing.solids import DrawnSolid

_APPLICATION: Final = "nxt-twin-world"
_TIMELINE: Final = "time"
_FLUSH_S: Final = 30.0


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
        self._stream.log("/world/floor", solids.floor(self._rr, shades, size_m), static=True)

    def bodies(self, time_s: FloatArray, bodies: Sequence[BodyPath]) -> None:
        """Every body's solids, and where its frame was at each time, shape (samples,)."""
        for body in bodies:
            path = solids.path_of(body.name)
            for n, shape in enumerate(one for one in body.shapes if one.seen):
                self._stream.log(f"{path}/{n}", *solids.solid(self._rr, shape), static=True)
            self._send(path, time_s, solids.frame_columns(self._rr, body.place_m, body.quaternion))

    def echoes(self, time_s: FloatArray, rays_m: Sequence[FloatArray]) -> None:
        """The ways of echoes, for each time of shape (rays, 2, 3)."""
        for time, rays in zip(time_s, rays_m, strict=True):
            self._stream.set_time(_TIMELINE, duration=float(time))
            self._stream.log("/world/echoes", solids.echoes(self._rr, rays))

    def way(self, places_m: FloatArray) -> None:
        """The way that the robot went, shape (samples, 2)."""
        self._stream.log("/world/way", solids.ways(self._rr, [places_m], solids.WAY), static=True)

    def ghost(self, time_s: FloatArray, pose: FloatArray, robot: Sequence[BodyPath]) -> None:
        """Where the twin has the robot by its wheels alone.

        Args:
            time_s: shape (samples,).
            pose: x, y (m) and heading (rad), shape (samples, 3).
            robot: the robot's bodies, the base first, which the ghost looks like.
        """
        ways = solids.ways(self._rr, [pose[:, :2]], solids.GHOST)
        self._stream.log("/world/ghost_way", ways, static=True)
        parts = [
            (body.name, body.shapes, np.concatenate([body.place_m[0], body.quaternion[0]])) for body in robot
        ]
        for path, what in solids.ghost_parts(self._rr, parts):
            self._stream.log(path, *what, static=True)
        self._send("/world/ghost", time_s, solids.ghost_moved(self._rr, pose))

    def close(self) -> None:
        """Write what is left."""
        self._stream.flush(timeout_sec=_FLUSH_S)
        self._stream.disconnect()

    def _send(self, path: str, time_s: FloatArray, columns: Any) -> None:  # noqa: ANN401 - rerun's
        index = self._rr.TimeColumn(_TIMELINE, duration=time_s)
        self._stream.send_columns(path, indexes=[index], columns=columns)
