"""The live twin: real-time factor, cost of a poll from prediction to record beside the link's period, an hour's memory.

Times are the processor's, so that what else runs on the machine does not count.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from benchmarks.steps import motor
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.recording.columns import PORTS, TIME, Port, mode_column, power_column, tacho_column
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.logbook import columns_to_fill
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Event, Tick
from nxt_twin.twin.sensor_twin import PortSensor
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES

FREE_RUN_S = 60.0
CYCLES = 600
SOAK_S = 3600.0
SOAK_CHECKS = 6
ONE_ROUND_TRIP_S = {"usb": 0.0025, "bluetooth": 0.045}
"""Of the mock's link profiles, in the middle of what they draw."""
_COLUMNS: Final = columns_to_fill(PORTS, {})


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    for name, candidates in (
        ("alone", ()),
        (f"with {len(DEFAULT_CANDIDATES)} effects weighed", DEFAULT_CANDIDATES),
    ):
        yield f"three motors {name}, 1 kHz physics: {_real_time_factor(candidates):.0f} times real time, no readings"
        for link, trip_s in ONE_ROUND_TRIP_S.items():
            costs_ms = 1e3 * np.array(_cycle_costs_s(candidates, trip_s))
            period_ms = 3e3 * trip_s
            yield (
                f"  a poll of three over {link}, recorded: median {np.median(costs_ms):.2f} ms, "
                f"99 % {np.percentile(costs_ms, 99):.2f} ms, "
                f"{np.median(costs_ms) / period_ms:.0%} of the {period_ms:.1f} ms that the link takes; "
                f"{period_ms / np.mean(costs_ms):.0f} times real time with all its readings"
            )
    yield from _soak()


def _twin(candidates: tuple[str, ...]) -> BrickTwin:
    twin = BrickTwin(dict.fromkeys(PORTS, motor()), TwinOptions(candidates=candidates))
    twin.move(1e-3)
    return twin


def _real_time_factor(candidates: tuple[str, ...]) -> float:
    twin = _twin(candidates)
    for port in PORTS:
        twin.command(port, 60, "drive", 0.0)
    began = time.process_time()
    twin.move(FREE_RUN_S)
    return FREE_RUN_S / (time.process_time() - began)


def _cycle_costs_s(candidates: tuple[str, ...], trip_s: float) -> list[float]:
    """Predict, compare, update and record three motors, one after the other at the link's pace."""
    twin, truth = _twin(candidates), _twin(())
    costs = []
    now_s = 0.01
    with TemporaryDirectory() as folder, RecordingWriter(Path(folder) / "run.parquet", _COLUMNS) as writer:
        for cycle in range(CYCLES):
            power = (60, -45, 30)[cycle // 100 % 3]
            counts = [_count(truth, port, power, now_s, n * trip_s) for n, port in enumerate(PORTS)]
            began = time.process_time()
            row = {TIME: now_s}
            for n, (port, count) in enumerate(zip(PORTS, counts, strict=True)):
                twin.command(port, power, "drive", now_s)
                twin.read_tacho(port, now_s + n * trip_s, count, 0.1 * trip_s)
                twin.state(port)
                row |= {power_column(port): power, mode_column(port): 0.0, tacho_column(port): count}
            writer.row(row)
            costs.append(time.process_time() - began)
            now_s += 3.0 * trip_s
    return costs


def _count(truth: BrickTwin, port: Port, power: int, now_s: float, after_s: float) -> int:
    truth.command(port, power, "drive", now_s)
    truth.move(now_s + after_s)
    return int(truth.state(port).angle_deg // 1)


def _soak() -> Iterator[str]:
    clock = VirtualClock()
    sensors: dict[int, PortSensor] = {1: "touch", 2: "sound", 3: "light", 4: "ultrasonic"}
    link = open_mock_link(clock, profile="bluetooth", late=LinkTimeoutError, lost=LinkLostError)
    session = Session(
        Parts(
            open_brick=lambda: Brick(link, clock),
            clock=clock,
            twin=_twin(()),
            sink=_Watch(clock, sizes := []),
            plan=Plan(sensors=sensors),  # type: ignore[arg-type]
            pace=PACES["bt"],
            driver=ProgramDriver(excitation(PORTS)),
        )
    )
    began = time.process_time()
    session.run(SOAK_S)
    grown_mb = (sizes[-1] - sizes[len(sizes) // 2]) / 1e3
    yield (
        f"an hour over Bluetooth in virtual time, three motors and four sensors: {session.polls} polls in "
        f"{time.process_time() - began:.0f} s, the process grew by {grown_mb:.1f} MB in the second half"
    )


class _Watch:
    """Looks at the most memory that the process ever had, now and then; kB on Linux."""

    def __init__(self, clock: VirtualClock, sizes: list[int]) -> None:
        self._clock = clock
        self._sizes = sizes
        self._next_s = 0.0

    def event(self, event: Event) -> None:
        """Keep nothing."""

    def close(self) -> None:
        """Nothing to finish."""

    def tick(self, _: Tick) -> None:
        """Look, if it is time."""
        if self._clock.now_s() < self._next_s:
            return
        self._next_s = self._clock.now_s() + SOAK_S / SOAK_CHECKS
        self._sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
