"""Compilation of the truth simulator, with types kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile `function` when it is first called, and keep the machine code beside its source.

    numba renews the kept code only when the caller's own file changes: after editing a helper, delete
    the caches.
    """
    return cast("Function", njit(cache=True)(function))
