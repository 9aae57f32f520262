"""Hold a session with a mock brick that conceals an effect, and print what it conceals, for `demo`."""

from __future__ import annotations

import json as json_format
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import typer
import yaml

from nxt_twin.blind.secret import Secret, concealed, drawable, read_secret
from nxt_twin.cli.holding import LIVE_SCHEMA, hold
from nxt_twin.cli.output import emit_json
from nxt_twin.cli.showing import Showing, ViewChoice
from nxt_twin.cli.watching import get_ready
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.library import library
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.columns import Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.twin.driver import excitation
from nxt_twin.twin.ending import Ending
from nxt_twin.twin.live import LiveOptions
from nxt_twin.twin.outcome import Outcome
from nxt_twin.twin.settings import pace_of

_NOTHING = "nothing"
_PLANT = "nxt_motor"
_LEAVING_S = 5.0


@final
@dataclass(frozen=True)
class DemoArguments:
    """The command line's arguments for the demo.

    Attributes:
        out: folder for its files.
        seed: draws the concealed effect.
        seconds: longest session.
        conceal: an effect's id, or `nothing`; None draws one.
        view: the dashboard.
        json: file for the JSON, or `-` for standard output; None writes none.
    """

    out: Path
    seed: int
    seconds: float
    conceal: str | None
    view: ViewChoice
    json: str | None


def demonstrate(asked: DemoArguments) -> None:
    """Hold the session, and print the verdict, the concealed effect and the score.

    Raises:
        typer.BadParameter: `asked.conceal` names no effect that can be concealed.
        typer.Exit: the brick answered no poll.
        NxtTwinError: the mock or the session failed.
    """
    asked.out.mkdir(parents=True, exist_ok=True)
    secret_file = _conceal(asked.conceal, asked.seed, asked.out)
    recording = asked.out / "recording.csv"
    for old in (recording, recording.with_suffix(".yaml")):
        old.unlink(missing_ok=True)  # of the demo before; a recording is never written over otherwise
    with _mock(secret_file) as announced, redirect_stdout(sys.stderr if asked.json == "-" else sys.stdout):
        plants: dict[Port, Plant] = {"a": plant_from_config(load_plant_config(_PLANT), "power_pct")}
        get_ready(plants, adopting=True)
        url = announced()
        print(
            f"mock brick at {url}; its motor A {'may differ' if asked.conceal is None else 'differs'} from the model"
        )
        outcome, live = _held(url, plants, recording, asked.seconds, _showing(url, asked.out, asked.view))
    truth = read_secret(secret_file)
    if asked.json:
        document = {"schema": "nxt-twin/demo/2", "live": live, "truth": truth.revealed()}
        emit_json(asked.json, json_format.dumps(document, ensure_ascii=False))
    if asked.json != "-":
        print(f"\nthe concealed truth: {_truth(truth)}")
        hidden = [str(effect["id"]) for effect in truth.effects]
        print(_score([diagnosis for _, diagnosis in outcome.diagnoses], hidden))
        print(f"all files are in {asked.out}")


def _held(
    url: str, plants: dict[Port, Plant], recording: Path, seconds: float, showing: Showing
) -> tuple[Outcome, dict[str, Any]]:
    ending = Ending()
    options = LiveOptions(
        plants,
        program=excitation(tuple(plants)),
        adopt=True,
        experiment=True,
        out=recording,
        pace=pace_of(url),
        enough=ending.enough,
    )
    return hold(url, options, seconds, showing, also=[ending])


def _showing(url: str, out: Path, view: ViewChoice) -> Showing:
    return Showing(
        title=url,
        schema=LIVE_SCHEMA,
        view=view,
        save=_saved(out),
        report=out,
        model_out=out / "adopted.yaml",
        json=str(out / "live.json"),
    )


def _conceal(wanted: str | None, seed: int, out: Path) -> Path:
    """Write what is to be concealed, unseen, to a file."""
    known = sorted(set(drawable()) & set(library()))
    if wanted not in (None, _NOTHING, *known):
        raise typer.BadParameter(
            f"'{wanted}' is none of {_NOTHING}, {', '.join(known)}", param_hint="--conceal"
        )
    drawn = [str(effect["id"]) for effect in concealed(seed).effects] if wanted is None else [wanted]
    effects = [] if wanted == _NOTHING else drawn
    path = out / "concealed.yaml"
    document = {"port": "a", "effects": effects, "size": "medium", "seed": seed}
    path.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    return path


@contextmanager
def _mock(secret: Path) -> Iterator[Callable[[], str]]:
    """A mock brick in a program of its own, which gets ready meanwhile; waits for the URL at which it is reached."""
    command = [
        sys.executable,
        "-m",
        "nxt_twin",
        "mock",
        "--tcp",
        "127.0.0.1:0",
        "--profile",
        "usb",
        "--conceal",
        str(secret),
        "--json",
        "-",
    ]
    with subprocess.Popen(  # noqa: S603 - this program itself, with a path that it has just written
        command, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    ) as serving:

        def announced() -> str:
            line = serving.stdout.readline() if serving.stdout else ""
            if not line:
                raise NxtTwinError("the mock brick did not start", mend="nxt-twin mock says why")
            return str(json_format.loads(line)["urls"][0])

        try:
            yield announced
        finally:
            serving.terminate()
            try:
                serving.wait(_LEAVING_S)
            except subprocess.TimeoutExpired:
                serving.kill()


def _saved(out: Path) -> Path | None:
    """Where the dashboard's data go; None where the viewer's package is not installed."""
    try:
        import rerun  # noqa: F401
    except ImportError:
        print("the dashboard's data are not kept; mend: pip install 'nxt-twin[view]'")
        return None
    return out / "session.rrd"


def _truth(secret: Secret) -> str:
    told = [f"{effect['id']} ({_numbers(effect['params'])})" for effect in secret.effects]
    return "; ".join(told) or "nothing"


def _numbers(params: dict[str, Any]) -> str:
    return ", ".join(f"{key} = {value:.4g}" for key, value in params.items())


def _score(diagnoses: Sequence[Diagnosis], truth: list[str]) -> str:
    """How near the twin came, in words."""
    effects = [effect for diagnosis in diagnoses for effect in diagnosis.effects]
    found = {effect.id for effect in effects}
    near = {other.id for effect in effects for other in effect.confusable_with}
    if found == set(truth):
        return "named exactly" if truth else "rightly, nothing was named"
    if set(truth) & (found | near):
        return "named, but not alone: the reports list the effects that look alike"
    return "missed: no diagnosis names the concealed effect"
