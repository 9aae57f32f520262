"""One thread for linear algebra: our matrices have some ten rows, and a library's further threads only wait, busily."""

from __future__ import annotations

import os
from typing import Final

_VARIABLES: Final = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def ask_for_one_thread() -> None:
    """Let this program, and those that it starts, do linear algebra in one thread, unless the user says otherwise.

    The libraries read their number of threads when numpy is imported: call it before. It changes the environment of
    the whole process, so that only the command line and whatever starts workers call it. `import nxt_twin` leaves
    the choice to who imports.
    """
    if not any(name in os.environ for name in _VARIABLES):
        os.environ.update(dict.fromkeys(_VARIABLES, "1"))
