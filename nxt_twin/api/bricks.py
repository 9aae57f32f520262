"""Open a brick, record one, and serve one made of software."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from nxt_twin.api.files import read_recording
from nxt_twin.api.openers import OPENERS, concealing
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock, PacedClock, SystemClock
from nxt_twin.brick.discovery import default_ways, search_ways
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.brick.open import open_brick as _open
from nxt_twin.mock.run import serve
from nxt_twin.mock.thread import served_in_thread
from nxt_twin.recording.columns import PORTS, Port, SensorSlot
from nxt_twin.recording.programs import load_program
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.driver import ProgramDriver
from nxt_twin.twin.logbook import Logbook, columns_to_fill
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.sensor_twin import PortSensor
from nxt_twin.twin.settings import pace_of


def open_brick(url: str | None = None) -> Brick:
    """Open a brick by its URL (docs/formats.md#urls-of-bricks).

    Leaving the `with` block lets its motors coast and closes the link.

    Args:
        url: such as `usb:`, `bt:00:16:53:01:02:03`, `tcp:127.0.0.1:7000` or `mock:`; None takes the first that a
            search finds.

    Raises:
        LinkUrlError: the URL is none.
        LinkRefusedError: no brick was found, or it cannot be reached; the text says why.

    >>> import nxt_twin as nt
    >>> with nt.open_brick("mock:") as brick:
    ...     brick.device.battery_v().value > 7.0
    True
    """
    clock = SystemClock()
    return _open(url or _first_found(clock), clock, OPENERS)


def record(
    url: str,
    out: str | Path,
    *,
    program: str | None = None,
    ports: tuple[Port, ...] = ("a",),
    sensors: Mapping[SensorSlot, PortSensor] | None = None,
    seconds: float | None = None,
) -> Recording:
    """Record a brick into a file. With a program, its motors turn at once and without a question.

    A `mock:` brick in this process is recorded in virtual time, faster than it lives.

    Args:
        url: as for `open_brick`.
        out: the recording: `.csv` or `.parquet`; never written over.
        program: a motor program's name or file (docs/record.md); without one, motors are only read.
        ports: motors to read.
        sensors: what is plugged in where, such as `{1: "touch"}`.
        seconds: how long; by default as long as the program.

    Raises:
        NxtTwinError: the brick cannot be reached or is lost, or the file exists; the text says which.

    >>> import nxt_twin as nt
    >>> nt.record("mock:", "run.csv", program="gentle_steps", seconds=2.0)
    <Recording run.csv: 200 rows, 1.989 s, a_power_pct, a_tacho_deg, battery_v, a_mode>
    """
    path, plan = Path(out), Plan(sensors=sensors or {}, period_s=0.01)
    driver = None if program is None else ProgramDriver(load_program(program))
    wanted = tuple(port for port in PORTS if port in ports or (driver is not None and port in driver.ports))
    duration_s = math.inf if seconds is None else seconds
    duration_s = duration_s if driver is None else min(duration_s, driver.duration_s)
    if math.isinf(duration_s):
        raise ValueError("record: say how many seconds, or name a program")
    clock: Clock = PacedClock(SystemClock(), math.inf) if url.startswith("mock:") else SystemClock()
    with (
        RecordingWriter(path, columns_to_fill(wanted, plan.sensors)) as writer,
        _open(url, clock, OPENERS) as brick,
    ):
        logbook = Logbook(brick, clock, wanted, plan, writer, driver, pace_of(url))
        try:
            logbook.keep(duration_s)
        finally:
            logbook.row_lags.write_beside(path)
    return read_recording(path)


@contextmanager
def start_mock(
    *, world: str | Path | None = None, seed: int = 0, conceal: int | str | None = None
) -> Iterator[str]:
    """Serve a mock brick on a free TCP port of this machine while the `with` block lasts; gives its URL.

    Args:
        world: a world file (docs/mock.md); without it the brick is as LEGO ships it.
        seed: of the sensors' noise.
        conceal: a seed or a file: motor A then is another than it seems.

    Raises:
        WorldError: the world file is none.
        ServeError: it cannot be served.

    >>> import nxt_twin as nt
    >>> with nt.start_mock() as url, nt.open_brick(url) as brick:
    ...     brick.device.info().value.name
    'NXT'
    """
    serving = partial(
        serve,
        clock=SystemClock(),
        tcp="127.0.0.1:0",
        world=None if world is None else Path(world),
        seed=seed,
        change=concealing(None if conceal is None else str(conceal)),
    )
    with served_in_thread(serving) as served:
        yield served.urls[0]


def _first_found(clock: Clock) -> str:
    for report in search_ways(clock, default_ways()):
        for brick in report.bricks:
            return brick.url
    mend = "switch it on, or name mock: for one made of software"
    raise LinkRefusedError("no brick was found", cause=Refusal.NOT_FOUND, mend=mend)
