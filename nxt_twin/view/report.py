"""A diagnosis as one HTML file that opens anywhere: no network, no scripts, pictures inside."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

import nxt_twin
from nxt_twin.diagnose.diagnosis import Diagnosis, HeldOutRun
from nxt_twin.view import wording
from nxt_twin.view.figures import held_out_figure
from nxt_twin.view.leftover_plot import leftover_figure
from nxt_twin.view.pages import environment, file_name, largest
from nxt_twin.view.sensor_plot import is_of_sensor
from nxt_twin.view.svg import inline_svg
from nxt_twin.view.telling import most_telling
from nxt_twin.view.traces import picture_of

_MOST_RUNS_DRAWN = 5
_MOST_SPELLS = 8


@final
@dataclass(frozen=True)
class _DrawnRun:
    """A held-out run, its picture, and what the picture's caption has to explain."""

    run: HeldOutRun
    svg: str
    of_sensor: bool
    of_robot: bool
    shaded: bool
    stale_count: int


def write_report(diagnosis: Diagnosis, folder: Path) -> Path:
    """Write the report into `folder`, made where it is missing, as `<case name>.html`.

    Characters that file systems refuse become `_` in the file's name.

    Returns:
        The path of the file.

    Raises:
        OSError: the folder or the file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{file_name(diagnosis.name)}.html"
    path.write_text(render_report(diagnosis), encoding="utf-8", newline="\n")
    return path


def render_report(diagnosis: Diagnosis) -> str:
    """The report as the text of one self-contained HTML page; the same diagnosis gives the same text."""
    fit, mismatch = diagnosis.fit, diagnosis.mismatch
    page = environment().get_template("report.html.j2")
    return page.render(
        diagnosis=diagnosis,
        improves=wording.improves(diagnosis),
        drawn=[
            _draw(diagnosis, run, number)
            for number, run in enumerate(most_telling(diagnosis)[:_MOST_RUNS_DRAWN])
        ],
        leftover_svg=_draw_leftover(diagnosis),
        confusable=[effect for effect in diagnosis.effects if effect.confusable_with],
        spells=sorted(mismatch.when, key=lambda spell: -spell.strength)[:_MOST_SPELLS],
        anchored=any("anchor" in note.lower() for note in diagnosis.notes),
        largest_fit=largest(fit.baseline, fit.improved, fit.floor),
        largest_rmse=largest(
            *(error for run in diagnosis.held_out for error in (run.baseline_rmse, run.improved_rmse))
        ),
        largest_source=largest(*(finding.strength for finding in mismatch.sources)),
        intervals=any(moved.interval_95 for moved in diagnosis.refit.values()),
        rests_on=_rests_on(diagnosis),
        largest_regime=largest(*(finding.strength for finding in mismatch.regimes)),
        version=nxt_twin.__version__,
    )


def _rests_on(diagnosis: Diagnosis) -> str:
    """The anchors that any number of the diagnosis rests on, in words; empty where none does."""
    anchors = [moved.rests_on for moved in diagnosis.refit.values()]
    anchors += [estimate.rests_on for effect in diagnosis.effects for estimate in effect.params.values()]
    names = dict.fromkeys(name for some in anchors for name in some)
    return " and ".join(wording.spelled_out(name) for name in names)


def _draw(diagnosis: Diagnosis, run: HeldOutRun, number: int) -> _DrawnRun:
    picture = picture_of(diagnosis, run)
    label = (
        f"{run.recording}: measured and predicted {picture.quantity}, the command, and the errors over time"
    )
    of_sensor, of_robot = is_of_sensor(run), run.path is not None
    if run.path is not None:
        label = f"{run.recording}: the path on the floor as measured and predicted, and the errors over time"
    svg = inline_svg(held_out_figure(picture), f"run{number}", label)
    shaded = bool(picture.shaded) and not of_sensor
    return _DrawnRun(run, svg, of_sensor, of_robot, shaded, int(np.count_nonzero(run.stale > 0.5)))


def _draw_leftover(diagnosis: Diagnosis) -> str:
    """The picture of the unknown torque; empty where none was estimated."""
    leftover = diagnosis.leftover
    if leftover is None or leftover.time_s.size == 0:
        return ""
    figure = leftover_figure(leftover, improves=wording.improves(diagnosis))
    return inline_svg(figure, "leftover", "Unknown torque against speed, position and time")
