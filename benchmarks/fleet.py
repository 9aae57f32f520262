"""How the time of a fleet grows with its sessions and shrinks with its workers, and what memory it takes.

python -m benchmarks fleet
python -m benchmarks.fleet [--sessions N,N,…] [--workers N,N,…]

A session is a motor's recording of 4 s at 50 Hz in which a constant load is missing, or not. The rate is that of the
middle: neither the start of the workers counts, nor the end, when some have nothing left to do.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from nxt_twin.api.files import load_plant
from nxt_twin.api.prediction import simulate
from nxt_twin.fleet.parcel import Options
from nxt_twin.fleet.run import FleetTally, diagnose_fleet
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.workers.place import Processes
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording

SESSIONS: Final = (10, 100)
"""The usual counts: 1000 take a quarter of an hour."""
WORKERS: Final = (1, 2, 4)
COMPARED: Final = 24
"""Sessions by which numbers of workers are compared."""
_RUSAGE_MB: Final = 1024.0


class Measured(NamedTuple):
    """Time and memory of a fleet.

    Attributes:
        wall_s: by the clock, for the sessions that count.
        cpu_s: processor time of all workers for each session, their start included.
        planner_mb: the most memory of the program that plans.
        worker_mb: the most memory of a worker.
        kept_ms: what a second run, which finds all done, takes for each session.
        row_bytes: of the table, for each row.
    """

    wall_s: float
    cpu_s: float
    planner_mb: float
    worker_mb: float
    kept_ms: float
    row_bytes: float


def report() -> Iterator[str]:
    """Lines of all tables."""
    yield from growth(SESSIONS)
    yield from efficiency(WORKERS, COMPARED)


def growth(counts: tuple[int, ...]) -> Iterator[str]:
    """Time and memory of fleets of these sizes, on as many workers as there are cores."""
    workers = os.cpu_count() or 1
    yield f"{workers} workers"
    for count in counts:
        one = _measured(count, workers)
        yield (
            f"{count:5d} sessions: {one.wall_s:7.1f} s, {one.cpu_s:5.2f} s of processor time a session, "
            f"planner {one.planner_mb:.0f} MB, largest worker {one.worker_mb:.0f} MB, "
            f"run again {one.kept_ms:.1f} ms a session, table {one.row_bytes:.0f} bytes a session"
        )


def efficiency(workers: tuple[int, ...], count: int) -> Iterator[str]:
    """Sessions a second on these many workers, beside one worker times the cores that can work."""
    cores = os.cpu_count() or 1
    alone_s = 0.0
    for number in workers:
        one = _measured(count, number)
        alone_s = alone_s or one.wall_s * number
        share = alone_s / (one.wall_s * min(number, cores))
        yield (
            f"{number} workers on {cores} cores: {count} sessions in {one.wall_s:.1f} s, efficiency {share:.2f}, "
            f"{one.cpu_s:.2f} s of processor time a session"
        )


def _measured(count: int, workers: int) -> Measured:
    """A fleet in a program of its own, of which the system tells memory and time."""
    with tempfile.TemporaryDirectory() as folder:
        _write_fleet(Path(folder), count + 2 * workers)
        program = [sys.executable, "-m", "benchmarks.fleet", "--run", folder, "--workers", str(workers)]
        told = subprocess.run(program, capture_output=True, check=True, text=True).stdout
        return Measured(*map(float, told.split()))


def _run(folder: Path, workers: int) -> Measured:
    """Diagnose the fleet in `folder`; the first and the last session of each worker do not count."""
    ended_s: list[float] = []

    def tell(_tally: FleetTally) -> None:
        ended_s.append(time.monotonic())

    path, places = folder / "fleet.parquet", [str(folder / "units")]
    with FleetTable(path) as table:
        diagnose_fleet(places, table, Options(), Processes(workers), tell)
    again_s = time.monotonic()
    with FleetTable(path) as table:
        diagnose_fleet(places, table, Options(), Processes(workers))
    again_s = time.monotonic() - again_s
    mine, theirs = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return Measured(
        wall_s=ended_s[-1 - workers] - ended_s[workers - 1],
        cpu_s=(theirs.ru_utime + theirs.ru_stime) / len(ended_s),
        planner_mb=mine.ru_maxrss / _RUSAGE_MB,
        worker_mb=theirs.ru_maxrss / _RUSAGE_MB,
        kept_ms=1000.0 * again_s / len(ended_s),
        row_bytes=path.stat().st_size / len(ended_s),
    )


def _write_fleet(folder: Path, count: int) -> None:
    motor = load_plant("nxt_motor")
    loaded = motor.adding("constant_load", load_torque_nm=0.05)
    for number in range(count):
        draw = np.random.default_rng(number)
        time_s = np.arange(0.0, 4.0, 0.02)
        power = np.repeat(draw.integers(-80, 80, 20), 20)[: time_s.size]
        columns = {"time_s": time_s, "a_power_pct": power}
        run = simulate(loaded if number % 2 else motor, Recording("run.csv", columns))
        counts = np.floor(run.columns["a_tacho_deg"])
        place = folder / "units" / f"U{number // 10:05}" / f"2026-01-{number % 10 + 1:02}"
        place.mkdir(parents=True)
        write_recording(Recording("run.csv", {**run.columns, "a_tacho_deg": counts}), place / "run.csv")


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(",") if part)


def main() -> None:
    """The tables that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--sessions", type=_numbers, default=SESSIONS)
    parser.add_argument("--workers", type=_numbers, default=WORKERS)
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.run:
        print(*_run(chosen.run, chosen.workers[0]))
        return
    print(f"{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}")
    for line in chain(growth(chosen.sessions), efficiency(chosen.workers, COMPARED)):
        print(line, flush=True)


if __name__ == "__main__":
    main()
