"""Many plants that advance together under the commands of their ports, in one call of the kernel a step."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import NamedTuple, final

import numpy as np

from nxt_twin.errors import PlantError
from nxt_twin.physics.kernel import kernel
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.twin.bridge import FLOAT, Hold

STEP_S = 1e-3
_LATEST_S = 1e-9
_LOAD = Slot("constant_load", "load")

ANGLE, SPEED, CURRENT = 0, 1, 2


class _Line(NamedTuple):
    """A way from commands to rows."""

    port: Port
    delay_s: float


@final
class Batch:
    """Rows of plants, each on a port, from one moment to the next.

    Every row carries an unknown torque that fades. Its mean acts over the time of a call of `advance`, or
    from command to command.

    Args:
        plants: one a row, all of one layout.
        ports: of each row.
        delays_s: by how much commands act later on each row's plant.
        torque_time_s: how long the extra torque takes to fade.
        now_s: the moment to begin with.
        began_s: from when effects count that change with time.

    Attributes:
        values: SI values of each row's plant, shape (rows, parameters).
        state: angle (rad), speed, current and the effects' states, shape (rows, states).
        torque: extra torque, N·m, shape (rows,).
        now_s: the moment that `state` is of.

    Raises:
        PlantError: a plant of another kind, or one that cannot carry a load.
    """

    def __init__(
        self,
        plants: Sequence[Plant],
        ports: Sequence[Port],
        delays_s: Sequence[float],
        torque_time_s: float,
        now_s: float = 0.0,
        began_s: float = 0.0,
    ) -> None:
        plan = plants[0].layout
        if any(plant.layout != plan for plant in plants) or _LOAD not in plan.index:
            mend = "give each port a dc_motor"
            raise PlantError("live twins need motors of one kind", where="plants", mend=mend)
        self._plan = plan
        self._kernel = kernel(plan)
        vectors = [plant.vectors() for plant in plants]
        self.values = np.array([values for values, _ in vectors])
        self._active = np.array([active for _, active in vectors])
        self._shifting = [any("reading" in effect.terms for effect in plant.effects) for plant in plants]
        loaded = [effect.id for effect in plan.effects].index(_LOAD.owner)
        self._load = plan.index[_LOAD]
        self.values[~self._active[:, loaded], self._load] = 0.0
        self._active[:, loaded] = True
        self._own_load = self.values[:, self._load].copy()
        self.torque = np.zeros(len(plants))
        self.state = np.zeros((len(plants), 3 + sum(len(effect.states) for effect in plan.effects)))
        self.now_s = now_s
        self._began_s = began_s
        self._torque_time_s = torque_time_s
        self._duty = np.zeros(len(plants))
        self._mode = np.full(len(plants), 2, dtype=np.int64)
        lines = [_Line(port, delay_s) for port, delay_s in zip(ports, delays_s, strict=True)]
        self._rows_of = {line: np.array([other == line for other in lines]) for line in dict.fromkeys(lines)}
        self._due: dict[_Line, deque[tuple[float, Hold]]] = {line: deque() for line in self._rows_of}

    def command(self, port: Port, at_s: float, holds: Sequence[Hold]) -> None:
        """From `at_s` on a port's bridge does these; what was due later than that is forgotten."""
        for line, due in self._due.items():
            if line.port != port:
                continue
            from_s = at_s + line.delay_s
            while due and due[-1][0] >= from_s - _LATEST_S:
                due.pop()
            due.extend((from_s + hold.after_s, hold) for hold in holds)

    def set_own_load(self, rows: slice) -> None:
        """Take the rows' load from `values`, where it is a parameter that was changed."""
        self._own_load[rows] = self.values[rows, self._load]

    def go_on_from(self, other: Batch) -> None:
        """Have done on each port's bridge what is done in another batch, and do what is still due there."""
        theirs = {line.port: line for line in reversed(other._rows_of)}
        for line, rows in self._rows_of.items():
            self._duty[rows], self._mode[rows] = other.in_force(line.port)
            later_s = line.delay_s - theirs[line.port].delay_s
            due = other._due[theirs[line.port]]
            self._due[line].extend((at_s + later_s, hold) for at_s, hold in due)

    def shift(self, row: int) -> float:
        """By how much a row's encoder shows another angle than the motor's, rad."""
        if not self._shifting[row]:
            return 0.0
        one = slice(row, row + 1)
        shown = np.empty((1, 2))
        self._kernel.read_many(self.values[one], self._active[one], self.state[one], shown)
        return float(shown[0, 0] - self.state[row, ANGLE])

    def lasted(self, row: int) -> dict[int, float]:
        """States of a row's effects that outlast a start anew, by column: how warm a winding is."""
        columns = enumerate(
            (state in effect.lasting and bool(self._active[row, number]))
            for number, effect in enumerate(self._plan.effects)
            for state in effect.states
        )
        return {CURRENT + 1 + n: float(self.state[row, CURRENT + 1 + n]) for n, lasts in columns if lasts}

    def set_lasting(self, rows: slice, states: Mapping[int, float]) -> None:
        """Give rows such states."""
        for column, value in states.items():
            self.state[rows, column] = value

    def in_force(self, port: Port) -> tuple[float, int]:
        """Duty and mode of a port's bridge now, on its first row."""
        row = next(int(np.argmax(rows)) for line, rows in self._rows_of.items() if line.port == port)
        return float(self._duty[row]), int(self._mode[row])

    def advance(self, to_s: float, supply_v: float) -> None:
        """Let time pass until `to_s`; a moment that is past already changes nothing."""
        while self.now_s < to_s - _LATEST_S:
            self._take_due()
            next_s = min((due[0][0] for due in self._due.values() if due), default=math.inf)
            self._steps(min(to_s, next_s), supply_v)
        self._take_due()

    def _steps(self, to_s: float, supply_v: float) -> None:
        duration_s = to_s - self.now_s
        count = max(1, math.ceil(duration_s / STEP_S - 1e-6))
        step_s = duration_s / count
        left = math.exp(-duration_s / self._torque_time_s)
        mean_left = (1.0 - left) * self._torque_time_s / duration_s
        self.values[:, self._load] = self._own_load + mean_left * self.torque
        self.torque *= left
        step_many, elapsed_s = self._kernel.step_many, self.now_s - self._began_s
        for n in range(count):
            step_many(
                self.values,
                self._active,
                self.state,
                self._duty,
                self._mode,
                supply_v,
                elapsed_s + n * step_s,
                step_s,
            )
        self.now_s = to_s

    def _take_due(self) -> None:
        for line, due in self._due.items():
            while due and due[0][0] <= self.now_s + _LATEST_S:
                _, hold = due.popleft()
                rows = self._rows_of[line]
                self._duty[rows], self._mode[rows] = hold.duty, hold.mode

    def drawn_a(self, row: int) -> float:
        """The current that a row's motor draws from the supply, A."""
        current_a = float(self.state[row, CURRENT])
        # A floating winding conducts only while it is connected: its mean current is all that the battery gives.
        return abs(current_a) if self._mode[row] == FLOAT else float(self._duty[row]) * current_a
