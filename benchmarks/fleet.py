"""How the time of a fleet grows with its sessions and shrinks with its workers, and what memory it takes.

python -m benchmarks fleet
python -m benchmarks.fleet [--sessions N,N,…] [--workers N,N,…]

A session is a motor's recording of 4 s at 50 Hz in which a constant load is missing, or not. Without options it takes
about ten minutes on two idle cores. The rate is that of the middle: neither the start of the workers counts, nor the
end, when some have nothing left to do.

Other programs lengthen the time by the clock. The efficiency therefore rests on what Linux counts for each process: its
processor time, and the time in which it wanted a core.
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
from multiprocessing import active_children
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from nxt_twin.api.files import load_plant
from nxt_twin.api.prediction import simulate
from nxt_twin.fleet.parcel import Options
from nxt_twin.fleet.run import diagnose_fleet
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.workers.place import Processes
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording

SESSIONS: Final = (10, 100, 1000)
"""The usual counts of motors: all three take a quarter of an hour of processor time."""
WORKERS: Final = (1, 2, 4)
COMPARED: Final = 32
"""Sessions by which numbers of workers are compared."""
_RUSAGE_MB: Final = 1024.0
_GROWTH: Final = (
    "sessions", "time, s", "processor s/session", "planner, MB", "worker, MB", "again, ms/session", "row, bytes"
)  # fmt: skip
_EFFICIENCY: Final = (
    "workers", "time, s", "efficiency by clock", "processor s/session", "cores wanted, %", "efficiency by processor"
)  # fmt: skip


class Measured(NamedTuple):
    """Time and memory of a fleet.

    Attributes:
        wall_s: by the clock, for the sessions that count.
        cpu_s: processor time of planner and workers for each session that counts.
        wanted: share of that time in which a worker wanted a core, the mean of all; the rest it waited for a task.
        whole_s: processor time of all workers for each session, their start included.
        planner_mb: the most memory of the program that plans.
        worker_mb: the most memory of a worker.
        kept_ms: what a second run, which finds all done, takes for each session.
        row_bytes: of the table, for each row.
    """

    wall_s: float
    cpu_s: float
    wanted: float
    whole_s: float
    planner_mb: float
    worker_mb: float
    kept_ms: float
    row_bytes: float


def report() -> Iterator[str]:
    """Lines of both tables."""
    yield f"{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}"
    yield from growth(SESSIONS)
    yield from efficiency(WORKERS, COMPARED)


def growth(counts: tuple[int, ...]) -> Iterator[str]:
    """Time and memory of fleets of these sizes, on as many workers as there are cores."""
    workers = os.cpu_count() or 1
    if counts:
        yield f"growth, with {workers} workers:"
        yield "  ".join(_GROWTH)
    for count in counts:
        one = _measured(count, workers)
        yield _row(
            _GROWTH,
            (
                *(f"{count}", f"{one.wall_s:.1f}", f"{one.whole_s:.2f}", f"{one.planner_mb:.0f}"),
                *(f"{one.worker_mb:.0f}", f"{one.kept_ms:.1f}", f"{one.row_bytes:.0f}"),
            ),
        )


def efficiency(workers: tuple[int, ...], count: int) -> Iterator[str]:
    """Sessions a second on these many workers, beside one worker times the cores that can work.

    Without other programs the rate is cores times the share of them that is wanted, over the processor time a session.
    """
    cores = os.cpu_count() or 1
    alone: Measured | None = None
    if workers:
        yield f"efficiency, of {count} sessions on {cores} cores:"
        yield "  ".join(_EFFICIENCY)
    for number in workers:
        one = _measured(count, number)
        alone = alone or one
        by_clock = alone.wall_s / (one.wall_s * min(number, cores) / min(workers[0], cores))
        wanted = min(1.0, one.wanted * number / min(number, cores))
        yield _row(
            _EFFICIENCY,
            (
                *(f"{number}", f"{one.wall_s:.1f}", f"{by_clock:.2f}", f"{one.cpu_s:.2f}"),
                *(f"{100.0 * wanted:.0f}", f"{wanted * alone.cpu_s / one.cpu_s:.2f}"),
            ),
        )


def _row(heads: tuple[str, ...], cells: tuple[str, ...]) -> str:
    return "  ".join(f"{cell:>{len(head)}}" for head, cell in zip(heads, cells, strict=True))


def _measured(count: int, workers: int) -> Measured:
    """A fleet in a program of its own, of which the system tells memory and time."""
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count + 2 * workers):
            write_motor(Path(folder, "units", f"U{number // 10:05}", f"2026-01-{number % 10 + 1:02}"), number)
        program = [sys.executable, "-m", "benchmarks.fleet", "--run", folder, "--workers", str(workers)]
        told = subprocess.run(program, capture_output=True, check=True, text=True).stdout
        return Measured(*map(float, told.split()))


class _Moment(NamedTuple):
    """What has passed when a session ends: by the clock, of processor time, and of wanting a core, s."""

    clock_s: float
    cpu_s: float
    wanted_s: float


def _now() -> _Moment:
    """Of this program and its workers; Linux keeps time on a core and time in wait for one, in nanoseconds."""
    workers = [_spent_ns(process.pid) for process in active_children()]
    spent, waited = sum(one[0] for one in workers), sum(one[1] for one in workers)
    return _Moment(time.monotonic(), time.process_time() + 1e-9 * spent, 1e-9 * (spent + waited))


def _spent_ns(process: int | None) -> tuple[int, int]:
    ran, waited, _ = Path(f"/proc/{process}/schedstat").read_text(encoding="ascii").split()
    return int(ran), int(waited)


def _run(folder: Path, workers: int) -> Measured:
    """Diagnose the fleet in `folder`; the first and the last session of each worker do not count."""
    ended: list[_Moment] = []
    path, places = folder / "fleet.parquet", [str(folder / "units")]
    with FleetTable(path) as table:
        diagnose_fleet(places, table, Options(), Processes(workers), lambda _: ended.append(_now()))
    again_s = time.monotonic()
    with FleetTable(path) as table:
        diagnose_fleet(places, table, Options(), Processes(workers))
    again_s = time.monotonic() - again_s
    mine, theirs = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    first, last = ended[workers - 1], ended[-1 - workers]
    wall_s = last.clock_s - first.clock_s
    return Measured(
        wall_s=wall_s,
        cpu_s=(last.cpu_s - first.cpu_s) / (len(ended) - 2 * workers),
        wanted=(last.wanted_s - first.wanted_s) / (workers * wall_s),
        whole_s=(theirs.ru_utime + theirs.ru_stime) / len(ended),
        planner_mb=mine.ru_maxrss / _RUSAGE_MB,
        worker_mb=theirs.ru_maxrss / _RUSAGE_MB,
        kept_ms=1000.0 * again_s / len(ended),
        row_bytes=path.stat().st_size / len(ended),
    )


def write_motor(place: Path, number: int) -> None:
    """A session of a motor; each second one carries a load that the baseline lacks."""
    motor = load_plant("nxt_motor")
    loaded = motor.adding("constant_load", load_torque_nm=0.05)
    draw = np.random.default_rng(number)
    time_s = np.arange(0.0, 4.0, 0.02)
    power = np.repeat(draw.integers(-80, 80, 20).astype(float), 20)[: time_s.size]
    run = simulate(
        loaded if number % 2 else motor, Recording("run.csv", {"time_s": time_s, "a_power_pct": power})
    )
    place.mkdir(parents=True)
    columns = {**run.columns, "a_tacho_deg": np.floor(run.columns["a_tacho_deg"])}
    write_recording(Recording("run.csv", columns), place / "run.csv")


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
