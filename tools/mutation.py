"""Change one thing at a time in the files that matter most, and see whether a test notices; print the score.

    python tools/mutation.py [--sample N] [--seed S] [--only WORD]

Cosmic Ray's operators make the changes: another number, another comparison, `and` for `or`, a loop that never runs.
Its own driver works in place on the checkout and cannot sample, so it is not used. Here each change is made
in a copy, and only the tests of its file run. They run in a fork of this process, which has imported what
others made. Changes that alter no behaviour (annotations, decorators) are left out where they can be told;
survivors are printed, to be looked at.
"""

from __future__ import annotations

import argparse
import difflib
import importlib
import math
import multiprocessing
import os
import random
import resource
import shutil
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import pytest
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

ROOT: Final = Path(__file__).resolve().parents[1]
AIM: Final = 0.9

TARGETS: Final[Mapping[str, tuple[str, ...]]] = {
    "nxt_twin/brick/exchange.py": ("tests/brick/test_brick_exchange.py",),
    "nxt_twin/twin/logbook.py": ("tests/twin/test_twin_logbook.py",),
    "nxt_twin/recording/checks.py": ("tests/recording/test_recording_csv.py", "tests/api/test_api_public.py"),
    "nxt_twin/recording/stream.py": ("tests/recording/test_recording_stream.py",),
    "firmware_protocol/framing.py": ("tests/firmware_protocol/test_firmware_protocol_framing.py",),
    "firmware_protocol/wire.py": (
        "tests/firmware_protocol/test_firmware_protocol_wire.py",
        "tests/firmware_protocol/test_firmware_protocol_golden.py",
        "tests/firmware_protocol/test_firmware_protocol_buffer.py",
        "tests/firmware_protocol/test_firmware_protocol_roundtrip.py",
    ),
    "nxt_twin/diagnose/judging/verdict.py": ("tests/diagnose/test_diagnose_verdict.py",),
    "nxt_twin/diagnose/search/weight.py": ("tests/diagnose/test_diagnose_weight.py",),
    "nxt_twin/physics/observer.py": ("tests/physics/test_physics_observer.py",),
    "nxt_twin/physics/stepper.py": (
        "tests/physics/test_physics_kernel.py",
        "tests/physics/test_physics_stamps.py",
    ),
}
"""Motors that stop, recordings, protocol, verdict and kernel: each file, and the tests that are to notice."""

_COPIED: Final = ("nxt_twin", "firmware_protocol", "configs", "tests", "docs", "pyproject.toml")
_NO_BEHAVIOUR: Final = ("RemoveDecorator", "BitOr", "BitAnd", "BitXor", "RShift", "LShift")
_IMPORTED: Final = [
    "hypothesis",
    "numba",
    "numpy",
    "pandas",
    "polars",
    "pyarrow.parquet",
    "scipy.linalg",
    "yaml",
]
_TIMEOUT_S: Final = 600.0
_SLOWER: Final = 3.0
_SPARE_S: Final = 5.0
"""A change may make tests slower by this factor and this time; then a loop never ends, and the change is noticed."""


@final
@dataclass(frozen=True)
class Mutation:
    """One change: which operator, and to which of the places that it knows in the file."""

    operator: str
    occurrence: int


def main() -> int:
    """Print one line a mutation and the score; 1 if it is below the aim."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    words.add_argument("--sample", type=int, default=6, help="mutations a file")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--only", default="", help="only files whose path holds this")
    chosen = words.parse_args()
    killed = total = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = _copied(Path(folder))
        _prepare(copy)
        for file, tests in TARGETS.items():
            if chosen.only not in file:
                continue
            noticed, made = _score(copy, file, tests, chosen.sample, random.Random(f"{chosen.seed} {file}"))
            print(f"{noticed:3} of {made:3}  {file}", flush=True)
            killed, total = killed + noticed, total + made
    share = killed / total if total else 0.0
    print(f"score: {killed} of {total} noticed, {100 * share:.0f} % (aim: {100 * AIM:.0f} %)")
    return 0 if share >= AIM else 1


def _copied(folder: Path) -> Path:
    for name in _COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, folder / name)
    return folder


def _score(
    copy: Path, file: str, tests: tuple[str, ...], sample: int, chance: random.Random
) -> tuple[int, int]:
    code = (ROOT / file).read_text(encoding="utf-8")
    begun_s = _spent_s()
    if not _passes(copy, tests):
        sys.exit(f"{file}: its tests fail without any change")
    most_s = _SPARE_S + _SLOWER * (_spent_s() - begun_s)
    noticed = made = 0
    for mutation in _sampled(code, sample, chance):
        changed = mutate_code(code, get_operator(mutation.operator)(), mutation.occurrence)
        if changed is None or changed == code:
            continue
        (copy / file).write_text(changed, encoding="utf-8")
        survived = _passes(copy, tests, most_s)
        made += 1
        noticed += not survived
        if survived:
            print(f"survived: {file}", *_difference(code, changed), sep="\n    ", flush=True)
    (copy / file).write_text(code, encoding="utf-8")
    return noticed, made


def _sampled(code: str, count: int, chance: random.Random) -> list[Mutation]:
    """Mutations at a number of places of the file, any of those that are possible there."""
    places: dict[object, list[Mutation]] = defaultdict(list)
    for place, mutation in _possible(code):
        places[place].append(mutation)
    drawn = chance.sample(sorted(places, key=str), min(count, len(places)))
    return [chance.choice(places[place]) for place in drawn]


def _possible(code: str) -> Iterator[tuple[object, Mutation]]:
    nodes: list[Any] = list(ast_nodes(get_ast(code)))
    for name in operator_names():
        if any(word in name for word in _NO_BEHAVIOUR):
            continue
        try:
            operator = get_operator(name)()
        except TypeError:  # one that wants to be told what to replace
            continue
        places = [place for node in nodes for place in operator.mutation_positions(node)]
        yield from ((place, Mutation(name, number)) for number, place in enumerate(places))


def _spent_s() -> float:
    """Processor time of the forks that have ended."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def _passes(copy: Path, tests: tuple[str, ...], most_s: float = _TIMEOUT_S) -> bool:
    """Whether the tests pass within a limit of processor time."""
    child = multiprocessing.get_context("fork").Process(target=_run, args=(copy, tests, most_s))
    child.start()
    child.join(_TIMEOUT_S)
    if child.is_alive():
        child.kill()
        child.join()
    return child.exitcode == 0


def _run(copy: Path, tests: tuple[str, ...], most_s: float) -> None:
    """Run the tests on the copy, in silence, and leave with pytest's exit status."""
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(most_s),) * 2)
    os.chdir(copy)
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    sys.path.insert(0, str(copy))
    quietly = ["-q", "-x", "-n0", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"]
    sys.exit(pytest.main([*quietly, *tests]))


def _prepare(copy: Path) -> None:
    """Import what others made, which no mutation changes; compiled code is kept beside the copy."""
    os.environ["NUMBA_CACHE_DIR"] = str(copy / ".numba")
    os.environ["OMP_NUM_THREADS"] = "1"
    sys.dont_write_bytecode = True
    for name in _IMPORTED:
        importlib.import_module(name)


def _difference(before: str, after: str) -> list[str]:
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
    return [line for line in lines if line[:1] in "+-" and line[:3] not in ("+++", "---")]


if __name__ == "__main__":
    sys.exit(main())
