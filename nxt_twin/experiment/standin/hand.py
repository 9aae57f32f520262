"""A person made of software, who does what a positioner by hand asks for."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final, final

_NUMBER: Final = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


@final
class Hand:
    """Answers prompts as a helpful person does; is passed as `Ask`.

    Args:
        put: is told the number in each request, 0 if there is none, and gives the true value to be answered, None
            for "it is there".
        ends_after: answers `q` after this number of requests; never if negative.

    Attributes:
        asked: everything that was asked.
    """

    def __init__(self, put: Callable[[float], float | None], ends_after: int = -1) -> None:
        self._put = put
        self._ends_after = ends_after
        self.asked: list[str] = []

    def __call__(self, request: str) -> str:
        """Do what is asked, and answer."""
        if len(self.asked) == self._ends_after:
            return "q"
        self.asked.append(request)
        found = _NUMBER.search(request)
        true_value = self._put(0.0 if found is None else float(found.group()))
        return "" if true_value is None else f"{true_value:.6g}"
