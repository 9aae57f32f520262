"""Cases made by the truth simulator of the benchmark, which shares nothing with the fit."""

from functools import cache
from pathlib import Path
from typing import Any

from nxt_twin.blind.make import make_case
from nxt_twin.diagnose.engine import MotorAnswer, diagnose
from nxt_twin.recording.case import Case

LONG: dict[str, Any] = {"seed": 11, "seconds": 12.0}
"""Of recordings in which a simulation of ten seconds can be held against what was read."""

LETS_GO: dict[str, Any] = {"seed": 152, "seconds": 12.0}
"""Of three recordings of a clean motor only the one held out lets it run without current."""

TWISTING: dict[str, Any] = {"seed": 151, "seconds": 8.0}
"""Of a motor whose shaft twists, and which never runs without current."""


@cache
def concealed(
    effects: tuple[str, ...],
    *,
    seed: int,
    size: str = "medium",
    link: str = "usb",
    seconds: float = 6.0,
) -> Case:
    """A motor with `effects` concealed in it, recorded three times for `seconds`."""
    made = make_case(seed, effects=effects, size=size if effects else None, link=link, duration_s=seconds)
    listed = made.content["recordings"]
    fitted = tuple(r for r in made.recordings if r.name in listed)
    held_out = tuple(r for r in made.recordings if r.name not in listed)
    return Case(made.name, Path(), made.content["plant"], fitted, held_out, "a")


@cache
def diagnosed(effects: tuple[str, ...], **made: Any) -> MotorAnswer:
    """The diagnosis of what `concealed` makes of these."""
    return diagnose(concealed(effects, **made))
