"""Numba without scipy's linear algebra, which no kernel here uses and which is a fifth of a start."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Final

_ASKS: Final = "numba.np.arraymath"
_HOLDS: Final = "numba.np.linalg"
_CHECK: Final = "ensure_blas"


def import_without_blas() -> None:
    """Import numba's mathematics of arrays, and pass over its check for BLAS.

    Numba asks for BLAS when it imports that module, whether or not a function multiplies matrices. It asks again when
    it compiles such a function, and then finds its own check in place.
    """
    if _ASKS in sys.modules:
        return
    holder = import_module(_HOLDS)
    if not hasattr(holder, _CHECK):  # another version of numba: it asks as it likes
        return
    check = getattr(holder, _CHECK)
    setattr(holder, _CHECK, lambda: None)
    try:
        import_module(_ASKS)
    finally:
        setattr(holder, _CHECK, check)
