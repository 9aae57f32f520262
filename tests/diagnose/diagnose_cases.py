"""Cases made by the truth simulator of the benchmark, which shares nothing with the fit."""

from functools import cache
from pathlib import Path

from nxt_twin.blind.make import make_case
from nxt_twin.diagnose.engine import Answer, diagnose
from nxt_twin.recording.case import Case


@cache
def concealed(effects: tuple[str, ...], *, seed: int, size: str = "medium", link: str = "usb") -> Case:
    """A motor with `effects` concealed in it, recorded three times for 8 s."""
    made = make_case(seed, effects=effects, size=size if effects else None, link=link, duration_s=8.0)
    listed = made.content["recordings"]
    fitted = tuple(r for r in made.recordings if r.name in listed)
    held_out = tuple(r for r in made.recordings if r.name not in listed)
    return Case(made.name, Path(), made.content["plant"], fitted, held_out, "a")


@cache
def diagnosed(effects: tuple[str, ...], *, seed: int, size: str = "medium", link: str = "usb") -> Answer:
    """Its diagnosis."""
    return diagnose(concealed(effects, seed=seed, size=size, link=link))
