"""What all pages have in common: their templates, bars and file names."""

from __future__ import annotations

import math
import re
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from nxt_twin.diagnose.units import after_number
from nxt_twin.view import numbers, wording

_LONGEST_FILE_NAME = 200  # bytes: file systems refuse more than 255


@cache
def environment() -> Environment:
    """The templates of all pages, with the words and numbers that they use; one for all, so each is compiled once."""
    environment = Environment(
        loader=PackageLoader("nxt_twin.view"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "after_number": after_number,
        "capitalise": wording.capitalise,
        "chance": numbers.chance,
        "p_value": numbers.p_value,
        "plain": numbers.plain,
        "rough": numbers.rough,
        "sentence": wording.as_sentence,
        "seconds": numbers.seconds,
        "tenths": numbers.tenths,
        "spelled_out": wording.spelled_out,
    }
    environment.globals |= {
        "bar": bar,
        "change": numbers.change,
        "counted": wording.counted,
        "equations": wording.EQUATIONS,
        "sources": wording.SOURCES,
        "times_smaller": numbers.times_smaller,
        "verdicts": wording.VERDICTS,
        "with_doubt": numbers.with_doubt,
    }
    return environment


def largest(*values: float) -> float:
    """The largest of the values that are finite; 0 where none is."""
    return max((value for value in values if math.isfinite(value)), default=0.0)


def bar(value: float, largest: float) -> str:
    """The length of a bar in percent of its cell; a value that is not finite fills it."""
    if not math.isfinite(value):
        return "100"
    return f"{100 * max(value / largest, 0.0):.1f}" if largest > 0 else "0"


def file_name(case: str) -> str:
    """The name of a case's page without its ending; what file systems refuse becomes `_`."""
    name = re.sub(r'[<>:"/\\|?*\x00-\x1f]', "_", case).strip(" .")
    return name.encode()[:_LONGEST_FILE_NAME].decode(errors="ignore") or "diagnosis"
