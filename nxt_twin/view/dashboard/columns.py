"""A batch of polls as columns of numbers, one table for each curve of the dashboard."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.twin.records import Innovation, Tick

BAND: Final = 2.0
"""Standard deviations that a band is wide each way."""
NIS_BOUND: Final = 3.84
"""A normalised innovation square stays below this 95 % of the time while the model holds: chi squared, one degree."""
_NIS_MEMORY: Final = 50
_RATE_MEMORY: Final = 20
_LEAST_LIKELY: Final = 0.05
"""A curve for each effect that ever was as likely: a legend of all that are weighed would cover the plot."""


@final
@dataclass(frozen=True)
class DrawnTable:
    """The values that are drawn under one name.

    Attributes:
        path: of the entity.
        time_s: shape (rows,).
        values: shape (rows, curves).
    """

    path: str
    time_s: FloatArray
    values: FloatArray


def motor_path(port: Port, curve: str) -> str:
    """Where a motor's curve is found."""
    return f"/motor_{port}/{curve}"


def effect_path(port: Port, effect: str) -> str:
    """Where the probability of a motor's effect is found."""
    return motor_path(port, f"effects/{effect}")


def sensor_path(channel: str, curve: str) -> str:
    """Where a sensor's curve is found."""
    return f"/sensors/{channel}/{curve}"


READING: Final = ("measured", "predicted", "band, low", "band, high")
INNOVATION: Final = ("innovation", "bound, high", "bound, low")
NIS: Final = ("square", f"mean of {_NIS_MEMORY}", f"95 % below {NIS_BOUND}")
TORQUE: Final = ("unknown torque", "band, low", "band, high")


@final
class Tabulator:
    """Makes tables of batches of polls, and remembers between batches what running means need.

    Args:
        ports: of the motors that are shown.
    """

    def __init__(self, ports: Sequence[Port]) -> None:
        self._ports = tuple(ports)
        self._squares: dict[str, deque[float]] = {}
        self._sent_s: deque[float] = deque(maxlen=_RATE_MEMORY + 1)
        self._likely: set[tuple[Port, str]] = set()

    def tables(self, ticks: Sequence[Tick]) -> list[DrawnTable]:
        """The tables of a batch; those without a row are left out."""
        channels: dict[str, list[Innovation]] = {}
        for tick in ticks:
            for innovation in tick.innovations:
                channels.setdefault(innovation.channel, []).append(innovation)
        found: list[DrawnTable] = []
        motors = {tacho_column(port): port for port in self._ports}
        for channel, innovations in channels.items():
            port = motors.get(channel)
            place = f"/motor_{port}" if port else f"/sensors/{channel}"
            found += self._reading_tables(place, channel, innovations)
        for port in self._ports:
            found += _motor_tables(port, ticks, self._likely)
        return [table for table in (*found, *self._link_tables(ticks)) if table.time_s.size]

    def _reading_tables(
        self, place: str, channel: str, innovations: Sequence[Innovation]
    ) -> list[DrawnTable]:
        rows = np.array([(i.time_s, i.measured, i.predicted, i.variance) for i in innovations])
        time_s, measured, predicted, variance = rows.T
        reach = BAND * np.sqrt(np.maximum(variance, 0.0))
        memory = self._squares.setdefault(channel, deque(maxlen=_NIS_MEMORY))
        squares = []
        for innovation in innovations:
            square = innovation.normalised_square if innovation.variance > 0 else 0.0
            memory.append(square)
            squares.append((square, sum(memory) / len(memory), NIS_BOUND))
        curves = {
            "reading": np.column_stack([measured, predicted, predicted - reach, predicted + reach]),
            "innovation": np.column_stack([measured - predicted, reach, -reach]),
            "square": np.array(squares),
        }
        found = [DrawnTable(f"{place}/{name}", time_s, values) for name, values in curves.items()]
        refused = np.array([not innovation.accepted for innovation in innovations])
        return [*found, DrawnTable(f"{place}/refused", time_s[refused], measured[refused, None])]

    def _link_tables(self, ticks: Sequence[Tick]) -> list[DrawnTable]:
        up = [tick for tick in ticks if tick.link_up]
        rates = []
        for tick in up:
            self._sent_s.append(tick.sent_s)
            span_s = self._sent_s[-1] - self._sent_s[0]
            rates.append((len(self._sent_s) - 1) / span_s if span_s > 0 else np.nan)
        read = [(tick.received_s, tick.battery_v) for tick in ticks if tick.battery_v is not None]
        time_s = np.array([tick.received_s for tick in up])
        rate_hz = np.array(rates)
        known = np.isfinite(rate_hz)
        latency_ms = np.array([1e3 * (tick.received_s - tick.sent_s) for tick in up])
        return [
            DrawnTable("/link/latency_ms", time_s, latency_ms[:, None]),
            DrawnTable("/link/polls_hz", time_s[known], rate_hz[known, None]),
            DrawnTable("/link/up", *_changes([(tick.received_s, float(tick.link_up)) for tick in ticks])),
            DrawnTable("/battery/volts", np.array([at for at, _ in read]), np.array([[v] for _, v in read])),
        ]


def _motor_tables(port: Port, ticks: Sequence[Tick], likely: set[tuple[Port, str]]) -> list[DrawnTable]:
    """The tables of one motor; an effect's probability from the batch on in which it is first likely."""
    states = [(tick.received_s, motor) for tick in ticks for motor in tick.motors if motor.port == port]
    if not states:
        return []
    time_s = np.array([at for at, _ in states])
    reach = np.array([BAND * motor.unknown_torque_std_nm for _, motor in states])
    torque = np.array([motor.unknown_torque_nm for _, motor in states])
    found = [
        DrawnTable(
            motor_path(port, "torque"),
            time_s,
            1e3 * np.column_stack([torque, torque - reach, torque + reach]),
        ),
    ]
    likely |= {
        (port, name)
        for _, motor in states
        for name, probability in motor.effects.items()
        if name == "nothing" or probability >= _LEAST_LIKELY
    }
    for name in sorted(name for of, name in likely if of == port):
        rows = [(at, motor.effects[name]) for at, motor in states if name in motor.effects]
        if rows:
            at_s, probability = np.array(rows).T
            found.append(DrawnTable(effect_path(port, name), at_s, probability[:, None]))
    return found


def _changes(rows: Sequence[tuple[float, float]]) -> tuple[FloatArray, FloatArray]:
    """Only the rows at which the value changes, and the ends."""
    kept = [
        row
        for n, row in enumerate(rows)
        if n in (0, len(rows) - 1) or row[1] != rows[n - 1][1] or row[1] != rows[n + 1][1]
    ]
    table = np.array(kept, dtype=np.float64).reshape(-1, 2)
    return table[:, 0], table[:, 1:]


@final
@dataclass(frozen=True)
class Turn:
    """How a motor turned during a batch: shape (rows,) each.

    Attributes:
        time_s: of the row.
        measured_deg: NaN-free; where nothing was read, the last count.
        predicted_deg: what the twin expected; without a reading, what it estimates.
    """

    time_s: FloatArray
    measured_deg: FloatArray
    predicted_deg: FloatArray


def turn_of(port: Port, ticks: Sequence[Tick], last_deg: float) -> Turn:
    """A motor's angles; `last_deg` is the count before the batch."""
    rows = []
    column = tacho_column(port)
    for tick in ticks:
        motor = next((motor for motor in tick.motors if motor.port == port), None)
        read = next((i for i in tick.innovations if i.channel == column), None)
        if read is not None:
            last_deg = read.measured
        if motor is not None:
            expected = motor.angle_deg if read is None else read.predicted
            rows.append((tick.received_s, last_deg, expected))
    table = np.array(rows, dtype=np.float64).reshape(-1, 3)
    return Turn(table[:, 0], table[:, 1], table[:, 2])
