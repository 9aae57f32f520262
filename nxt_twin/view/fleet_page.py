"""A fleet's findings as one HTML page that opens anywhere: no network, no scripts, pictures inside."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Final

import nxt_twin
from nxt_twin.diagnose.units import after_number
from nxt_twin.fleet.findings.values import LEVEL, UNKNOWN, Findings, Outlier
from nxt_twin.view import numbers
from nxt_twin.view.fleet_plot import drifts_figure, parameters_figure
from nxt_twin.view.pages import environment
from nxt_twin.view.svg import inline_svg
from nxt_twin.view.wording import capitalise, counted, spelled_out

MOST_LISTED: Final = 50
"""Rows of a list on the page; the table holds all."""
_LEAST_RATE: Final = 1e-3
_MOST_DRAWN: Final = 6
_MOST_PARAMETERS: Final = 12


def write_fleet_page(findings: Findings, folder: Path, table: str) -> Path:
    """Write the page into `folder`, made where it is missing, as `fleet.html`.

    Raises:
        OSError: the folder or the file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "fleet.html"
    path.write_text(render_fleet_page(findings, table), encoding="utf-8", newline="\n")
    return path


def render_fleet_page(findings: Findings, table: str) -> str:
    """The page's text: self-contained; the same findings give the same text."""
    templates = environment()
    templates.filters |= {
        "after_number": after_number,
        "capitalise": capitalise,
        "chance": numbers.chance,
        "plain": numbers.plain,
        "rate": _rate,
        "spelled_out": spelled_out,
    }
    templates.globals |= {"with_doubt": numbers.with_doubt, "counted": counted, "unknown": UNKNOWN}
    return templates.get_template("fleet.html.j2").render(
        findings=findings,
        table=table,
        sentence=fleet_sentence(findings),
        level=LEVEL,
        most=MOST_LISTED,
        units={each.name: each.unit for each in findings.parameters},
        names=_effect_names(),
        compare=_compare,
        parameters_svg=_parameters(findings),
        drifts_svg=_drifts(findings),
        version=nxt_twin.__version__,
    )


def fleet_sentence(findings: Findings) -> str:
    """The first sentence of the page, for a person."""
    if not findings.units:
        return f"No session of {findings.sessions} could be diagnosed."
    lacking = len({lack.unit for lack in findings.lacks})
    thing = "unit" if findings.units == 1 else "units"
    surely = f"{lacking} of {findings.units} {thing} {'lacks' if lacking == 1 else 'lack'} physics"
    parts = [surely if lacking else "No unit surely lacks physics"]
    drifting = len({drift.unit for drift in findings.drifts})
    far = len({outlier.unit for outlier in findings.outliers})
    batches = len({common.batch for common in findings.commons})
    for count, thing, verb in (
        (drifting, "unit", "drift"),
        (far, "unit", "stand out"),
        (batches, "batch", "differ from the others"),
    ):
        if count:
            parts.append(f"{_plural(count, thing)} {_verb(verb, count)}")
    return capitalise("; ".join(parts)) + "."


def _plural(count: int, thing: str) -> str:
    return counted(count, thing) if count == 1 or thing != "batch" else f"{counted(count, thing)[:-1]}es"


def _verb(verb: str, count: int) -> str:
    first, _, rest = verb.partition(" ")
    return verb if count != 1 else f"{first}s {rest}".strip()


def _effect_names() -> dict[str, str]:
    """Names of the effects of motors and axes by id; a sensor's or robot's effect is told by its id."""
    from nxt_twin.physics.library import library

    return {UNKNOWN: "unknown physics"} | {effect.id: effect.name for effect in library().values()}


def _rate(q: float) -> str:
    """A false discovery rate; below a thousandth, the tails of the tests are not to be believed."""
    return "< 0.001" if q < _LEAST_RATE else numbers.plain(q, 2)


def _compare(outlier: Outlier) -> str:
    """The command that compares a unit with a typical one; empty where one is no single file of this machine."""
    sources = outlier.typical[1], outlier.source
    usable = all(each.endswith((".csv", ".parquet")) and "://" not in each for each in sources)
    return f"nxt-twin changed {shlex.join(sources)}" if usable else ""


def _parameters(findings: Findings) -> str:
    if not findings.parameters:
        return ""
    shown = findings.parameters[:_MOST_PARAMETERS]
    figure = parameters_figure(Findings(**{**vars(findings), "parameters": shown}))
    return inline_svg(figure, "parameters", "How many units have which value of each parameter")


def _drifts(findings: Findings) -> str:
    if not findings.drifts:
        return ""
    units = {each.name: each.unit for each in findings.parameters}
    figure = drifts_figure(findings.drifts[:_MOST_DRAWN], units)
    return inline_svg(figure, "drifts", "Drifting parameters over time")
