"""A robot's world as it goes on, beside the plots of a live session: bodies, echoes, ways and the twin's ghost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, final

import numpy as np
import rerun as rr

from nxt_twin.view.dashboard.drawing import solids
from nxt_twin.view.dashboard.drawing.layout import TIMELINE
from nxt_twin.view.dashboard.scene import Scenery, WorldMessage, WorldMoment

_ROBOT: Final = "robot/"
_STEP_M: Final = 0.004
_MOST_PLACES: Final = 2000


@final
class LiveWorld:
    """Draws into a stream what is told of a world.

    Args:
        stream: rerun's recording stream.
    """

    def __init__(self, stream: Any) -> None:  # noqa: ANN401 - rerun's
        self._stream = stream
        self._scenery: Scenery | None = None
        self._ghost_drawn = False
        self._way: list[tuple[float, float]] = []
        self._ghost_ways: list[list[tuple[float, float]]] = []

    def paint(self, messages: Sequence[WorldMessage]) -> None:
        """Draw a batch."""
        for message in messages:
            if isinstance(message, Scenery):
                self._put_up(message)
        moments = [message for message in messages if isinstance(message, WorldMoment)]
        if self._scenery is None or not moments:
            return
        if not self._ghost_drawn:
            self._draw_ghost(self._scenery, moments[0])
        self._move(self._scenery, moments)
        self._go(moments)

    def _put_up(self, scenery: Scenery) -> None:
        self._scenery = scenery
        self._stream.log("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        shades = np.array(scenery.shades) / 255.0
        self._stream.log("/world/floor", solids.floor(rr, shades, scenery.floor_m), static=True)
        for name, shapes in scenery.bodies:
            for n, shape in enumerate(one for one in shapes if one.seen):
                self._stream.log(f"{solids.path_of(name)}/{n}", *solids.solid(rr, shape), static=True)

    def _draw_ghost(self, scenery: Scenery, moment: WorldMoment) -> None:
        robot = [
            (name, shapes, np.array(frame))
            for (name, shapes), frame in zip(scenery.bodies, moment.frames, strict=True)
            if name.startswith(_ROBOT)
        ]
        for path, parts in solids.ghost_parts(rr, robot):
            self._stream.log(path, *parts, static=True)
        self._ghost_drawn = True

    def _move(self, scenery: Scenery, moments: Sequence[WorldMoment]) -> None:
        time_s = np.array([moment.time_s for moment in moments])
        frames = np.array([moment.frames for moment in moments])
        for n, (name, _) in enumerate(scenery.bodies):
            self._send(
                solids.path_of(name), time_s, solids.frame_columns(rr, frames[:, n, :3], frames[:, n, 3:])
            )
        seen = [moment for moment in moments if moment.ghost is not None]
        if seen:
            poses = np.array([moment.ghost for moment in seen])
            times = np.array([moment.time_s for moment in seen])
            self._send("/world/ghost", times, solids.ghost_moved(rr, poses))
        for moment in moments:
            self._stream.set_time(TIMELINE, duration=moment.time_s)
            rays = np.array(moment.echoes_m).reshape(-1, 2, 3)
            self._stream.log("/world/echoes", solids.echoes(rr, rays))

    def _go(self, moments: Sequence[WorldMoment]) -> None:
        """Draw the ways of robot and ghosts as far as they have come."""
        for moment in moments:
            _append(self._way, (moment.frames[0][0], moment.frames[0][1]))
            if moment.ghost is None:
                continue
            while len(self._ghost_ways) < moment.ghosts:
                self._ghost_ways.append([])
            _append(self._ghost_ways[moment.ghosts - 1], moment.ghost[:2])
        self._stream.set_time(TIMELINE, duration=moments[-1].time_s)
        lines = (("way", [self._way], solids.WAY), ("ghost_way", self._ghost_ways, solids.GHOST))
        for name, ways, colour in lines:
            long = [np.array(way) for way in ways if len(way) > 1]
            self._stream.log(f"/world/{name}", solids.ways(rr, long, colour))

    def _send(self, path: str, time_s: Any, columns: Any) -> None:  # noqa: ANN401 - rerun's
        self._stream.send_columns(path, [rr.TimeColumn(TIMELINE, duration=time_s)], columns)


def _append(way: list[tuple[float, float]], place: tuple[float, float]) -> None:
    """Go on to a place that is some way off; a long way keeps every second place."""
    if way and abs(complex(*place) - complex(*way[-1])) < _STEP_M:
        return
    way.append(place)
    if len(way) > _MOST_PLACES:
        del way[1:-1:2]
