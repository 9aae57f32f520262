"""The source paper recomputed, as one HTML page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from markupsafe import Markup, escape

import nxt_twin
from nxt_twin.paper.reproduction import FROM_FIGURES_ONLY, Reproduction
from nxt_twin.paper.touch import TABLES, means, sensor_deviations
from nxt_twin.view.pages import environment
from nxt_twin.view.paper_figures import emf_figure, limits_figure, models_figure, touch_figure, units_figure
from nxt_twin.view.paper_models import beam_figure, sensors_figure
from nxt_twin.view.svg import inline_svg

_SUBSCRIPT: Final = re.compile(r"\b([A-Za-z])_([a-z])\b")
_POWER: Final = re.compile(r"(?<=\d)e(-?\d+)")


def write_paper_page(reproduction: Reproduction, folder: Path) -> Path:
    """Write the page into `folder`, made where it is missing, as `paper.html`.

    Raises:
        OSError: the folder or the file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "paper.html"
    path.write_text(render_paper_page(reproduction), encoding="utf-8", newline="\n")
    return path


def render_paper_page(reproduction: Reproduction) -> str:
    """The page's text: self-contained, without scripts, and reproducible."""
    pages = environment()
    pages.filters["set"] = _set
    return pages.get_template("paper.html.j2").render(
        reproduction=reproduction,
        agreeing=sum(comparison.agrees for comparison in reproduction.comparisons),
        figures=_figures(reproduction),
        touch=_touch_rows(),
        from_figures_only=FROM_FIGURES_ONLY,
        version=nxt_twin.__version__,
    )


def _set(text: str) -> Markup:
    """Text as a page sets it: `K_s` with an index, `3.5e-4` with a power of ten."""
    indexed = _SUBSCRIPT.sub(r"\1<sub>\2</sub>", str(escape(text)))
    return Markup(_POWER.sub(r"·10<sup>\1</sup>", indexed))  # noqa: S704 - escaped above


def _touch_rows() -> list[list[str]]:
    """Of each sensor its number and, of each table, mean and standard deviation."""
    columns = [
        [
            f"{mean:.{digits}f} ± {std:.{digits}f}"
            for mean, std in zip(means(table), sensor_deviations(table), strict=True)
        ]
        for table, digits in zip(TABLES, (2, 2, 3, 3), strict=True)
    ]
    return [[str(number), *cells] for number, cells in enumerate(zip(*columns, strict=True), 1)]


def _figures(reproduction: Reproduction) -> list[tuple[str, str]]:
    """Each picture as an SVG element, with its caption."""
    drawn = (
        ("Figure 6: emf of the open motor against speed, and what each line leaves.", emf_figure(reproduction.motor)),
        (
            "Figures 7 and 8: speed against voltage by each model, and its error against the measured line (the speeds"
            " behind the line are not printed).",
            models_figure(reproduction.motor),
        ),
        (
            "Figure 9: voltage and current are limited. The figure gives no number for the current's limit; the one"
            " drawn is an example.",
            limits_figure(),
        ),
        ("Figure 14: the hysteresis of touch sensor 1.", touch_figure()),
        ("Tables III to VI: each dot is a reading; darker where several fall together.", units_figure()),
        (
            "Figures 11 and 16, MODELLED: readings drawn from configs/sensors, not the paper's data. Of the light"
            " sensor the text gives no number at all.",
            sensors_figure(),
        ),
        (
            "Figure 17, MODELLED: the beam of configs/sensors. From the text are 55 degrees at 438 mm, and that it"
            " widens up to there and narrows beyond.",
            beam_figure(),
        ),
    )  # fmt: skip
    return [
        (inline_svg(figure, f"figure{number}", caption), caption)
        for number, (caption, figure) in enumerate(drawn)
    ]
