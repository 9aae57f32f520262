"""What `live`, `replay` and `demo` share: who is told of a session, how it ends, and what is said of it."""

from __future__ import annotations

import json as json_format
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, final

import typer
import yaml

from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.cli.output import emit_json, fail, progress
from nxt_twin.cli.wanted import tidy_end
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.records import Event, Sink, Tick
from nxt_twin.twin.rehearsal import rehearse
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import FALSE_ALARMS_PER_HOUR
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.verdict import Seen, verdict

if TYPE_CHECKING:
    # They bring in the pictures, which are wanted by options alone.
    from nxt_twin.view.dashboard import Dashboard
    from nxt_twin.view.live_report import Keeper

View = Literal["spawn", "web", "none"]


@final
class Printer:
    """Says events on the terminal."""

    def tick(self, tick: Tick) -> None:
        """Nothing: the dashboard shows polls."""

    def event(self, event: Event) -> None:
        """One line."""
        print(f"{event.time_s:8.1f} s  {event.words}", flush=True)

    def close(self) -> None:
        """Nothing to finish."""


@final
@dataclass(frozen=True)
class Audience:
    """Who is told of a session.

    Attributes:
        memory: keeps its events.
        dashboards: at most one.
        keeper: keeps what its report is made of.
        others: whoever else is told.
    """

    memory: Memory = field(default_factory=Memory)
    dashboards: tuple[Dashboard, ...] = ()
    keeper: Keeper | None = None
    others: tuple[Sink, ...] = ()

    def sink(self) -> Several:
        """All of them as one."""
        keepers = () if self.keeper is None else (self.keeper,)
        return Several([self.memory, *self.dashboards, *keepers, *self.others])


def audience(
    ports: tuple[Port, ...],
    channels: Sequence[str],
    *,
    title: str,
    view: View,
    save: Path | None,
    report: bool = False,
    quiet: bool = False,
    lossless: bool = False,
    also: Sequence[Sink] = (),
) -> Audience:
    """Open what is wanted.

    Args:
        ports: of the motors that are watched.
        channels: the sensors' columns.
        title: of the session.
        view: the dashboard.
        save: where its data are kept.
        report: whether there will be one of the session.
        quiet: whether nothing is said on the terminal meanwhile.
        lossless: whether the dashboard may hold the session up.
        also: whoever else is to be told.

    Raises:
        NxtTwinError: the dashboard cannot be opened.
    """
    dashboards: tuple[Dashboard, ...] = ()
    if view != "none" or save is not None:
        from nxt_twin.view.dashboard import open_dashboard

        dashboard = open_dashboard(
            view=view, save=save, ports=ports, channels=channels, title=title, lossless=lossless
        )
        dashboards = (dashboard,)
        if dashboard.url:
            print(f"dashboard: {dashboard.url}", file=sys.stderr, flush=True)
    keeper: Keeper | None = None
    if report:
        from nxt_twin.view.live_report import Keeper

        keeper = Keeper()
    return Audience(dashboards=dashboards, keeper=keeper, others=(*([] if quiet else [Printer()]), *also))


def get_ready(
    plants: Mapping[Port, Plant], options: TwinOptions | None = None, *, adopting: bool = False
) -> None:
    """Have everything compiled before the session's clock counts, with a word of it meanwhile.

    Raises:
        PlantError: the plants cannot stand side by side.
    """
    with progress("getting ready") as tell:
        tell("the first time, the model is compiled, which takes half a minute and is kept")
        rehearse(plants, options, adopting=adopting)


def watch(session: Session, parts: Parts, seconds: float | None, told: Audience) -> None:
    """Run a session to its end, or to Ctrl-C or being told to terminate, which are ordinary ends of it too.

    Raises:
        typer.BadParameter: the URL is none.
    """
    try:
        with suppress(KeyboardInterrupt), tidy_end():
            session.run(seconds)
    except LinkUrlError as error:
        raise typer.BadParameter(str(error), param_hint="URL") from error
    finally:
        parts.sink.close()
        if parts.recorder is not None:
            parts.recorder.close()
        if parts.adopter is not None:
            parts.adopter.close()
        for trouble in (trouble for dashboard in told.dashboards for trouble in dashboard.troubles):
            fail(trouble)


def conclude(
    session: Session,
    parts: Parts,
    told: Audience,
    *,
    schema: str,
    title: str,
    json: str | None,
    model_out: Path | None = None,
    report: Path | None = None,
) -> None:
    """Say what a session came to, and write what was wanted of it."""
    diverging = [port for port, each in session.monitors.items() if each.diverging]
    said = verdict(told.memory.events, diverging, Seen(session.polls, session.lasted_s, session.unseen_s))
    pages = [] if report is None else _pages(report, parts, told, title, said.sentence)
    if model_out is not None:
        _write_models(parts.twin, model_out)
    if json:
        document = {
            "schema": schema,
            "verdict": said.outcome,
            "sentence": said.sentence,
            **_document(session, parts, told),
            "reports": pages,
        }
        emit_json(json, json_format.dumps(document, ensure_ascii=False))
    if json != "-":
        print(said.sentence)
        for page in pages:
            print(f"  report: {page}")


def _pages(report: Path, parts: Parts, told: Audience, title: str, sentence: str) -> list[str]:
    from nxt_twin.view.live_report import write_live_report
    from nxt_twin.view.report import write_report

    diagnoses = [] if parts.adopter is None else parts.adopter.diagnoses
    pages = []
    if told.keeper is not None:
        pages.append(str(write_live_report(report, told.keeper, title=title, sentence=sentence)))
    for number, (port, diagnosis) in enumerate(diagnoses, start=1):
        pages.append(str(write_report(replace(diagnosis, name=f"live-{port}-{number}"), report)))
    return pages


def _write_models(twin: BrickTwin, model_out: Path) -> None:
    """The plant of each motor; with several motors, each file's name has the port added."""
    for port, plant in twin.plants.items():
        path = model_out.with_stem(f"{model_out.stem}-{port}") if len(twin.plants) > 1 else model_out
        path.write_text(yaml.safe_dump(plant.to_config(), sort_keys=False), encoding="utf-8")


def _document(session: Session, parts: Parts, told: Audience) -> dict[str, Any]:
    diagnoses = [] if parts.adopter is None else parts.adopter.diagnoses
    return {
        "polls": session.polls,
        "stated_false_alarms_per_hour": FALSE_ALARMS_PER_HOUR,
        "stalls": {"count": session.stalls.count, "longest_s": session.stalls.longest_s},
        "motors": {
            port: {"diverging": monitor.diverging, "trouble": monitor.trouble}
            for port, monitor in session.monitors.items()
        },
        "events": [asdict(event) for event in told.memory.events],
        "diagnoses": [
            {"port": port, **json_format.loads(to_json(diagnosis))} for port, diagnosis in diagnoses
        ],
    }
