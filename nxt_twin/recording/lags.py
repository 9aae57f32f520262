"""By how much the readings and commands of a row are off its stamp, for whoever plays or diagnoses the recording.

A row has one stamp, that of its last reply; with several motors on one link, the first was read some round trips
before.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, final

import yaml

from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import Port
from nxt_twin.recording.pulses import PULSE_STEPS, PULSES_KEY
from nxt_twin.recording.yaml_file import read_yaml

_KEY: Final = "row_lags"
_READ: Final = "read_before_s"
_READ_STD: Final = "read_std_s"
_ACTED: Final = "acted_after_s"
_ACTED_STD: Final = "acted_std_s"
_LONGEST_S: Final = 10.0
_MEND: Final = f"write such as {_READ}: {{a: 0.004}}, up to {_LONGEST_S:g} s, or take {_KEY} out"


@final
class Lag:
    """Mean and standard deviation of a time that comes again and again, each time known to a doubt of its own, s."""

    def __init__(self) -> None:
        self._count = 0
        self._squares = 0.0
        self.mean_s = 0.0

    @property
    def std_s(self) -> float:
        """The standard deviation."""
        return math.sqrt(self._squares / self._count) if self._count else 0.0

    def add(self, time_s: float, doubt_s: float) -> None:
        """Take one (Welford's update)."""
        self._count += 1
        before = time_s - self.mean_s
        self.mean_s += before / self._count
        self._squares += before * (time_s - self.mean_s) + doubt_s**2


@final
class RowLags:
    """Those of a session, learnt while it is recorded."""

    def __init__(self) -> None:
        self._taken: dict[Port, tuple[float, float]] = {}
        self._read: dict[Port, Lag] = {}
        self._acted: dict[Port, Lag] = {}

    def taken(self, port: Port, at_s: float, std_s: float) -> None:
        """A motor's count in the row to come was taken then."""
        self._taken[port] = at_s, std_s

    def row(self, stamp_s: float) -> None:
        """The row with what was taken has this stamp."""
        for port, (at_s, std_s) in self._taken.items():
            self._read.setdefault(port, Lag()).add(stamp_s - at_s, std_s)
        self._taken.clear()

    def acted(self, port: Port, after_s: float, std_s: float) -> None:
        """A command acted so long after its row's stamp."""
        self._acted.setdefault(port, Lag()).add(after_s, std_s)

    def write_beside(self, recording: Path) -> None:
        """Put them, and the bridge's steps, in the recording's sidecar, unless one tells more and is the user's.

        Before anything is learnt, that is the steps alone. The sidecar is there whole, or as it was.

        Raises:
            OSError: it cannot be written.
        """
        sidecar = recording.with_suffix(".yaml")
        if not _is_ours(sidecar):
            return
        keys: dict[str, Any] = {_KEY: self._learnt()} if self._read else {}
        text = yaml.safe_dump({**keys, PULSES_KEY: PULSE_STEPS}, sort_keys=False)
        partial = sidecar.with_name(f".{sidecar.name}.{os.getpid()}.partial")
        try:
            partial.write_text(text, encoding="utf-8")
            partial.replace(sidecar)
        finally:
            partial.unlink(missing_ok=True)

    @staticmethod
    def remove_beside(recording: Path) -> None:
        """Take the sidecar away again, unless it is the user's: nothing was recorded."""
        sidecar = recording.with_suffix(".yaml")
        if sidecar.exists() and _is_ours(sidecar):
            sidecar.unlink()

    def _learnt(self) -> dict[str, dict[Port, float]]:
        return {
            _READ: {port: round(lag.mean_s, 6) for port, lag in self._read.items()},
            _READ_STD: {port: round(lag.std_s, 6) for port, lag in self._read.items()},
            _ACTED: {port: round(lag.mean_s, 6) for port, lag in self._acted.items()},
            _ACTED_STD: {port: round(lag.std_s, 6) for port, lag in self._acted.items()},
        }


def _is_ours(sidecar: Path) -> bool:
    """Whether there is none, or one that an earlier recording of that name left."""
    if not sidecar.exists():
        return True
    try:
        keys = read_yaml(sidecar, RecordingError)
    except RecordingError:
        return False
    return (
        bool(keys) and keys.keys() <= {_KEY, PULSES_KEY} and keys.get(PULSES_KEY, PULSE_STEPS) == PULSE_STEPS
    )


@final
class KnownLags:
    """Those that a recording's sidecar tells; none where it tells none.

    Args:
        sidecar: its keys.
        where: it lies, for complaints.

    Raises:
        RecordingError: they are not seconds by port.
    """

    def __init__(self, sidecar: Mapping[str, Any] | None = None, where: str = "") -> None:
        told = (sidecar or {}).get(_KEY) or {}
        if not isinstance(told, Mapping):
            raise RecordingError("tells no lags by kind", where=f"{where}, key {_KEY}", mend=_MEND)
        self._read, self._read_std, self._acted, self._acted_std = (
            _seconds(told.get(key) or {}, f"{where}, key {_KEY}: {key}")
            for key in (_READ, _READ_STD, _ACTED, _ACTED_STD)
        )

    def read_before_s(self, port: str) -> tuple[float, float]:
        """How long before its row's stamp a motor's count was taken, and how well that is known."""
        return self._read.get(port, 0.0), self._read_std.get(port, 0.0)

    def acted_after_s(self, port: str) -> tuple[float, float]:
        """How long after its row's stamp a command acted, and how well that is known."""
        return self._acted.get(port, 0.0), self._acted_std.get(port, 0.0)

    def acting_sooner(self, port: str, by_s: float) -> KnownLags:
        """These lags, with commands that acted `by_s` sooner."""
        acted = {**self._acted, port: self._acted.get(port, 0.0) - by_s}
        lags = {_READ: self._read, _READ_STD: self._read_std, _ACTED: acted, _ACTED_STD: self._acted_std}
        return KnownLags({_KEY: lags})


def _seconds(told: object, where: str) -> dict[str, float]:
    """What a user may have edited."""
    if not isinstance(told, Mapping) or not all(_is_lag(each) for each in told.values()):
        raise RecordingError("tells no seconds by port", where=where, mend=_MEND)
    return {str(port): float(each) for port, each in told.items()}


def _is_lag(told: object) -> bool:
    return isinstance(told, int | float) and abs(told) <= _LONGEST_S
