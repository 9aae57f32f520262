"""Compilation of the families' own equations, with types kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, fields
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile `function` when it is first called, and keep the machine code beside its source."""
    return cast("Function", njit(cache=True)(function))


HeldT = TypeVar("HeldT", bound="DataclassInstance")


def as_record(held: HeldT) -> HeldT:
    """A dataclass of numbers as the record that compiled functions read; it has the same fields."""
    kind = np.dtype([(field.name, np.float64) for field in fields(held)])
    return cast("HeldT", np.array([astuple(held)], dtype=kind)[0])
