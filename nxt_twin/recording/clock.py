"""Times of day in text: `12:34:56.7`, whatever date stands before it, and the lengths of time that pandas prints."""

from __future__ import annotations

import re

import numpy as np

from nxt_twin.arrays import FloatArray

_TIME = re.compile(
    r"(?:(?P<days>\d+) days? \+?)?(?P<hours>\d{1,2}):(?P<minutes>\d{2}):(?P<seconds>\d{2}(?:[.,]\d+)?)"
    r"\s*(?P<half>[AaPp][Mm])?"
)
_DAY_S = 86_400.0
_HALF_DAY_H = 12


def clock_s(text: str) -> float | None:
    """Seconds since midnight of the time of day that a text holds; None where it holds none."""
    found = _TIME.search(text)
    if found is None:
        return None
    hours = int(found["hours"])
    if found["half"]:
        hours = hours % _HALF_DAY_H + (_HALF_DAY_H if found["half"].lower() == "pm" else 0)
    seconds = float(found["seconds"].replace(",", "."))
    return int(found["days"] or 0) * _DAY_S + 3600.0 * hours + 60.0 * int(found["minutes"]) + seconds


def past_midnight(stamps_s: FloatArray) -> FloatArray:
    """Times of day that go on past midnight instead of starting anew."""
    return np.asarray(np.unwrap(stamps_s, period=_DAY_S))
