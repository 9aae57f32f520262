"""What workers do in tests; nothing here takes long to import."""

import os
import signal
from pathlib import Path

from nxt_twin.threads import threads_for


def doubled(number: int) -> int:
    return 2 * number


def picky(number: int) -> int:
    if number == 3:
        raise ValueError("not three")
    return number


def mortal(task: tuple[int, str]) -> int:
    """Kills its process once for each file that does not exist yet, always for the file `never`."""
    number, place = task
    mark = Path(place)
    if place and not mark.exists():
        if mark.name != "never":
            mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def own_pid(_task: int) -> int:
    return os.getpid()


def own_threads(_task: int) -> tuple[str, int]:
    """Threads of the linear algebra, and of a simulator."""
    executor, count = threads_for(None)
    executor.shutdown()
    return os.environ.get("OPENBLAS_NUM_THREADS", "as many as there are cores"), count
