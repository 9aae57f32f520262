"""The step in plain Python, straight from the declarations: the oracle for the compiled kernel.

It interprets what `assemble` writes out. It is slow, and shares neither source nor compiler with the kernel.
"""

from __future__ import annotations

import inspect
import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.assemble import SETTLING
from nxt_twin.physics.effect import Stage
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job
from nxt_twin.physics.terms import Call, calls

_Scope = dict[str, float]


def predict(plant: Plant, job: Job) -> dict[str, FloatArray]:
    """What `Simulator.run` gives for one plant: `predicted`, `weight` and `cost`, each of shape (samples,)."""
    signals = job.signals
    home = float(job.start.position[0])
    axis = _Axis(plant, home=home, session_s=signals.session_s)
    untold = home if plant.layout.base.control else 0.0
    began_s = float(signals.time_s[0])
    base = plant.layout.base
    delay_s = axis.formed("delay", {}, plant.values[Slot(BASE_OWNER, base.delay)] if base.delay else 0.0)
    late_s = [
        axis.formed(
            "commanded",
            {"stamp_s": t - began_s, "late": late, "longer_after_s": after_s, "longer_before_s": before_s},
            0.0,
        )
        for t, (late, after_s, before_s) in zip(
            signals.command_time_s.tolist(), signals.command_moments.tolist(), strict=True
        )
    ]
    commands, loads = signals.command_time_s - np.array(late_s) + delay_s, signals.others_time_s + delay_s
    pace = 1.0 + axis.formed("pace", {}, 0.0)
    ages = [
        dict(zip(("shown_s", "unseen_s", "late", "late_open"), each, strict=True))
        for each in signals.ages.tolist()
    ]
    taken_s = [
        t - axis.formed("lag", {"stamp_s": t - began_s, **known}, 0.0)
        for t, known in zip(signals.time_s.tolist(), ages, strict=True)
    ]
    time_s = taken_s[0]
    rows = signals.time_s.size
    found = {name: np.zeros(rows) for name in ("predicted", "weight", "cost")}
    last_reading = 0.0
    begun = 0
    for k in range(rows):
        edges = np.concatenate([commands, loads])
        edges = edges[(edges > time_s) & (edges < taken_s[k])]
        for stop in [*np.unique(edges).tolist(), taken_s[k]]:
            held = int(np.searchsorted(commands, time_s, side="right")) - 1
            pieces = max(1, math.ceil((stop - time_s) / job.step_s - 1e-9))
            for piece in range(pieces if stop > time_s else 0):
                piece_s = (stop - time_s) / pieces
                axis.step(
                    command=float(signals.command[held]) if held >= 0 else untold,
                    mode=int(signals.command_mode[max(held, 0)]),
                    supply_v=float(signals.command_supply_v[max(held, 0)]),
                    others=_others_at(signals, int(np.searchsorted(loads, time_s, side="right")) - 1),
                    elapsed_s=time_s + piece * piece_s - began_s,
                    step_s=piece_s / pace,
                    fading=math.exp(-piece_s / pace / job.disturbance_time_s),
                )
            time_s = max(time_s, stop)
        if job.start.at[k]:
            known = job.start.states[begun] if job.start.states.size else np.zeros(0)
            axis.restart(float(job.start.position[k]), float(job.start.speed[k]), known)
            begun += 1
            last_reading = float((job.start.speed if signals.is_speed else job.start.position)[k])
        predicted = found["predicted"][k] = axis.reading(is_speed=signals.is_speed)
        reading = float(signals.measured[k])
        if math.isnan(reading) or job.start.at[k]:
            continue
        std = float(job.observer.innovation_std[k])
        wider = axis.widened(std, ages[k]["unseen_s"], ages[k]["late_open"])
        weight, cost = axis.judge(reading, predicted, last_reading, wider)
        weight *= (std / wider) ** 2 if std > 0.0 else 1.0
        found["weight"][k], found["cost"][k] = weight, cost
        axis.correct(job.observer.gains[k] * weight * (reading - predicted))
        last_reading = reading
    return found


@final
class _Axis:
    """The state of one axis, stepped term by term."""

    def __init__(self, plant: Plant, home: float, session_s: float) -> None:
        self._plant = plant
        self._home, self._session_s = home, session_s
        self._base = {s.symbol: v for s, v in plant.values.items() if s.owner == BASE_OWNER}
        self._own: dict[str, _Scope] = defaultdict(dict)
        for slot, value in plant.values.items():
            self._own[slot.owner][slot.symbol] = value
        self._formed_by: dict[Stage, list[Call]] = {}
        self._states: dict[str, _Scope] = {e.id: dict.fromkeys(e.states, 0.0) for e in plant.effects}
        self._angle = self._speed = self._current = self._disturbance = 0.0

    def restart(self, angle: float, speed: float, known: FloatArray) -> None:
        """Start anew where the encoder shows this angle and speed, with the current and the states that are known."""
        self._current = self._disturbance = 0.0
        for effect in self._plant.effects:
            for state in effect.states:
                if state not in effect.lasting:
                    moves = speed if state in effect.moving else 0.0
                    self._states[effect.id][state] = angle if state in effect.placed else moves
        if known.size:
            self._current = float(known[0])
            named = ((e.id, state) for e in self._plant.layout.effects for state in e.states)
            for (owner, state), value in zip(named, known[1:].tolist(), strict=True):
                if owner in self._states:
                    self._states[owner][state] = value
        self._angle, self._speed = angle, speed
        for _ in range(SETTLING):
            shift, speed_shift = self._shifts()
            self._angle, self._speed = angle - shift, speed - speed_shift

    def reading(self, *, is_speed: bool) -> float:
        shift, speed_shift = self._shifts()
        return self._speed + speed_shift if is_speed else self._angle + shift

    def _shifts(self) -> tuple[float, float]:
        scope = {"angle": self._angle, "speed": self._speed}
        pairs = list(self._values("reading", scope))
        return sum(pair[0] for pair in pairs), sum(pair[1] for pair in pairs)

    def correct(self, change: FloatArray) -> None:
        self._angle += float(change[0])
        self._speed += float(change[1])
        self._disturbance += float(change[2])

    def widened(self, std: float, unseen_s: float, late_open: float) -> float:
        """The standard deviation of a reading with what its scatter adds."""
        scope = {"angle": self._angle, "speed": self._speed, "unseen_s": unseen_s, "late_open": late_open}
        scatter = self.formed("scatter", scope, 0.0)
        return math.sqrt(std * std + scatter) if std > 0.0 else std

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

    def formed(self, stage: Stage, scope: Mapping[str, float], start: float) -> float:
        """The sum of the active terms of `stage` and `start`."""
        return start + sum(float(value) for value in self._values(stage, scope))

    def chained(self, stage: Stage, scope: Mapping[str, float], name: str, start: float) -> float:
        """`start`, handed as `name` through each active term of `stage`."""
        value = start
        for call in self._calls(stage):
            value = float(self._value(call, {**scope, name: value}))
        return value

    def step(
        self,
        command: float,
        mode: int,
        supply_v: float,
        others: tuple[float, float],
        elapsed_s: float,
        step_s: float,
        fading: float,
    ) -> None:
        before = self._speed
        scope: _Scope = {"elapsed_s": elapsed_s, "speed": before, "current": self._current, "step_s": step_s}
        scope |= {"session_s": self._session_s, "mode": mode, "home": self._home}
        scope["others_a"], scope["others_s"] = self._drawn_by_others(supply_v, *others)
        scope |= {"held": command, "angle": self._angle}
        scope["goal"] = self.chained("goal", scope, "goal", command)
        control = self._plant.layout.base.control
        commanded = _call(control, {**self._base, **scope}) if control else scope["goal"]
        scope["duty"] = self.chained("duty", scope, "duty", commanded)
        inertia = scope["inertia"] = self.formed("inertia", scope, self._base["inertia"])
        drive: _Scope = {**self._base, **scope}
        drive["supply_v"] = self.chained("supply", scope, "supply_v", supply_v)
        resistance = self._base.get("resistance", 0.0)
        for call in self._calls("resistance"):
            resistance += float(self._value(call, {**scope, "resistance": resistance}))
        drive["resistance"] = scope["resistance"] = resistance
        drive["inductance"] = self.formed("inductance", scope, 0.0)
        drive["drop"] = self.formed("drop", scope, 0.0)
        drive["knee"] = self.formed("knee", scope, 0.0)
        drive["limit"] = self.chained("limit", scope, "limit", math.inf)
        force, coupling = _call(self._plant.layout.base.drive, drive)
        scope |= {"angle": self._angle + 0.5 * step_s * before, "drive_torque": force - coupling * before}
        damping = coupling + self.formed("damping", scope, 0.0)
        load = scope["load_torque"] = self.formed("torque", scope, 0.0)
        pull = force + load + inertia * self._disturbance
        free = ((2 * inertia / step_s - damping) * before + 2 * pull) / (2 * inertia / step_s + damping)
        direction = scope["direction"] = math.copysign(1.0, before if before != 0.0 else free)
        level = self.chained("friction", scope, "level", 0.0)
        level = self.chained("lean", scope, "level", level)
        scope["dry"] = level
        level = max(level - self.formed("borne", {**scope, "level": level}, 0.0), 0.0)
        for call in self._calls("hold"):
            grasp, grip = self._value(call, {**scope, "level": level})
            pull, damping, level = pull - grasp, damping + grip, 0.0
            free = ((2 * inertia / step_s - damping) * before + 2 * pull) / (2 * inertia / step_s + damping)
        bite = 2.0 * level / (2 * inertia / step_s + damping)
        after = _braked(before, free, direction, bite)
        after = self.chained("creep", {**scope, "free": free, "bite": bite}, "after", after)
        self._advance({**scope, "before": before, "after": after})
        settle = self._plant.layout.base.current_after
        if settle:
            ends = {"force": force, "coupling": coupling, "before": before, "after": after}
            self._current = _call(settle, {**drive, **ends})
        self._angle += 0.5 * step_s * (before + after)
        self._speed = after
        for call in self._calls("stop"):
            scope = {"angle": self._angle, "speed": self._speed, "home": self._home}
            self._angle, self._speed = self._value(call, scope)
        self._disturbance *= fading

    def _drawn_by_others(self, open_circuit_v: float, share: float, speed: float) -> tuple[float, float]:
        drawn = self._plant.layout.base.drawn_by_others
        now = {"open_circuit_v": open_circuit_v, "others_share": share, "others_speed": speed}
        return _call(drawn, {**self._base, **now}) if drawn else (0.0, 0.0)

    def _advance(self, scope: _Scope) -> None:
        for call in self._calls("advance"):
            values = self._value(call, scope)
            values = values if len(call.effect.states) > 1 else (values,)
            self._states[call.effect.id] = dict(zip(call.effect.states, values, strict=True))

    def _values(self, stage: Stage, scope: Mapping[str, float]) -> Iterator[Any]:
        return (self._value(call, scope) for call in self._calls(stage))

    def _calls(self, stage: Stage) -> list[Call]:
        if stage not in self._formed_by:
            active = self._plant.active
            self._formed_by[stage] = [c for c in calls(self._plant.layout, stage) if c.effect.id in active]
        return self._formed_by[stage]

    def _value(self, call: Call, scope: Mapping[str, float]) -> Any:  # as the term
        return call.term(*self._arguments(call.effect.id, call.arguments, scope))

    def _arguments(self, owner: str, names: tuple[str, ...], scope: Mapping[str, float]) -> list[float]:
        states, own = self._states.get(owner, {}), self._own[owner]
        return [
            own[name] if name in own else states[name] if name in states else scope[name] for name in names
        ]


def _others_at(signals: Signals, told: int) -> tuple[float, float]:
    """How the other motors load the supply since it was told for the nth time; not at all before the first."""
    if told < 0:
        return 0.0, 0.0
    share, speed = signals.others_load[told].tolist()
    return share, speed


def _braked(before: float, free: float, direction: float, bite: float) -> float:
    """The speed after a step whose dry friction takes `bite` of it; it may come to rest within, and turn back."""
    after = free - direction * bite
    if after * direction >= 0.0:
        return after
    push = direction * (before - free) - bite
    reached = direction * before / (push + 2.0 * bite) if push > 0.0 else 1.0
    return -direction * push * (1.0 - reached) if push > 0.0 else 0.0


def _call(function: Callable[..., Any], scope: Mapping[str, float]) -> Any:  # as the function
    return function(*(scope[name] for name in _named(function)))


@cache
def _named(function: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(inspect.signature(function).parameters)
