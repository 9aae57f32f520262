"""A live session as one HTML file that opens anywhere: no network, no scripts, pictures inside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import nxt_twin
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.twin.records import Event, Tick
from nxt_twin.view import numbers, wording
from nxt_twin.view.live_plot import NIS_BOUND, link_figure, motor_figure, sensors_figure
from nxt_twin.view.pages import environment
from nxt_twin.view.svg import inline_svg

MOST_TICKS: Final = 8000
_MOST_EVENTS: Final = 2000
_MOST_TOLD: Final = 200
_DIAGNOSED: Final = ("adopted", "undiagnosed")
_TROUBLES: Final = ("divergence", "stall", "slip", "link_lost", "low_battery", "undiagnosed")


@final
@dataclass
class ChannelTotals:
    """What all readings of a channel add up to, also those that are not kept.

    Attributes:
        readings: how many there were.
        believed: how many the filter believed.
        squares: sum of their normalised innovation squares.
        within: how many of the squares stayed below the bound of 95 %.
    """

    readings: int = 0
    believed: int = 0
    squares: float = 0.0
    within: int = 0


@final
@dataclass(frozen=True)
class LinkedDiagnosis:
    """A diagnosis that was made meanwhile: of which motor, in one sentence, and the name of its page."""

    port: Port
    sentence: str
    page: str


@final
class Keeper:
    """A sink that keeps what the report draws: all polls at first, then every second, then every fourth.

    Args:
        most: polls kept at most.

    Attributes:
        ticks: the polls that are kept.
        events: every event, up to a limit that no ordinary session reaches.
        count: how many polls there were.
        every: the number of polls of which one is kept.
        tallies: by channel, over all polls.
    """

    def __init__(self, most: int = MOST_TICKS) -> None:
        self.ticks: list[Tick] = []
        self.events: list[Event] = []
        self.count = 0
        self.every = 1
        self.tallies: dict[str, ChannelTotals] = {}
        self._most = most

    def tick(self, tick: Tick) -> None:
        """Take one poll."""
        for reading in tick.innovations:
            tally = self.tallies.setdefault(reading.channel, ChannelTotals())
            square = reading.normalised_square if reading.variance > 0 else 0.0
            tally.readings += 1
            tally.believed += reading.accepted
            tally.squares += square
            tally.within += square < NIS_BOUND
        if self.count % self.every == 0:
            if len(self.ticks) >= self._most:
                del self.ticks[1::2]
                self.every *= 2
            if self.count % self.every == 0:
                self.ticks.append(tick)
        self.count += 1

    def event(self, event: Event) -> None:
        """Take one event."""
        if len(self.events) < _MOST_EVENTS:
            self.events.append(event)

    def close(self) -> None:
        """Nothing to finish."""


def write_live_report(
    folder: Path,
    kept: Keeper,
    *,
    title: str,
    sentence: str = "",
    name: str = "live",
    findings: Sequence[LinkedDiagnosis] = (),
) -> Path:
    """Write the report into `folder`, made where it is missing, as `<name>.html`.

    Args:
        folder: where to.
        kept: a sink that was told of the session.
        title: of the session, such as the brick's URL.
        sentence: the session's verdict; where it is empty, the last thing that was said.
        name: of the file.
        findings: the diagnoses that were made, to be told first, with links to their pages.

    Raises:
        OSError: the folder or the file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.html"
    page = render_live_report(kept, title=title, sentence=sentence, findings=findings)
    path.write_text(page, encoding="utf-8", newline="\n")
    return path


def render_live_report(
    kept: Keeper, *, title: str, sentence: str = "", findings: Sequence[LinkedDiagnosis] = ()
) -> str:
    """The report as the text of one self-contained HTML page; the same session gives the same text."""
    templates = environment()
    templates.filters |= {
        "capitalise": wording.capitalise,
        "ordinal": wording.ordinal,
        "plain": numbers.plain,
        "quantity": wording.quantity,
        "seconds": numbers.seconds,
    }
    templates.globals["counted"] = wording.counted
    said = [event.words for event in kept.events]
    return templates.get_template("live.html.j2").render(
        title=title,
        sentence=sentence or (said[-1] if said else "Nothing was said."),
        kept=kept,
        findings=findings,
        diagnosed=any(event.kind in _DIAGNOSED for event in kept.events),
        troubles=[event.words for event in kept.events if event.kind in _TROUBLES],
        seconds=kept.ticks[-1].received_s if kept.ticks else 0.0,
        told=kept.events[-_MOST_TOLD:],
        tallies=sorted(kept.tallies.items()),
        bound=NIS_BOUND,
        pictures=_pictures(kept.ticks, kept.events, sorted(kept.tallies)),
        version=nxt_twin.__version__,
    )


def _pictures(
    ticks: Sequence[Tick], events: Sequence[Event], channels: Sequence[str]
) -> list[tuple[str, str, str]]:
    """Heading, SVG element and caption of each picture."""
    drawn = []
    ports = sorted({motor.port for tick in ticks for motor in tick.motors})
    for port in ports:
        caption = (
            "Grey: measured, and the innovation (measured less predicted). Blue: the twin's prediction and its band "
            "of two standard deviations. Orange lines: bounds within which 95 % stay while the model holds. "
            "Dashed: events of this motor. Unknown torque: what the model would need in addition; orange before a "
            "model was adopted, blue after."
        )
        svg = inline_svg(
            motor_figure(port, ticks, events), f"motor{port}", f"Motor {port.upper()} and its twin"
        )
        drawn.append((f"Motor {port.upper()}", svg, caption))
    sensors = [channel for channel in channels if channel not in {tacho_column(port) for port in ports}]
    if sensors:
        svg = inline_svg(sensors_figure(sensors, ticks), "sensors", "The sensors and their models")
        drawn.append(
            ("Sensors", svg, "Each sensor beside its own model. Crosses: readings that were not believed.")
        )
    if ticks:
        svg = inline_svg(link_figure(ticks), "link", "Latency, polls a second, and battery over time")
        drawn.append(("Link and battery", svg, "Latency: from a poll's first request to its last reply."))
    return drawn
