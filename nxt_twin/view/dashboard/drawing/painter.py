"""Sends batches of polls to a file or a viewer: columns at a time, never a call for each poll."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final, final

import rerun as rr

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.library import name_of
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event, EventKind, Tick
from nxt_twin.view.dashboard.cloud import Cloud, CloudPicture
from nxt_twin.view.dashboard.columns import INNOVATION, NIS, READING, TORQUE, DrawnTable, Tabulator, turn_of
from nxt_twin.view.dashboard.drawing import colours, robot
from nxt_twin.view.dashboard.drawing.layout import TIMELINE, blueprint
from nxt_twin.view.dashboard.drawing.live_world import LiveWorld
from nxt_twin.view.dashboard.scene import WorldMessage

_APPLICATION: Final = "nxt-twin"
_FLUSH_S: Final = 0.8
_WRITE_S: Final = 8.0
_CLOUD_EVERY_S: Final = 0.5
_STORY_LINES: Final = 40

_LEVELS: Final[dict[EventKind, str]] = {
    "divergence": "WARN",
    "stall": "WARN",
    "slip": "WARN",
    "disconnected": "ERROR",
    "low_battery": "WARN",
    "link_lost": "ERROR",
    "stalled": "WARN",
    "undiagnosed": "WARN",
}

_Curves = Sequence[tuple[str, colours.RgbaBytes, float]]

_READING: Final[_Curves] = tuple(
    zip(
        READING,
        (colours.MEASURED, colours.PREDICTED, colours.BAND, colours.BAND),
        (2.5, 1.5, 1.0, 1.0),
        strict=True,
    )
)
_INNOVATION: Final[_Curves] = tuple(
    zip(INNOVATION, (colours.INNOVATION, colours.BOUND, colours.BOUND), (1.5, 1.0, 1.0), strict=True)
)
_SQUARE: Final[_Curves] = tuple(
    zip(NIS, (colours.INNOVATION, colours.MEAN, colours.BOUND), (1.0, 2.5, 1.0), strict=True)
)
_TORQUE: Final[_Curves] = tuple(
    zip(TORQUE, (colours.TORQUE, colours.TORQUE_BAND, colours.TORQUE_BAND), (2.0, 1.0, 1.0), strict=True)
)


@final
class Painter:
    """One recording stream, to one file or one viewer.

    Args:
        title: the recording's name in the viewer.
        ports: of the motors shown.
        channels: the sensors' columns shown.
        sink: where the stream goes.
        tab: which tab of the layout is in front.
        world: whether a robot's world has a tab.
    """

    def __init__(
        self,
        title: str,
        ports: Sequence[Port],
        channels: Sequence[str],
        sink: Path | str,
        tab: int = 0,
        *,
        world: bool = False,
    ) -> None:
        self._ports = tuple(ports)
        self._shown = not isinstance(sink, Path)
        self._stream = rr.RecordingStream(_APPLICATION)
        self._tabulator = Tabulator(ports)
        self._world = LiveWorld(self._stream)
        self._clouds = {port: Cloud(port) for port in ports}
        self._cloud_due_s = 0.0
        self._last_deg = dict.fromkeys(ports, 0.0)
        self._effects: list[str] = []
        self._named: set[str] = set()
        self._story: deque[str] = deque(maxlen=_STORY_LINES)
        layout = blueprint(ports, channels, tab, world=world)
        target = rr.FileSink(sink) if isinstance(sink, Path) else rr.GrpcSink(sink)
        self._stream.set_sinks(target, default_blueprint=layout)
        self._stream.send_recording_name(title)
        self._log_static(channels)

    def paint(
        self,
        ticks: Sequence[Tick],
        events: Sequence[Event],
        notes: Sequence[tuple[float, str]],
        world: Sequence[WorldMessage] = (),
    ) -> None:
        """Send a batch; `notes` are stamped lines of the dashboard's own for the log, `world` is about a robot's."""
        self._world.paint(world)
        for table in self._tabulator.tables(ticks):
            self._name_effect(table.path)
            self._send(table.path, table.time_s, _scalars(table))
        for port in self._ports if ticks else ():
            turn = turn_of(port, ticks, self._last_deg[port])
            if turn.time_s.size:
                self._last_deg[port] = float(turn.measured_deg[-1])
                for path, columns in robot.turned(port, turn):
                    self._send(path, turn.time_s, columns)
            self._clouds[port].add(ticks)
        for event in events:
            if event.kind == "adopted" and event.port in self._clouds:
                self._clouds[event.port].begin_anew(event.time_s)
        if ticks and ticks[-1].received_s >= self._cloud_due_s:
            self._cloud_due_s = ticks[-1].received_s + _CLOUD_EVERY_S
            self._send_clouds(ticks[-1].received_s)
        self._send_lines(events, notes)

    def close(self) -> None:
        """Send what is left and let go of the file or viewer.

        Raises:
            RuntimeError: a viewer did not take the rest in time.
        """
        self._stream.flush(timeout_sec=_FLUSH_S if self._shown else _WRITE_S)
        self._stream.disconnect()

    def _log_static(self, channels: Sequence[str]) -> None:
        for path, part in robot.static_parts(self._ports):
            self._stream.log(path, part, static=True)
        for place in (*(f"/motor_{port}" for port in self._ports), *(f"/sensors/{c}" for c in channels)):
            for curve, style in (("reading", _READING), ("innovation", _INNOVATION), ("square", _SQUARE)):
                self._style(f"{place}/{curve}", style)
            refused = rr.SeriesPoints(
                names="refused", colors=colours.REFUSED, markers="cross", marker_sizes=5.0
            )
            self._stream.log(f"{place}/refused", refused, static=True)
        for port in self._ports:
            self._style(f"/motor_{port}/torque", _TORQUE)
        self._style("/link/latency_ms", [("latency", colours.LINK, 1.5)])
        self._style("/link/polls_hz", [("polls", colours.LINK, 1.5)])
        self._style("/link/up", [("up", colours.TORQUE, 2.0)])
        self._style("/battery/volts", [("battery", colours.BATTERY, 1.5)])

    def _style(self, path: str, curves: _Curves) -> None:
        names, shades, widths = zip(*curves, strict=True)
        lines = rr.SeriesLines(names=list(names), colors=list(shades), widths=list(widths))
        self._stream.log(path, lines, static=True)

    def _name_effect(self, path: str) -> None:
        """Give an effect's curve its name and colour when it is first seen; the same for all motors."""
        _, found, effect = path.partition("/effects/")
        if not found or path in self._named:
            return
        self._named.add(path)
        if effect not in self._effects and effect != "nothing":
            self._effects.append(effect)
        place = -1 if effect == "nothing" else self._effects.index(effect)
        colour = colours.MEASURED if place < 0 else colours.EFFECTS[place % len(colours.EFFECTS)]
        words = "the model as it is" if place < 0 else name_of(effect)
        self._style(path, [(words, colour, 2.0)])

    def _send(self, path: str, time_s: FloatArray, columns: Iterable[Any]) -> None:
        self._stream.send_columns(path, [rr.TimeColumn(TIMELINE, duration=time_s)], columns)

    def _send_clouds(self, time_s: float) -> None:
        self._stream.set_time(TIMELINE, duration=time_s)
        for port, cloud in self._clouds.items():
            picture = cloud.picture()
            if picture is not None:
                for name, part in _cloud_parts(picture):
                    self._stream.log(f"/motor_{port}/cloud/{name}", part)

    def _send_lines(self, events: Sequence[Event], notes: Sequence[tuple[float, str]]) -> None:
        rows = [(event.time_s, event.words, _LEVELS.get(event.kind, "INFO")) for event in events]
        rows += [(at, words, "WARN") for at, words in notes]
        if rows:
            times, texts, levels = zip(*rows, strict=True)
            columns = rr.TextLog.columns(text=list(texts), level=list(levels))
            self._stream.send_columns("/events", [rr.TimeColumn(TIMELINE, duration=list(times))], columns)
            self._story.extend(f"- **{at:.1f} s** {text}" for at, text, _ in rows)
            self._stream.set_time(TIMELINE, duration=times[-1])
            story = rr.TextDocument("\n".join(self._story), media_type=rr.MediaType.MARKDOWN)
            self._stream.log("/story", story)


def _scalars(table: DrawnTable) -> Any:  # noqa: ANN401 - rerun's
    columns = rr.Scalars.columns(scalars=table.values.ravel())
    width = table.values.shape[1]
    return columns if width == 1 else columns.partition([width] * table.time_s.size)


def _cloud_parts(picture: CloudPicture) -> list[tuple[str, Any]]:
    shades = [(*colours.TORQUE[:3], int(200 - 130 * age)) for age in picture.age]
    lines = [picture.marks[:2], picture.marks[2:]]
    parts: list[tuple[str, Any]] = [
        ("axes", rr.LineStrips2D(lines, colors=[colours.AXES, colours.AXES], radii=0.03)),
        (
            "figures",
            rr.Points2D(
                picture.marks,
                labels=list(picture.figures),
                colors=[colours.FIGURES] * 4,
                radii=0.05,
                show_labels=True,
            ),
        ),
        ("former", rr.Points2D(picture.former, colors=[colours.FORMER] * len(picture.former), radii=0.08)),
        ("dots", rr.Points2D(picture.dots, colors=shades, radii=0.08)),
    ]
    if picture.mean.shape[0] > 1:
        parts.append(("mean", rr.LineStrips2D([picture.mean], colors=[colours.CLOUD_MEAN], radii=0.07)))
    return parts
