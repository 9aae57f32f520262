"""Kept machine code follows the modules whose functions it holds."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

_OUTER = """import inner
from numba import njit
from nxt_twin.machine_code import forget_outdated


@njit(cache=True)
def outer():
    return inner.value()


{guard}
print(outer())
"""
_INNER = "from numba import njit\n\n\n@njit(cache=True)\ndef value():\n    return {value}\n"


def _printed(folder: Path) -> str:
    paths = os.pathsep.join([str(folder), *sys.path])
    command = [sys.executable, "-c", "import outer"]
    done = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


@pytest.mark.parametrize(("guard", "after"), [("forget_outdated(outer, inner)", "2"), ("", "1")])
def test_a_change_of_a_called_module_is_compiled_anew(tmp_path, guard, after):
    (tmp_path / "outer.py").write_text(_OUTER.format(guard=guard), encoding="utf-8")
    inner = tmp_path / "inner.py"
    inner.write_text(_INNER.format(value=1), encoding="utf-8")
    assert _printed(tmp_path) == "1"
    inner.write_text(_INNER.format(value=2), encoding="utf-8")
    later = time.time() + 10.0
    os.utime(inner, (later, later))
    assert _printed(tmp_path) == after
