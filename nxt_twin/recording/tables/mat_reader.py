"""A program of its own that reads one MAT file for `mat`: what ends it by a signal ends nobody else.

It imports nothing of this project. It writes one line of JSON with the shapes of the variables and of the fields of
structs (`log.speed`, `log.signals[0].values`). It then reads one line with the wanted names. For each name it writes a
line and, for an array of real numbers, the array's bytes.
"""

from __future__ import annotations

import json
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat, whosmat

_REAL = "biuf"
_CPU_MOST_S = 60


def main(path: str, most_bytes: int) -> None:
    """Read `path` in the two steps, in no more than a limit of memory beyond what the libraries take."""
    _bound(most_bytes)
    try:
        found = whosmat(path, appendmat=False)
        structs = [name for name, _, kind in found if kind == "struct"]
        fields = _fields_of(path, structs) if structs else {}
        _tell(
            {"shapes": {**{n: shape for n, shape, _ in found}, **{n: np.shape(f) for n, f in fields.items()}}}
        )
        wanted = json.loads(sys.stdin.readline())
        plain = [name for name in wanted if name not in fields]
        variables = loadmat(path, appendmat=False, variable_names=plain) if plain else {}
        for name in wanted:
            _send(fields[name] if name in fields else variables[name])
    except Exception as failure:  # a damaged file makes the parser fail in any way it can
        _tell({"error": f"{failure}" or type(failure).__name__})


def _fields_of(path: str, structs: list[str]) -> dict[str, NDArray[Any]]:
    """Every array of numbers within these structs, by its full name."""
    fields: dict[str, NDArray[Any]] = {}
    waiting = list(loadmat(path, appendmat=False, variable_names=structs, simplify_cells=True).items())
    while waiting:
        name, value = waiting.pop(0)
        if isinstance(value, dict):
            waiting += [(f"{name}.{key}", inner) for key, inner in value.items()]
        elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
            waiting += [
                (f"{name}[{index}]", inner) for index, inner in enumerate(value) if isinstance(inner, dict)
            ]
        elif "." in name and np.asarray(value).dtype.kind in _REAL:
            fields[name] = np.asarray(value)
    return fields


def _send(values: object) -> None:
    array: NDArray[Any] = np.asarray(values)
    if array.dtype.kind not in _REAL:
        _tell({"kind": f"{array.dtype} of shape {array.shape}"[:200]})
        return
    _tell({"dtype": array.dtype.str, "shape": array.shape})
    sys.stdout.buffer.write(array.tobytes())
    sys.stdout.buffer.flush()


def _tell(line: dict[str, Any]) -> None:
    sys.stdout.buffer.write(json.dumps(line).encode() + b"\n")
    sys.stdout.buffer.flush()


def _bound(most_bytes: int) -> None:
    """A file that was made to be large runs into the limits of this process, where the system has such."""
    if sys.platform == "win32":
        return
    import resource

    with suppress(OSError, ValueError):
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        most = pages * resource.getpagesize() + most_bytes
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CPU, (_CPU_MOST_S, _CPU_MOST_S))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
