"""The last while of a motor, as a recording to diagnose; and a whole session, as contract 1 wants it."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, Protocol, final

import numpy as np

from nxt_twin.recording.columns import BATTERY, TIME, Port, mode_column, power_column, tacho_column
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import DRIVE_MODES, DriveMode, Recording

_ROWS_MOST = 12_000


class _Row(NamedTuple):
    time_s: float
    power_pct: int
    mode: DriveMode
    count: float
    supply_v: float


@final
class History:
    """Commands and counts of one motor, at the times at which they acted and were taken.

    Args:
        port: of the motor.
        rows_most: how many rows to keep; older ones are forgotten.
    """

    def __init__(self, port: Port, rows_most: int = _ROWS_MOST) -> None:
        self._port = port
        self._rows: deque[_Row] = deque(maxlen=rows_most)

    def command(self, at_s: float, power_pct: int, mode: DriveMode, supply_v: float) -> None:
        """A command acted."""
        self._add(_Row(at_s, power_pct, mode, float("nan"), supply_v))

    def count(self, taken_s: float, count: int, power_pct: int, mode: DriveMode, supply_v: float) -> None:
        """A count was taken, with this command in force."""
        self._add(_Row(taken_s, power_pct, mode, float(count), supply_v))

    def _add(self, row: _Row) -> None:
        if not self._rows or row.time_s > self._rows[-1].time_s:
            self._rows.append(row)

    def clear(self) -> None:
        """Forget everything: what was before is not to be compared with what comes."""
        self._rows.clear()

    def seconds_since(self, from_s: float) -> float:
        """How long a recording from then on would be, s."""
        if not self._rows:
            return 0.0
        return self._rows[-1].time_s - max(from_s, self._rows[0].time_s)

    def recording(self, from_s: float) -> Recording:
        """What was kept from `from_s` on."""
        rows = [row for row in self._rows if row.time_s >= from_s]
        return Recording(
            "live",
            {
                TIME: np.array([row.time_s for row in rows]),
                power_column(self._port): np.array([row.power_pct for row in rows], dtype=np.float64),
                mode_column(self._port): np.array(
                    [DRIVE_MODES.index(row.mode) for row in rows], dtype=np.float64
                ),
                tacho_column(self._port): np.array([row.count for row in rows]),
                BATTERY: np.array([row.supply_v for row in rows]),
            },
        )


class Recorder(Protocol):
    """Keeps a session as a recording."""

    def row(self, values: Mapping[str, float]) -> None:
        """Keep one poll: contract 1's columns by name, modes as indices; what was not sampled is left out."""
        ...

    def close(self) -> None:
        """The session is over."""
        ...


@final
class TableRecorder:
    """Keeps a session in memory and writes it at its end.

    Args:
        path: `.csv` or `.parquet`.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._rows: list[Mapping[str, float]] = []

    def row(self, values: Mapping[str, float]) -> None:
        """Keep one poll."""
        self._rows.append(dict(values))

    def close(self) -> None:
        """Write the recording, if there is anything in it.

        Raises:
            RecordingError: it cannot be written.
        """
        if not self._rows:
            return
        names = dict.fromkeys(name for row in self._rows for name in row)
        columns = {name: np.array([row.get(name, np.nan) for row in self._rows]) for name in names}
        write_recording(Recording(self._path.name, columns), self._path)
