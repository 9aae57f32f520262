"""One picture of a diagnosis, before and after, to put on a page or a slide."""

from __future__ import annotations

import textwrap
from pathlib import Path

from matplotlib.figure import Figure

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.errors import DiagnosisError, NxtTwinError
from nxt_twin.view import palette, wording
from nxt_twin.view.numbers import plain, times_smaller
from nxt_twin.view.run_plot import draw_run
from nxt_twin.view.svg import drawn_svg
from nxt_twin.view.telling import most_telling
from nxt_twin.view.traces import picture_of

_WIDTH_IN = 12.0
_DOTS_PER_INCH = 100
_RUN_HEIGHT_IN = 5.9
_LINE_HEIGHT_IN = 0.27
_LETTERS_PER_LINE = 86


def write_picture(diagnosis: Diagnosis, path: Path) -> None:
    """Draw the most telling held-out run under the diagnosis' sentence, 1200 px wide.

    Args:
        diagnosis: what is drawn.
        path: a `.png` or `.svg` file.

    Raises:
        NxtTwinError: the file's ending is neither.
        DiagnosisError: there is no held-out run to draw.
        OSError: the file cannot be written.
    """
    kind = path.suffix.lower()
    if kind not in (".png", ".svg"):
        raise NxtTwinError(
            "a picture is a .png or an .svg file", where=str(path), mend="choose one of these endings"
        )
    runs = most_telling(diagnosis)
    if not runs:
        raise DiagnosisError("there is no held-out run to draw", where=diagnosis.name)
    sentence = textwrap.wrap(diagnosis.sentence, _LETTERS_PER_LINE) or [""]
    head_in = 0.95 + _LINE_HEIGHT_IN * len(sentence)
    figure = Figure(figsize=(_WIDTH_IN, _RUN_HEIGHT_IN + head_in))
    _write_head(figure, diagnosis, sentence)
    draw_run(figure, picture_of(diagnosis, runs[0]), top=1 - (head_in + 0.3) / (_RUN_HEIGHT_IN + head_in))
    if kind == ".svg":
        path.write_text(drawn_svg(figure), encoding="utf-8", newline="\n")
    else:
        figure.savefig(path, format="png", dpi=_DOTS_PER_INCH, metadata={"Software": None})


def _write_head(figure: Figure, diagnosis: Diagnosis, sentence: list[str]) -> None:
    """Case and verdict, then the sentence, then what it does to the error on held-out data."""
    height_in = figure.get_figheight()
    lines = [
        (f"{diagnosis.name}: {diagnosis.verdict}, {wording.VERDICTS[diagnosis.verdict]}", 10.0, palette.MUTED)
    ]
    below_in = [0.34]
    for number, line in enumerate(sentence):
        lines.append((line, 15.0, palette.INK))
        below_in.append(0.68 + _LINE_HEIGHT_IN * number)
    lines.append((_gain(diagnosis), 10.0, palette.MUTED))
    below_in.append(below_in[-1] + 0.3)
    for (text, size_pt, colour), depth_in in zip(lines, below_in, strict=True):
        figure.text(
            0.022, 1 - depth_in / height_in, text, fontsize=size_pt, color=colour, va="baseline",
            fontweight="bold" if size_pt > palette.TEXT_PT + 2 else "normal", parse_math=False,
        )  # fmt: skip


def _gain(diagnosis: Diagnosis) -> str:
    fit = diagnosis.fit
    noise = f"noise alone would give {plain(fit.floor)} {fit.unit}"
    if not wording.improves(diagnosis):
        return f"error on data that was not fitted: {plain(fit.baseline)} {fit.unit}; {noise}"
    smaller = times_smaller(fit.baseline, fit.improved)
    gained = f"{plain(fit.baseline)} → {plain(fit.improved)} {fit.unit}{f', {smaller}' if smaller else ''}"
    return f"error on data that was not fitted: {gained}; {noise}"
