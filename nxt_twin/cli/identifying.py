"""Carry an experiment out, fit its recordings, and write the result, for `identify`."""

from __future__ import annotations

import json as json_format
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

import typer

from nxt_twin.api.openers import concealing, mock_options
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.cli.output import emit_json
from nxt_twin.cli.record import opened
from nxt_twin.cli.wanted import chosen_url, get_leave, tidy_end
from nxt_twin.errors import ProgramError
from nxt_twin.experiment.errors import ExperimentError, StoppedError
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified
from nxt_twin.experiment.identify import carry_out, conclude
from nxt_twin.experiment.outline import axes_of, outline
from nxt_twin.experiment.plan import Experiment, MotorIdentification, own_experiments, read_experiment
from nxt_twin.experiment.positioner.open import assigned, close_positioners, open_positioners
from nxt_twin.experiment.positioner.positioner import PositionerAxis
from nxt_twin.experiment.positioner.spec import PositionerSpec, read_spec
from nxt_twin.experiment.run_sweep import Apparatus, SweepProgress
from nxt_twin.experiment.standin.movers import standin_positioners
from nxt_twin.experiment.standin.workbench import Workbench, helper, place_sensors, workbench
from nxt_twin.recording.columns import PORTS, Port
from nxt_twin.twin.settings import pace_of


@final
@dataclass(frozen=True)
class IdentifyArguments:
    """The command line's arguments for an identification.

    Attributes:
        experiment: a name or a YAML file.
        url: of the brick; None: the first found.
        out: folder of the run; None is wrong use, except for a dry run.
        positioners: specifications of what moves the axes.
        dry_run: whether only the plan is printed.
        yes: whether motors may turn without a question.
        json: file for the JSON, or `-` for standard output; None writes none.
    """

    experiment: str
    url: str | None
    out: Path | None
    positioners: tuple[str, ...]
    dry_run: bool
    yes: bool
    json: str | None


def carry_on(asked: IdentifyArguments) -> None:
    """Carry the experiment out, or continue it, and write plant.yaml or sensor.yaml.

    Raises:
        typer.BadParameter: an argument is wrong or missing.
        NxtTwinError: the brick, a positioner or the fit failed.
    """
    wanted = read_experiment(asked.experiment)
    movers = _movers(asked.positioners, wanted)
    lines = list(outline(wanted, movers))
    if asked.dry_run:
        print(*lines, sep="\n")
        return
    if asked.out is None:
        raise typer.BadParameter("is missing: name a folder for the recordings", param_hint="--out")
    found = chosen_url(asked.url, SystemClock())
    if turned := _turned(wanted, movers):
        get_leave(found, turned, yes=asked.yes)
    bench = _bench(wanted, found) if found.split(":")[0] == "mock" else None
    folder = RunFolder(asked.out, wanted)
    screen = _Screen()
    if bench is None:
        _on_brick(wanted, found, movers, folder, screen)
    else:
        _on_mock(wanted, bench, movers, folder, screen)
    screen.clear()
    _show(conclude(wanted, folder), folder, asked.json)


def list_experiments(json: str | None) -> None:
    """Print the built-in experiments with their reasons, and write them as JSON where `json` says."""
    reasons = {name: read_experiment(name).why for name in own_experiments()}
    if json:
        told = [{"name": name, "why": why} for name, why in reasons.items()]
        answer = {"schema": "nxt-twin/experiments/1", "experiments": told}
        emit_json(json, json_format.dumps(answer, ensure_ascii=False))
    if json != "-":
        for name, why in reasons.items():
            print(f"{name:18} {why}")


def _movers(texts: Sequence[str], wanted: Experiment) -> Mapping[PositionerAxis, PositionerSpec]:
    """What moves each axis.

    Raises:
        typer.BadParameter: one of them is no positioner, or for no axis of the experiment.
    """
    try:
        return assigned([read_spec(text) for text in texts], axes_of(wanted))
    except (ProgramError, ExperimentError) as error:
        raise typer.BadParameter(str(error), param_hint="--positioner") from error


def _on_mock(
    wanted: Experiment,
    bench: Workbench,
    movers: Mapping[PositionerAxis, PositionerSpec],
    folder: RunFolder,
    screen: _Screen,
) -> None:
    with bench.brick as brick:
        positioners, ask = standin_positioners(bench, movers), helper(bench, wanted)
        carry_out(wanted, folder, Apparatus(brick, bench.clock, positioners, ask, screen.tell))


def _on_brick(
    wanted: Experiment,
    url: str,
    movers: Mapping[PositionerAxis, PositionerSpec],
    folder: RunFolder,
    screen: _Screen,
) -> None:
    clock = SystemClock()
    with tidy_end(), opened(url, clock) as brick:
        positioners = open_positioners(movers, brick, clock, screen.ask)
        try:
            around = Apparatus(brick, clock, positioners, screen.ask, screen.tell, pace_of(url))
            carry_out(wanted, folder, around)
        finally:
            close_positioners(positioners)


def _turned(wanted: Experiment, movers: Mapping[PositionerAxis, PositionerSpec]) -> tuple[Port, ...]:
    """The brick's motors that are going to turn: the one that is tried, and those of rails."""
    own = (wanted.port,) if isinstance(wanted, MotorIdentification) else ()
    return own + tuple(port for port in PORTS for spec in movers.values() if port == spec.address)


def _bench(wanted: Experiment, url: str) -> Workbench:
    try:
        options = mock_options(url.partition(":")[2])
    except LinkUrlError as error:
        raise typer.BadParameter(str(error), param_hint="URL") from error
    world, secret = options.get("world"), options.get("conceal")
    if secret is not None and isinstance(wanted, MotorIdentification) and len(wanted.loads) > 1:
        what = "a mock with a concealed effect cannot carry a disc: choose an experiment without a disc"
        raise typer.BadParameter(what, param_hint="URL")
    bench = workbench(
        None if world is None else Path(world),
        int(options.get("seed", "0")),
        options.get("profile", "none"),
        concealing(secret),
    )
    place_sensors(bench, wanted)
    return bench


def _show(identified: Identified, folder: RunFolder, json: str | None) -> None:
    written = identified.write(folder.path)
    if json:
        emit_json(json, identified.to_json())
    if json == "-":
        return
    for value in (*identified.values, *identified.compared):
        rests = f"   rests on {value.rests_on}" if value.rests_on else ""
        print(f"{value.name} = {value.value:.5g} ± {value.std:.2g} {value.unit}{rests}")
    print(*identified.notes, sep="\n")
    print("written:", *written)


@final
class _Screen:
    """Progress and questions, both on standard error: one line that is written over, or one a recording."""

    def __init__(self) -> None:
        self._over = sys.stderr.isatty()
        self._last = ""

    def tell(self, now: SweepProgress) -> None:
        """Show how far it is."""
        if self._over:
            sys.stderr.write(f"\r\x1b[2K{now.done} of {now.total}: {now.words}")
            sys.stderr.flush()
        elif (recording := now.words.split(":")[0]) != self._last:
            self._last = recording
            print(f"{now.done} of {now.total}: {recording}", file=sys.stderr)

    def ask(self, request: str) -> str:
        """Put a question and wait for the answer; the end of the input ends the experiment."""
        self.clear()
        print(request, end="", file=sys.stderr, flush=True)
        answer = sys.stdin.readline()
        if not answer:
            raise StoppedError(
                "the experiment asks a question, and standard input is closed", mend="run it on a terminal"
            )
        return answer.strip()

    def clear(self) -> None:
        """Take the line away."""
        if self._over:
            sys.stderr.write("\r\x1b[2K")
