"""kill -9 at random moments of record, live and recover: every row that was acknowledged is there afterwards.

The killed process notes each row beside its recording, before and after it hands the row over. A kill cannot
undo these notes. The benchmark compares the rows that `recover` gives with them, one by one.

The brick of record and live is the mock in virtual time. A short session then has a hundred rows, and kills are spread
over its whole length, its end included. Kills come in pieces, and those of a seed add up over runs.
"""

from __future__ import annotations

import csv
import os
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Final

import numpy as np

from benchmarks import ledger
from benchmarks.ledger import Ledger
from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.record import write_down
from nxt_twin.errors import RecordingError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.stream import RecordingWriter, recover, stream_path
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.live import LiveOptions, live_sitting
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.rehearsal import rehearse
from nxt_twin.twin.settings import Pace
from nxt_twin.twin.sinks import Memory

_RECORD_S: Final = 1.0
_LIVE_S: Final = 0.2
"""Polled without a pause, so that it has as many rows."""
_PERIOD_S: Final = 0.01
_BEYOND: Final = 1.1
"""Kills come up to so many times a whole run after it began: some find it finished."""
_EARLY: Final = 0.1
_TIMED: Final = 5
_PIECE: Final = 50
_LOOK_S: Final = 0.001
_ROWS: Final = 4000
_COLUMN: Final = "a_tacho_deg"

Work = Callable[[Path], None]


def report(kills: int, seed: int, only: str = "") -> Iterator[str]:
    """What came of a number of kills of each, or of `only` one of them; those of earlier runs count."""
    plants = {"a": plant_from_config(load_plant_config("nxt_motor"), "power_pct")}
    rehearse(plants)
    works = {"record": _record, "live": lambda out: _live(out, plants)}
    for name in ("record", "live", "recover"):
        if only in ("", name):
            yield from _counted(name, kills, seed, works.get(name))


def _counted(name: str, kills: int, seed: int, work: Work | None) -> Iterator[str]:
    """Kill in pieces what is missing of a number of kills; recover where no work is given."""
    kept = Ledger(ledger.FOLDER / "kills.jsonl", f"seed {seed}, {name}")
    while (done := sum(piece["kills"] for piece in kept.pieces())) < kills:
        size, random = min(_PIECE, kills - done), Random(f"{seed} {name} {len(kept.pieces())}")
        seen = _sessions_killed(work, random, size) if work else _recoveries_killed(random, size)
        kept.add({"kills": size, "seen": seen})
        yield f"{name}, piece {len(kept.pieces())}: {_told(seen)}"
    together = sum((Counter(piece["seen"]) for piece in kept.pieces()), Counter[str]())
    yield f"kill -9 of {name}, {together.total()} times, seed {seed}: {_told(together)}; commits: {kept.commits()}"


def _sessions_killed(work: Work, random: Random, kills: int) -> Counter[str]:
    whole_s = _timed(work)
    return Counter(_session_killed(work, random, whole_s) for _ in range(kills))


def _recoveries_killed(random: Random, kills: int) -> Counter[str]:
    with tempfile.TemporaryDirectory() as folder:
        stream = _long_stream(Path(folder))
        whole_s = _timed(lambda out: _recover(stream, out))
        return Counter(_recover_killed(stream, random.uniform(0.0, _BEYOND * whole_s)) for _ in range(kills))


def _told(seen: Counter[str]) -> str:
    lost = sum(number for what, number in seen.items() if what.startswith("LOST"))
    return (
        "; ".join(f"{number} {what}" for what, number in seen.most_common())
        + f"; rows lost or wrong in {lost}"
    )


def _timed(work: Work) -> float:
    """How long it takes when nothing kills it and nothing else takes the processor; the quickest of a few."""
    with tempfile.TemporaryDirectory() as folder:
        work(Path(folder) / "run.csv")  # loads what it needs
    return min(_once(work) for _ in range(_TIMED))


def _once(work: Work) -> float:
    with tempfile.TemporaryDirectory() as folder:
        began_s = time.monotonic()
        os.waitpid(_begun(lambda: _noting(work, Path(folder) / "run.csv", Path(folder) / "notes")), 0)
        return time.monotonic() - began_s


def _session_killed(work: Work, random: Random, whole_s: float) -> str:
    """Kill it a while after its first row; one time in ten, before."""
    with tempfile.TemporaryDirectory() as folder:
        out, notes = Path(folder) / "run.csv", Path(folder) / "notes"
        awaited = None if random.random() < _EARLY else notes
        _killed(lambda: _noting(work, out, notes), random.uniform(0.0, _BEYOND * whole_s), awaited)
        lines = notes.read_text(encoding="ascii").splitlines() if notes.exists() else []
        begun = np.array([float(line[1:]) for line in lines if line.startswith("+")])
        sure = sum(line == "-" for line in lines)
        return _judged(out, begun, sure)


def _noting(work: Work, out: Path, notes: Path) -> None:
    handle = os.open(notes, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    row = RecordingWriter.row

    def noted(self: RecordingWriter, values: Mapping[str, float]) -> None:
        os.write(handle, f"+{values[_COLUMN]!r}\n".encode())
        row(self, values)
        os.write(handle, b"-\n")

    RecordingWriter.row = noted  # type: ignore[method-assign]
    work(out)


def _judged(out: Path, begun: np.ndarray, sure: int) -> str:
    """What is left, beside the notes."""
    finished = out.exists()
    try:
        if not finished:
            recover(out)
    except RecordingError as failure:
        return "before the first row" if not sure else f"LOST: {failure.what}"
    with out.open(
        encoding="utf-8", newline=""
    ) as file:  # as text: a recording of one row is refused by who reads it
        counts = np.array([float(row[_COLUMN]) for row in csv.DictReader(file)])
    if not sure <= counts.size <= begun.size or not np.array_equal(counts, begun[: counts.size]):
        return f"LOST: {counts.size} of {sure} rows"
    if not out.with_suffix(".yaml").exists():
        return "LOST: the sidecar"
    return "finished, all rows there" if finished else "cut off, all rows recovered"


def _record(out: Path) -> None:
    clock, plan = VirtualClock(), Plan(period_s=_PERIOD_S)
    driver = ProgramDriver(excitation(("a",)))
    write_down(lambda: open_brick("mock:", clock, OPENERS), clock, out, ("a",), plan, pace=Pace(), driver=driver,
               seconds=_RECORD_S)  # fmt: skip


def _live(out: Path, plants: Mapping[str, object]) -> None:
    clock = VirtualClock()
    options = LiveOptions(plants, program=excitation(("a",)), out=out)  # type: ignore[arg-type]
    sitting = live_sitting(replace(options), lambda: open_brick("mock:", clock, OPENERS), clock, Memory())
    try:
        sitting.run(_LIVE_S)
    finally:
        sitting.close()


def _long_stream(folder: Path) -> Path:
    path = folder / "long.csv"
    with RecordingWriter(path, ("time_s", _COLUMN)) as writer:
        for number in range(_ROWS):
            writer.row({"time_s": number / 100, _COLUMN: float(number)})
        kept = folder / "kept"
        kept.write_bytes(stream_path(path).read_bytes())
    return kept


def _recover(stream: Path, out: Path) -> None:
    stream_path(out).write_bytes(stream.read_bytes())
    recover(out)


def _recover_killed(stream: Path, after_s: float) -> str:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run.csv"
        stream_path(out).write_bytes(stream.read_bytes())
        _killed(lambda: recover(out), after_s)
        finished = out.exists()
        rows = (read_recording(out) if finished else recover(out).recording).columns[_COLUMN]
        if not np.array_equal(rows, np.arange(float(_ROWS))):
            return "LOST: rows"
        return "finished, all rows there" if finished else "cut off, all rows recovered again"


def _begun(work: Callable[[], object]) -> int:
    """Do it in a process of its own, whose number this is."""
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        try:
            work()
        finally:
            os._exit(0)
    return child


def _killed(work: Callable[[], object], after_s: float, awaited: Path | None = None) -> None:
    """Begin it, and kill it so long after a file has grown, wherever it is."""
    child = _begun(work)
    while awaited is not None and not (awaited.exists() and awaited.stat().st_size):
        time.sleep(_LOOK_S)
    time.sleep(after_s)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
