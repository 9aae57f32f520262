"""What has changed, as one HTML file that opens anywhere: no network, no scripts, pictures inside."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

import nxt_twin
from nxt_twin.diagnose.changed.answer import Change, Changes, ChangeVerdict
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.view import wording
from nxt_twin.view.pages import environment, file_name, largest
from nxt_twin.view.robot_plot import robot_figure
from nxt_twin.view.run_plot import run_figure
from nxt_twin.view.svg import inline_svg
from nxt_twin.view.traces import RunPicture, with_gaps

_MOST_RUNS_DRAWN = 3
_VERDICTS: dict[ChangeVerdict, str] = {
    "unchanged": "nothing differs",
    "changed": "what differs is found",
    "unexplained": "something unknown differs",
}
_NAMES = ("as before", "now", "a model of its own, all runs")
_SHARED = ("one model", "now", "a model of its own, all runs")


@final
@dataclass(frozen=True)
class _DrawnSide:
    """A recording after, and its picture."""

    run: HeldOutRun
    svg: str


def write_changes_report(changes: Changes, folder: Path) -> Path:
    """Write the page into `folder`, made where it is missing, as `<name of the side after>.html`.

    Returns:
        The path of the file.

    Raises:
        OSError: the folder or the file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{file_name(changes.name)}.html"
    path.write_text(render_changes(changes), encoding="utf-8", newline="\n")
    return path


def render_changes(changes: Changes) -> str:
    """The page's text; equal comparisons give equal texts."""
    runs = sorted(filter(_drawable, changes.held_out), key=_told, reverse=True)[:_MOST_RUNS_DRAWN]
    fit = changes.fit
    return (
        environment()
        .get_template("changes.html.j2")
        .render(
            changes=changes,
            verdicts=_VERDICTS,
            drawn=[_DrawnSide(run, _draw(changes, run, number)) for number, run in enumerate(runs)],
            largest_fit=largest(fit.baseline, fit.improved, fit.floor),
            parameters=[change for change in changes.changes if change.before is not None],
            effects=[(effect, _change_of(changes, effect.id)) for effect in changes.effects],
            version=nxt_twin.__version__,
        )
    )


def _change_of(changes: Changes, name: str) -> Change:
    return next(change for change in changes.changes if change.of == name)


def _told(run: HeldOutRun) -> float:
    gained = run.baseline_rmse - run.improved_rmse
    return gained if np.isfinite(gained) else -1.0


def _drawable(run: HeldOutRun) -> bool:
    return int(np.count_nonzero(np.isfinite(run.measured))) > 1 and bool(run.time_s[-1] > run.time_s[0])


def _draw(changes: Changes, run: HeldOutRun, number: int) -> str:
    picture = RunPicture(
        run=with_gaps(run),
        quantity=wording.quantity(changes.mismatch.channel),
        unit=changes.fit.unit,
        spells=(),
        improves=bool(changes.changes),
        floor=changes.fit.floor,
        names=_SHARED if changes.verdict == "unchanged" else _NAMES,
    )
    label = (
        f"{run.recording}: measured and predicted {picture.quantity}, the command, and the errors over time"
    )
    figure = run_figure(picture) if run.path is None else robot_figure(picture, run.path)
    return inline_svg(figure, f"run{number}", label)
