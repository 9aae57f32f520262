"""Cost of the dashboard: to the loop for each poll handed over, and to its own process for each poll
drawn."""

from __future__ import annotations

import math
import tempfile
import threading
import time
from pathlib import Path
from typing import Final

from benchmarks.timing import times_s
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Innovation, MotorBelief, Tick
from nxt_twin.view.dashboard import open_dashboard
from nxt_twin.view.dashboard.wire import line_of, read

_PORTS: Final[tuple[Port, ...]] = ("a", "b", "c")
_CHANNELS: Final = ("s1_light_raw", "s4_ultrasonic_cm")
_POLL_S: Final = 0.01
_POLLS: Final = 1000
_BATCH: Final = 25


def report() -> list[str]:
    """The measurement, as lines to print."""
    ticks = [_tick(number) for number in range(_POLLS)]
    return [*_handed_over(ticks), *_drawn(ticks)]


def _handed_over(ticks: list[Tick]) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        dashboard = open_dashboard(
            view="none", save=Path(folder) / "run.rrd", ports=_PORTS, channels=_CHANNELS, title="benchmark"
        )
        pause = threading.Event()
        costs_us = []
        for tick in ticks:
            began = time.perf_counter()
            dashboard.tick(tick)
            costs_us.append(1e6 * (time.perf_counter() - began))
            pause.wait(_POLL_S)
        dashboard.close()
        size_kb = (Path(folder) / "run.rrd").stat().st_size / 1e3
    costs_us.sort()
    encode_us = 1e6 * min(sum(times_s(lambda tick=tick: line_of(tick), 1)) for tick in ticks)  # type: ignore[misc]
    return [
        f"loop: handing a poll of three motors and two sensors over costs {costs_us[len(costs_us) // 2]:.1f} us "
        f"in the middle of {_POLLS} at {1 / _POLL_S:.0f} Hz, {costs_us[int(0.99 * len(costs_us))]:.1f} us at most "
        f"in 99 % of them; {dashboard.dropped} dropped",
        f"loop's process: the feeder's thread takes {encode_us:.0f} us a poll for turning it into a line",
        f"file: {size_kb / (_POLLS * _POLL_S):.0f} kB for each second of the session",
    ]


def _drawn(ticks: list[Tick]) -> list[str]:
    # Brings in rerun, which the loop's process does without.
    from nxt_twin.view.dashboard.drawing.painter import Painter

    lines = [line_of(tick) for tick in ticks]
    with tempfile.TemporaryDirectory() as folder:
        painter = Painter("benchmark", _PORTS, _CHANNELS, Path(folder) / "run.rrd")
        batches = [lines[at : at + _BATCH] for at in range(0, len(lines), _BATCH)]
        began_s = time.process_time()
        for batch in batches:
            painter.paint([_poll(line) for line in batch], [], [])
        poll_us = 1e6 * (time.process_time() - began_s) / _POLLS
        painter.close()
    return [
        f"dashboard's process: {poll_us:.0f} us of processor time a poll in batches of {_BATCH}, "
        f"{100 * poll_us * 1e-6 / _POLL_S:.1f} % of a core at {1 / _POLL_S:.0f} Hz"
    ]


def _poll(line: bytes) -> Tick:
    message = read(line)
    if not isinstance(message, Tick):
        raise TypeError(line)
    return message


def _tick(number: int) -> Tick:
    time_s = number * _POLL_S
    angle = 600 * math.sin(time_s)
    motors = tuple(
        MotorBelief(
            port, 60.0, "drive", angle, 600 * math.cos(time_s), 0.1, 1e-3, 2e-3,
            {"nothing": 0.7, "stiction": 0.2, "viscous_friction": 0.05, "constant_load": 0.05},
        )
        for port in _PORTS
    )  # fmt: skip
    readings = (
        *(Innovation(time_s, f"{port}_tacho_deg", "deg", round(angle), angle, 0.5) for port in _PORTS),
        Innovation(time_s, "s1_light_raw", "raw", 500.0, 502.0, 9.0),
        Innovation(time_s, "s4_ultrasonic_cm", "cm", 40.0, 40.5, 0.5),
    )
    return Tick(number, time_s - 0.005, time_s, motors, readings, 7.9 if number % 100 == 0 else None)


if __name__ == "__main__":
    print("\n".join(report()))
