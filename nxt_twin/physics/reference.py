"""The same step in plain Python, straight from the declarations: the oracle for the compiled kernel.

It interprets what `assemble` writes out. It is slow, and shares neither source nor compiler with the kernel.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np

from nxt_twin.physics.effect import Stage
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job
from nxt_twin.physics.terms import calls
from nxt_twin.recording.recording import FloatArray

_Scope = dict[str, float]


def predict(plant: Plant, job: Job) -> dict[str, FloatArray]:
    """What `Simulator.run` gives for one plant: `predicted`, `weight` and `cost`, each of shape (samples,)."""
    axis = _Axis(plant)
    signals = job.signals
    delay_s = axis.formed("delay", {}, 0.0)
    time_s = float(signals.time_s[0])
    commands = signals.command_time_s + delay_s
    rows = signals.time_s.size
    found = {name: np.zeros(rows) for name in ("predicted", "weight", "cost")}
    last_reading = 0.0
    for k in range(rows):
        edges = commands[(commands > time_s) & (commands < signals.time_s[k])]
        for stop in [*np.unique(edges), float(signals.time_s[k])]:
            held = int(np.searchsorted(commands, time_s, side="right")) - 1
            pieces = max(1, math.ceil((stop - time_s) / job.step_s - 1e-9))
            for piece in range(pieces if stop > time_s else 0):
                step_s = (stop - time_s) / pieces
                axis.step(
                    command=float(signals.command[held]) if held >= 0 else 0.0,
                    mode=int(signals.command_mode[max(held, 0)]),
                    supply_v=float(signals.command_supply_v[max(held, 0)]),
                    elapsed_s=time_s + piece * step_s - float(signals.time_s[0]),
                    step_s=step_s,
                    fading=math.exp(-step_s / job.disturbance_time_s),
                )
            time_s = float(stop)
        if job.start.at[k]:
            axis.restart(float(job.start.position[k]), float(job.start.speed[k]))
            last_reading = axis.reading(is_speed=signals.is_speed)
        predicted = found["predicted"][k] = axis.reading(is_speed=signals.is_speed)
        reading = float(signals.measured[k])
        if math.isnan(reading) or job.start.at[k]:
            continue
        std = float(job.observer.innovation_std[k])
        weight, cost = axis.judge(reading, predicted, last_reading, std)
        found["weight"][k], found["cost"][k] = weight, cost
        axis.correct(job.observer.gains[k] * weight * (reading - predicted))
        last_reading = reading
    return found


@final
class _Axis:
    """The state of one axis, stepped term by term."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self._base = {s.symbol: v for s, v in plant.values.items() if s.owner == BASE_OWNER}
        self._states: dict[str, _Scope] = {}
        self._angle = self._speed = self._current = self._disturbance = 0.0
        self.restart(0.0, 0.0)

    def restart(self, angle: float, speed: float) -> None:
        self._angle, self._speed = angle, speed
        self._current = self._disturbance = 0.0
        self._states = {
            effect.id: {state: speed if state in effect.moving else 0.0 for state in effect.states}
            for effect in self._plant.effects
        }

    def reading(self, *, is_speed: bool) -> float:
        return self._speed if is_speed else self._angle

    def correct(self, change: FloatArray) -> None:
        self._angle += float(change[0])
        self._speed += float(change[1])
        self._disturbance += float(change[2])

    def judge(self, reading: float, predicted: float, last_reading: float, std: float) -> tuple[float, float]:
        """The weight of a reading and its negative log-likelihood."""
        if std <= 0.0:
            return 1.0, 0.0
        scope = {
            "reading": reading,
            "predicted": predicted,
            "last_reading": last_reading,
            "reading_std": std,
        }
        faults = [effect for effect in self._plant.effects if "outlier" in effect.terms]
        shares = [self._plant.values[Slot(e.id, e.parameters[0].symbol)] for e in faults]
        ratio = (reading - predicted) / std
        if not faults:
            return 1.0, 0.5 * ratio * ratio + math.log(std * math.sqrt(2.0 * math.pi))
        fresh = (1.0 - sum(shares)) * math.exp(-0.5 * ratio * ratio) / (std * math.sqrt(2.0 * math.pi))
        total = fresh + self.formed("outlier", scope, 0.0) + 1e-300
        return fresh / total, -math.log(total)

    def formed(self, stage: Stage, scope: Mapping[str, float], start: float, *, chained: str = "") -> float:
        """The value that the active terms of `stage` form: a sum, or handed through each under `chained`."""
        value = start
        for call in calls(self._plant.layout, stage):
            if call.effect.id not in self._plant.active:
                continue
            handed = {**scope, chained: value} if chained else scope
            result = call.term(*self._arguments(call.effect.id, call.arguments, handed))
            value = float(result) if chained else value + float(result)  # type: ignore[arg-type]
        return value

    def step(
        self, command: float, mode: int, supply_v: float, elapsed_s: float, step_s: float, fading: float
    ) -> None:
        before, inertia = self._speed, self._base["inertia"]
        scope: _Scope = {"elapsed_s": elapsed_s, "speed": before, "current": self._current, "step_s": step_s}
        scope["duty"] = self.formed("duty", {**scope, "duty": command}, command, chained="duty")
        drive: _Scope = {**self._base, **scope, "mode": mode, "supply_v": supply_v}
        drive["resistance"] = self.formed("resistance", scope, self._base.get("resistance", 0.0))
        drive["inductance"] = self.formed("inductance", scope, 0.0)
        drive["drop"] = self.formed("drop", scope, 0.0)
        drive["limit"] = self.formed("limit", scope, math.inf, chained="limit")
        force, coupling = _call(self._plant.layout.base.drive, drive)
        scope |= {"angle": self._angle + 0.5 * step_s * before, "inertia": inertia}
        damping = coupling + self.formed("damping", scope, 0.0)
        load = self.formed("torque", scope, 0.0)
        pull = force + load + inertia * self._disturbance
        free = ((2 * inertia / step_s - damping) * before + 2 * pull) / (2 * inertia / step_s + damping)
        scope |= {
            "direction": math.copysign(1.0, before if before != 0.0 else free),
            "drive_torque": force - coupling * before,
            "load_torque": load,
        }
        level = self.formed("friction", scope, 0.0, chained="level")
        bite = 2.0 * level / (2 * inertia / step_s + damping)
        after = free - scope["direction"] * bite
        if after * scope["direction"] < 0.0:  # it comes to rest within the step, and may then turn back
            push = scope["direction"] * (before - free) - bite
            reached = scope["direction"] * before / (push + 2.0 * bite) if push > 0.0 else 1.0
            after = -scope["direction"] * push * (1.0 - reached) if push > 0.0 else 0.0
        self._advance({**scope, "before": before, "after": after})
        settle = self._plant.layout.base.current_after
        if settle:
            ends = {"force": force, "coupling": coupling, "before": before, "after": after}
            self._current = _call(settle, {**drive, **ends})
        self._angle += 0.5 * step_s * (before + after)
        self._speed = after
        self._disturbance *= fading

    def _advance(self, scope: _Scope) -> None:
        for call in calls(self._plant.layout, "advance"):
            effect = call.effect
            if effect.id in self._plant.active:
                values = call.term(*self._arguments(effect.id, call.arguments, scope))
                self._states[effect.id] = dict(zip(effect.states, values, strict=True))  # type: ignore[arg-type]

    def _arguments(self, owner: str, names: tuple[str, ...], scope: Mapping[str, float]) -> list[float]:
        states = self._states.get(owner, {})
        own = {slot.symbol: value for slot, value in self._plant.values.items() if slot.owner == owner}
        return [
            own[name] if name in own else states[name] if name in states else scope[name] for name in names
        ]


def _call(function: Callable[..., Any], scope: Mapping[str, float]) -> Any:  # noqa: ANN401  # as the function
    return function(*(scope[name] for name in inspect.signature(function).parameters))
