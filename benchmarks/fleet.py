"""How the time of a fleet grows with its sessions and shrinks with its workers, and what memory it takes.

python -m benchmarks fleet
python -m benchmarks.fleet [--sessions N,N,…] [--switches N,N,…] [--workers N,N,…]

A session is a motor's recording of 4 s at 50 Hz in which a constant load is missing, or not. Or it is one of a touch
sensor, whose diagnosis is twenty times shorter, so that large fleets are soon done. The rate is that of the middle:
neither the start of the workers counts, nor the end, when some have nothing left to do.

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
from collections.abc import Callable, Iterator
from itertools import chain
from multiprocessing import active_children
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from nxt_twin.api.files import load_plant
from nxt_twin.api.prediction import simulate
from nxt_twin.arrays import FloatArray
from nxt_twin.fleet.parcel import Options
from nxt_twin.fleet.run import diagnose_fleet
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.workers.place import Processes
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording

SESSIONS: Final = (10, 100)
"""The usual counts of motors: 1000 take a quarter of an hour of processor time."""
SWITCHES: Final = (10, 100, 1000)
"""The usual counts of touch sensors."""
WORKERS: Final = (1, 2, 4)
COMPARED: Final = 16
"""Sessions by which numbers of workers are compared."""
_RUSAGE_MB: Final = 1024.0
Writer = Callable[[Path, int], None]
"""Writes a session into a folder, by its number."""


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
    """Lines of all tables."""
    yield from growth(SESSIONS, write_motor)
    yield from growth(SWITCHES, write_switch)
    yield from efficiency(WORKERS, COMPARED)


def growth(counts: tuple[int, ...], write: Writer) -> Iterator[str]:
    """Time and memory of fleets of these sizes, on as many workers as there are cores."""
    workers = os.cpu_count() or 1
    if counts:
        yield f"{workers} workers, {write.__name__.removeprefix('write_')} recordings"
    for count in counts:
        one = _measured(count, workers, write)
        yield (
            f"{count:5d} sessions: {one.wall_s:7.1f} s, {one.whole_s:5.2f} s of processor time a session, "
            f"planner {one.planner_mb:.0f} MB, largest worker {one.worker_mb:.0f} MB, "
            f"run again {one.kept_ms:.1f} ms a session, table {one.row_bytes:.0f} bytes a session"
        )


def efficiency(workers: tuple[int, ...], count: int) -> Iterator[str]:
    """Sessions a second on these many workers, beside one worker times the cores that can work.

    Without other programs the rate is cores times the share of them that is wanted, over the processor time a session.
    """
    cores = os.cpu_count() or 1
    alone: Measured | None = None
    for number in workers:
        one = _measured(count, number, write_motor)
        alone = alone or one
        by_clock = alone.wall_s / (one.wall_s * min(number, cores))
        wanted = min(1.0, one.wanted * number / min(number, cores))
        yield (
            f"{number} workers on {cores} cores: {one.cpu_s:.2f} s of processor time a session, a core wanted "
            f"{100.0 * wanted:.0f} % of the time: efficiency {wanted * alone.cpu_s / one.cpu_s:.2f} "
            f"({by_clock:.2f} by the clock: {count} sessions in {one.wall_s:.1f} s)"
        )


def _measured(count: int, workers: int, write: Writer) -> Measured:
    """A fleet in a program of its own, of which the system tells memory and time."""
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count + 2 * workers):
            write(Path(folder, "units", f"U{number // 10:05}", f"2026-01-{number % 10 + 1:02}"), number)
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
    _write(place, {**run.columns, "a_tacho_deg": np.floor(run.columns["a_tacho_deg"])})


def write_switch(place: Path, number: int) -> None:
    """A session of a touch sensor that switches at a force of its own."""
    time_s = np.arange(0.0, 3.0, 0.05)
    force_g = 300.0 * np.sin(time_s) ** 2
    limit_g = np.random.default_rng(number).uniform(100.0, 200.0)
    touched = (force_g > limit_g).astype(float)
    _write(place, {"time_s": time_s, "rig_force_g": force_g, "s1_touch": touched})
    (place / "run.yaml").write_text("plant: {kind: touch_sensor}\n", encoding="utf-8")


def _write(place: Path, columns: dict[str, FloatArray]) -> None:
    place.mkdir(parents=True)
    write_recording(Recording("run.csv", columns), place / "run.csv")


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(",") if part)


def main() -> None:
    """The tables that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--sessions", type=_numbers, default=SESSIONS)
    parser.add_argument("--switches", type=_numbers, default=SWITCHES)
    parser.add_argument("--workers", type=_numbers, default=WORKERS)
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.run:
        print(*_run(chosen.run, chosen.workers[0]))
        return
    print(f"{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}")
    grown = chain(growth(chosen.sessions, write_motor), growth(chosen.switches, write_switch))
    for line in chain(grown, efficiency(chosen.workers, COMPARED)):
        print(line, flush=True)


if __name__ == "__main__":
    main()
