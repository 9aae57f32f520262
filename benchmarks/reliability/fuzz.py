"""A million hostile inputs: each is read, or refused in one line, in bounded time and memory.

    python -m benchmarks.reliability fuzz [--count N] [--seed N] [--only PART-OF-A-NAME]

The inputs come in pieces. A run that was ended goes on after its last piece; the table adds up the pieces of a seed.
What breaks a rule is kept in build/fuzz, named by parser, piece and number.
"""

from __future__ import annotations

import os
import resource
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from random import Random
from typing import Final, final

from benchmarks import ledger
from benchmarks.ledger import Ledger
from benchmarks.reliability.mutate import mutated
from benchmarks.reliability.parsers import REFUSALS, Parser, parsers
from nxt_twin.errors import LONGEST_LINE, NxtTwinError

MILLION: Final = 1_000_000
PIECE: Final = 50_000
LONGEST_S: Final = 2.0
MOST_MB: Final = 300.0
KEPT: Final = Path("build") / "fuzz"
_HANGS_AFTER_S: Final = 30
_KB: Final = 1024.0


@final
@dataclass
class Tally:
    """What came of one parser's inputs."""

    read: int = 0
    refused: int = 0
    longest_s: float = 0.0
    most_mb: float = 0.0
    longest_line: int = 0
    used_s: float = 0.0
    broken: list[str] = field(default_factory=list)

    @property
    def count(self) -> int:
        return self.read + self.refused + len(self.broken)

    def plus(self, other: Tally) -> Tally:
        """Both together."""
        return Tally(
            self.read + other.read,
            self.refused + other.refused,
            max(self.longest_s, other.longest_s),
            max(self.most_mb, other.most_mb),
            max(self.longest_line, other.longest_line),
            self.used_s + other.used_s,
            self.broken + other.broken,
        )


def fuzz(count: int, seed: int | str, only: str = "") -> Iterator[tuple[Parser, Tally]]:
    """Put a number of inputs to the parsers, by their shares."""
    for parser in parsers():
        if only.lower() in parser.name.lower():
            yield parser, _fuzz_one(parser, max(1, round(count * parser.share)), seed)


def _fuzz_one(parser: Parser, count: int, seed: int | str) -> Tally:
    tally, random, began_s = Tally(), Random(f"{seed} {parser.name}"), _used_s()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for example in parser.seeds:
            with suppress(NxtTwinError, *REFUSALS):
                parser.read(folder, example)  # what is loaded once is no input's cost
        for number in range(count):
            data = mutated(random.choice(parser.seeds), parser.seeds, random)
            why = _put(parser, folder, data, tally)
            if why:
                tally.broken.append(f"{number}: {why}")
                _keep(f"{parser.name}-{seed}-{number}", data)
    tally.used_s = _used_s() - began_s
    return tally


def _put(parser: Parser, folder: Path, data: bytes, tally: Tally) -> str:
    """Let one input be read; what rule it breaks, or nothing."""
    before_mb, began_s = _resident_mb(), _used_s()
    why = ""
    try:
        with _patience():
            parser.read(folder, data)
        tally.read += 1
    except (NxtTwinError, *REFUSALS) as refusal:
        line = str(refusal)
        tally.refused += 1
        tally.longest_line = max(tally.longest_line, len(line))
        if "\n" in line or (isinstance(refusal, NxtTwinError) and len(line) > LONGEST_LINE):
            tally.refused -= 1
            why = f"an error of {len(line)} characters"
    except Exception as failure:  # what nobody documented is what is looked for
        why = f"{type(failure).__name__}: {str(failure)[:100]}"
    took_s, took_mb = _used_s() - began_s, _peak_mb() - before_mb
    tally.longest_s, tally.most_mb = max(tally.longest_s, took_s), max(tally.most_mb, took_mb)
    if not why and (took_s > LONGEST_S or took_mb > MOST_MB):
        why = f"took {took_s:.1f} s and {took_mb:.0f} MB"
    return why


@contextmanager
def _patience() -> Iterator[None]:
    """Whatever hangs is ended."""

    def give_up(*_: object) -> None:
        raise TimeoutError(f"hung for {_HANGS_AFTER_S} s")

    signal.signal(signal.SIGALRM, give_up)
    signal.alarm(_HANGS_AFTER_S)
    try:
        yield
    finally:
        signal.alarm(0)


def _used_s() -> float:
    """Of the processor, by this process and those that it started: the wall clock belongs to others as well."""
    mine, theirs = time.process_time(), resource.getrusage(resource.RUSAGE_CHILDREN)
    return mine + theirs.ru_utime + theirs.ru_stime


def _resident_mb() -> float:
    """Memory that is held now; the peak begins anew."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    return _status_mb("VmRSS")


def _peak_mb() -> float:
    return _status_mb("VmHWM")


def _status_mb(key: str) -> float:
    handle = os.open("/proc/self/status", os.O_RDONLY)
    try:
        text = os.read(handle, 4096).decode()
    finally:
        os.close(handle)
    return float(text.split(f"{key}:")[1].split()[0]) / _KB


def _keep(name: str, data: bytes) -> None:
    KEPT.mkdir(parents=True, exist_ok=True)
    (KEPT / name.replace(" ", "_").replace(",", "")).write_bytes(data)


def main(count: int, seed: int, only: str) -> int:
    """Put what is missing of a number of inputs, then print a line for each parser; 1 if a rule was broken."""
    kept = Ledger(ledger.FOLDER / "fuzz.jsonl", f"seed {seed}, {only or 'all'}")
    while (done := sum(piece["inputs"] for piece in kept.pieces())) < count:
        number = len(kept.pieces())
        size = min(PIECE, count - done)
        found = {parser.name: tally for parser, tally in fuzz(size, f"{seed}.{number}", only)}
        kept.add({"inputs": size, "parsers": {name: asdict(tally) for name, tally in found.items()}})
        broken = sum(len(each.broken) for each in found.values())
        print(f"piece {number}: {size} inputs, {broken} broke a rule", flush=True)
    tallies = _together(kept)
    print(*_table(tallies), sep="\n")
    used_s = sum(each.used_s for each in tallies.values())
    broken = sum(len(each.broken) for each in tallies.values())
    print(
        f"{sum(each.count for each in tallies.values())} inputs in {len(kept.pieces())} pieces, {broken} broke a rule; "
        f"{used_s:.0f} s of processor time, seed {seed}; commits: {kept.commits()}"
    )
    return min(broken, 1)


def _together(kept: Ledger) -> dict[str, Tally]:
    sums: dict[str, Tally] = {}
    for piece in kept.pieces():
        for name, tally in piece["parsers"].items():
            sums[name] = sums.get(name, Tally()).plus(Tally(**tally))
    return sums


def _table(tallies: dict[str, Tally]) -> Iterator[str]:
    yield (
        f"{'parser':24} {'inputs':>8} {'read':>8} {'refused':>8} {'most s':>7} {'most MB':>8} {'line':>5} {'all s':>6} "
        f"{'broken':>7}"
    )
    for name, tally in tallies.items():
        yield (
            f"{name:24} {tally.count:8} {tally.read:8} {tally.refused:8} {tally.longest_s:7.2f} "
            f"{tally.most_mb:8.1f} {tally.longest_line:5} {tally.used_s:6.0f} {len(tally.broken):7}"
        )
        yield from (f"    {line}" for line in tally.broken[:5])
