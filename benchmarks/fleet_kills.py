"""Cost of killing workers of a fleet at random moments; results are counted.

python -m benchmarks fleet_kills

A task naps for some milliseconds, so that many moments are cheap; its work plays no part in the cost of a
kill.
"""

from __future__ import annotations

import os
import random
import signal
import time
from collections.abc import Iterator
from typing import Final

from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.place import Processes

KILLS: Final = 100
TASKS: Final = 8000
_NAP_S: Final = 0.004
_WORKERS: Final = 2


def report() -> Iterator[str]:
    """One line: kills, and tasks without a result."""
    draw = random.Random(1)
    moments = iter(sorted(draw.sample(range(TASKS - 1000), KILLS)))
    due, kills, ended = next(moments), 0, 0
    results, pids, dead = set(), set(), set()
    for outcome in each(_nap, range(TASKS), Processes(_WORKERS)):
        ended += 1
        if outcome.result is not None:
            results.add(outcome.task)
            pids |= {outcome.result} - dead
        if ended > due and len(pids) == _WORKERS:  # one of them waits for a task, the others are at theirs
            due = next(moments, TASKS)
            time.sleep(draw.uniform(0.0, _NAP_S))
            pid = draw.choice(sorted(pids))
            pids.remove(pid)
            dead.add(pid)
            os.kill(pid, signal.SIGKILL)
            kills += 1
    yield (
        f"{kills} workers killed by -9 at random moments over {TASKS} tasks: "
        f"{ended - len(results)} tasks given up, {TASKS - len(results)} results missing"
    )


def _nap(_number: int) -> int:
    time.sleep(_NAP_S)
    return os.getpid()


if __name__ == "__main__":
    print(*report(), sep="\n")
