"""What `live`, `replay` and `demo` share: who is told of a session, how it ends, and what is said of it."""

from __future__ import annotations

import json as json_format
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import typer
import yaml

from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.cli.lingering import Outliving, linger
from nxt_twin.cli.output import emit_json, progress
from nxt_twin.cli.showing import Showing
from nxt_twin.cli.since import Differing
from nxt_twin.cli.wanted import tidy_end
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.twin.brick_twin import TwinOptions
from nxt_twin.twin.outcome import Outcome, Sitting
from nxt_twin.twin.records import Event, Sink, Tick
from nxt_twin.twin.rehearsal import rehearse
from nxt_twin.twin.sinks import Several

if TYPE_CHECKING:
    # They bring in the pictures, which are wanted by options alone.
    from nxt_twin.view.dashboard import Dashboard
    from nxt_twin.view.live_report import Keeper


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
        dashboards: at most one.
        keeper: keeps what its report is made of.
        others: whoever else is told.
    """

    dashboards: tuple[Dashboard, ...] = ()
    keeper: Keeper | None = None
    others: tuple[Sink, ...] = ()

    def sink(self) -> Several:
        """All of them as one."""
        keepers = () if self.keeper is None else (self.keeper,)
        return Several([*map(Outliving, self.dashboards), *keepers, *self.others])


def audience(
    ports: tuple[Port, ...], channels: Sequence[str], showing: Showing, also: Sequence[Sink] = ()
) -> Audience:
    """Open what is wanted.

    Args:
        ports: of the motors that are watched.
        channels: the sensors' columns.
        showing: what is to be seen.
        also: whoever else is to be told.

    Raises:
        NxtTwinError: the dashboard cannot be opened.
    """
    dashboards: tuple[Dashboard, ...] = ()
    if showing.view != "none" or showing.save is not None:
        from nxt_twin.view.dashboard import open_dashboard

        dashboard = open_dashboard(
            view=showing.view, save=showing.save, ports=ports, channels=channels, title=showing.title,
            lossless=showing.lossless, world=showing.world,
        )  # fmt: skip
        dashboards = (dashboard,)
        if dashboard.url:
            print(f"dashboard: {dashboard.url}", file=sys.stderr, flush=True)
    keeper: Keeper | None = None
    if showing.report is not None:
        from nxt_twin.view.live_report import Keeper

        keeper = Keeper()
    printing = [] if showing.json == "-" else [Printer()]
    return Audience(dashboards=dashboards, keeper=keeper, others=(*printing, *also))


def get_ready(
    plants: Mapping[Port, Plant], options: TwinOptions | None = None, *, adopting: bool = False
) -> None:
    """Have everything compiled before the session's clock counts, with a word of it meanwhile.

    Raises:
        PlantError: the plants cannot stand side by side.
    """
    with progress("getting ready") as tell:
        tell("the first session on a machine compiles the model: 13 s of a core")
        rehearse(plants, options, adopting=adopting)


def watch(sitting: Sitting, seconds: float | None, told: Audience) -> bool:
    """Run a session to its end, or to Ctrl-C or being told to terminate, which are ordinary ends of it too.

    Its dashboards are still open then, for `linger` to end.

    Returns:
        Whether nobody interrupted it.

    Raises:
        typer.BadParameter: the URL is none.
    """
    try:
        return _run(sitting, seconds)
    except BaseException as error:
        linger(told.dashboards, until_interrupted=False)
        if isinstance(error, LinkUrlError):
            raise typer.BadParameter(str(error), param_hint="URL") from error
        raise


def _run(sitting: Sitting, seconds: float | None) -> bool:
    ended = False
    try:
        with suppress(KeyboardInterrupt), tidy_end():
            sitting.run(seconds)
            ended = True
    finally:
        sitting.close()
    return ended


def conclude_watch(
    outcome: Outcome, told: Audience, showing: Showing, since: Differing | None = None
) -> dict[str, Any]:
    """Say what a session came to, write what was wanted of it, and give its JSON.

    Args:
        outcome: of the session.
        told: who was told of it.
        showing: what is to be written.
        since: what differs from the plants that it was compared with, if it was.
    """
    sentence = outcome.verdict.sentence
    pages = [] if showing.report is None else _pages(showing.report, outcome, told, showing.title)
    if showing.model_out is not None:
        _write_models(outcome, showing.model_out)
    if since is not None and showing.report is not None:
        pages += since.pages(showing.report)
    compared = {} if since is None else {"since": since.document()}
    document = {"schema": showing.schema, **outcome.document(), **compared, "reports": pages}
    if showing.json:
        emit_json(showing.json, json_format.dumps(document, ensure_ascii=False))
    if showing.json != "-":
        print(sentence)
        for line in [] if since is None else since.lines():
            print(line)
        for page in pages:
            print(f"  report: {page}")
    return document


def _pages(report: Path, outcome: Outcome, told: Audience, title: str) -> list[str]:
    from nxt_twin.view.live_report import LinkedDiagnosis, write_live_report
    from nxt_twin.view.report import write_report

    named = [
        (port, replace(each, name=f"live-{port}-{number}"))
        for number, (port, each) in enumerate(outcome.diagnoses, start=1)
    ]
    made = [(port, diagnosis.sentence, write_report(diagnosis, report)) for port, diagnosis in named]
    pages = [str(path) for _, _, path in made]
    if told.keeper is not None:
        findings = [LinkedDiagnosis(port, said, path.name) for port, said, path in made]
        sentence = outcome.verdict.sentence
        page = write_live_report(report, told.keeper, title=title, sentence=sentence, findings=findings)
        pages.insert(0, str(page))
    return pages


def _write_models(outcome: Outcome, model_out: Path) -> None:
    """The plant of each motor; with several motors, each file's name has the port added."""
    for port, plant in outcome.plants.items():
        path = model_out.with_stem(f"{model_out.stem}-{port}") if len(outcome.plants) > 1 else model_out
        path.write_text(yaml.safe_dump(plant.to_config(), sort_keys=False), encoding="utf-8")
