"""The source paper recomputed, as one HTML page."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

import nxt_twin
from nxt_twin.paper.reproduction import FROM_FIGURES_ONLY, Reproduction
from nxt_twin.view.numbers import plain
from nxt_twin.view.paper_figures import emf_figure, limits_figure, models_figure, touch_figure, units_figure
from nxt_twin.view.svg import inline_svg


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
    """The page's text: self-contained, no scripts; always the same."""
    environment = Environment(
        loader=PackageLoader("nxt_twin.view"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plain"] = plain
    return environment.get_template("paper.html.j2").render(
        reproduction=reproduction,
        agreeing=sum(comparison.agrees for comparison in reproduction.comparisons),
        figures=_figures(reproduction),
        from_figures_only=FROM_FIGURES_ONLY,
        version=nxt_twin.__version__,
    )


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
    )  # fmt: skip
    return [
        (inline_svg(figure, f"figure{number}", caption), caption)
        for number, (caption, figure) in enumerate(drawn)
    ]
