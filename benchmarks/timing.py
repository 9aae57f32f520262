"""How long a call takes."""

from __future__ import annotations

import time
from collections.abc import Callable


def times_s(call: Callable[[], object], repeats: int) -> list[float]:
    """Wall-clock time of each of `repeats` calls, s."""
    taken = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        taken.append(time.perf_counter() - began)
    return taken
