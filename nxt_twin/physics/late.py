"""Commands that act late: what was commanded a plant's delay ago is in force now."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Sequence
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.modes import MODE_COAST
from nxt_twin.physics.plant import Plant


@final
class LateCommands:
    """The commands in force on several plants, each with its own delay; nothing drives them at first.

    Args:
        plants: whose `delay` terms say how late each takes its commands.
    """

    def __init__(self, plants: Sequence[Plant]) -> None:
        self._delays_s = [_delay_s(plant) for plant in plants]
        self._late = max(self._delays_s) > 0.0
        self._waiting: list[deque[tuple[float, float, int]]] = [deque() for _ in plants]
        self._duty = np.zeros(len(plants))
        self._mode = np.full(len(plants), MODE_COAST, dtype=np.int64)

    def at(self, time_s: float, duty: FloatArray, mode: IntArray) -> tuple[FloatArray, IntArray]:
        """Take the commands given at `time_s`, and give those in force then; each of shape (plants,)."""
        if not self._late:
            self._duty[:], self._mode[:] = duty, mode
            return self._duty, self._mode
        for i, delay_s in enumerate(self._delays_s):
            if delay_s <= 0.0:
                self._duty[i], self._mode[i] = duty[i], mode[i]
                continue
            queue = self._waiting[i]
            queue.append((time_s + delay_s, float(duty[i]), int(mode[i])))
            while queue and queue[0][0] <= time_s + 1e-9:
                _, self._duty[i], self._mode[i] = queue.popleft()
        return self._duty, self._mode


def effects_delay_s(plant: Plant) -> float:
    """By how much a plant's effects have it take commands later, s."""
    total = 0.0
    for effect in plant.effects:
        if "delay" in effect.terms:
            term = effect.terms["delay"]
            values = [plant.values[Slot(effect.id, name)] for name in inspect.signature(term).parameters]
            total += float(term(*values))  # type: ignore[arg-type]
    return total


def _delay_s(plant: Plant) -> float:
    base = plant.layout.base
    return effects_delay_s(plant) + (plant.values[Slot(BASE_OWNER, base.delay)] if base.delay else 0.0)
