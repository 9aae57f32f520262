"""Machine code that numba keeps beside a module, and that holds functions of other modules."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import Any


def forget_outdated(function: Any, *modules: ModuleType) -> None:  # noqa: ANN401  # numba's functions have no type
    """Delete the machine code of a function's module that is older than one of these modules.

    Numba keeps a function's machine code as long as the function's own file stays as it is. The code also holds what
    the function calls in other files. After a change there, it would go on as before.

    Args:
        function: one that is compiled and kept, of the module that calls.
        modules: the modules that hold what it calls.
    """
    kept = Path(function.stats.cache_path)
    changed_ns = max(Path(str(module.__file__)).stat().st_mtime_ns for module in modules)
    own = Path(function.py_func.__code__.co_filename).stem
    for each in kept.glob(f"{own}.*.nb[ic]"):
        if each.stat().st_mtime_ns < changed_ns:
            with suppress(OSError):  # another process deletes it, or Windows has it in use
                each.unlink()
