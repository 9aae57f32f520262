"""The compiled kernel of a layout: written once into a cache folder, compiled by numba, kept between runs."""

from __future__ import annotations

import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import final

import platformdirs

from nxt_twin.physics.assemble import fingerprint, source, source_outline, turning_source
from nxt_twin.physics.late_blas import import_without_blas
from nxt_twin.physics.layout import Layout

CACHE_VARIABLE = "NXT_TWIN_CACHE"


@final
class Kernel:
    """The compiled entry points of a layout; they release the interpreter lock while they run."""

    def __init__(self, module: ModuleType) -> None:
        self.run_many: Callable[..., None] = module.run_many
        self.run_together: Callable[..., None] = module.run_together
        self.step_many: Callable[..., None] = module.step_many
        self.read_many: Callable[..., None] = module.read_many


@cache
def kernel(plan: Layout) -> Kernel:
    """The kernel of `plan`, compiled at its first call and found again in the cache by later processes.

    The folder is `$NXT_TWIN_CACHE`, else the user's cache folder; where neither can be written, a temporary one.
    """
    return Kernel(_compiled(plan, plan.base.kind, source_outline(plan), source))


@cache
def turning(plan: Layout) -> Callable[..., None]:
    """The compiled drive of joints by plants of `plan`, kept as a `kernel` is."""
    kind = f"{plan.base.kind}_joint"
    drive: Callable[..., None] = _compiled(plan, kind, turning_source(plan), turning_source).turn_many
    return drive


def is_compiled(plan: Layout) -> bool:
    """Whether an earlier process compiled the kernel of `plan` on this machine and the cache still has it."""
    name = _name(plan, plan.base.kind, source_outline(plan))
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    return any((Path(elsewhere) if elsewhere else _folder()).rglob(f"{name}.*.nbi"))


def _name(plan: Layout, kind: str, text: str) -> str:
    return f"{kind}_{plan.frame}_{fingerprint(plan, text)}"


def _compiled(plan: Layout, kind: str, told: str, write: Callable[[Layout], str]) -> ModuleType:
    """The module of what `write` writes for `plan`; `told` is a text that differs where that differs."""
    import_without_blas()
    name = _name(plan, kind, told)
    path = _folder() / f"{name}.py"
    if not path.exists():
        _write_whole(path, write(plan))
    spec = importlib.util.spec_from_file_location(f"nxt_twin_kernel_{name}", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"no loader for {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # numba finds a cached function's module by its name
    spec.loader.exec_module(module)
    return module


def _folder() -> Path:
    given = os.environ.get(CACHE_VARIABLE)
    wanted = Path(given) if given else Path(platformdirs.user_cache_dir("nxt-twin"))
    try:
        wanted.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=wanted):
            return wanted
    except OSError:
        return Path(tempfile.mkdtemp(prefix="nxt-twin-"))


def _write_whole(path: Path, text: str) -> None:
    """Write so that another process finds either no file or the whole one."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".py.part")
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(text)
    Path(temporary).replace(path)
