"""A person moves what is to be moved, and is asked to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, final

from nxt_twin.experiment.errors import StoppedError
from nxt_twin.experiment.positioner.positioner import UNITS, Limits, OneAxis, PositionerAxis, within

Ask = Callable[[str], str]
"""Shows a sentence to a person, waits, and gives what they answered."""

_REQUESTS: Final[Mapping[PositionerAxis, str]] = MappingProxyType(
    {
        "distance_mm": "put the target {value:g} mm from the sensor",
        "angle_deg": "turn the sensor to {value:g} degrees from square on",
        "force_g": "press the button with {value:g} g",
        "compression_mm": "press the button in by {value:g} mm",
        "position_mm": "put it at {value:g} mm",
    }
)
_ENDS: Final = ("q", "quit", "stop")


@final
class ByHand(OneAxis):
    """A positioner that prompts and waits.

    Args:
        axis: what the person moves.
        ask: shows the request and gives the answer. An empty answer means that the target is there, a number is its
            true value, and `q` ends the experiment.
        limits: where it may go.
    """

    def __init__(self, axis: PositionerAxis, ask: Ask, limits: Limits | None = None) -> None:
        super().__init__(axis, limits)
        self._ask = ask

    def move_to(self, value: float) -> float:
        """Ask until there is an answer that can be understood.

        Raises:
            PositionerError: `value` is out of the limits.
            StoppedError: the person ended the experiment.
        """
        wanted = within(self._limits, self._axis, value)
        request = _REQUESTS[self._axis].format(value=wanted)
        hint = f"Enter when it is there, or its true value in {UNITS[self._axis]}; q ends"
        while True:
            answer = self._ask(f"Please {request}. [{hint}] ").strip().lower()
            if not answer:
                return wanted
            if answer in _ENDS:
                raise StoppedError(f"was ended at {wanted:g}", where=self._axis, mend="run it again to go on")
            reached = _number(answer)
            if reached is not None and self._limits.lowest <= reached <= self._limits.highest:
                return reached


def _number(answer: str) -> float | None:
    try:
        return float(answer.replace(",", "."))
    except ValueError:
        return None
