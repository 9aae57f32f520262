"""What these recordings could have shown, and what their inputs never do."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from nxt_twin.diagnose.diagnosis import DetectableSize, Excitation
from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.judging.detectable import Detectable, detectable
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.modes import MODE_DRIVE
from nxt_twin.physics.simulate import Simulator
from nxt_twin.physics.smooth import smoothed

_ORDINARY_TIMES = 2.0  # times a typical size: an effect that shows only beyond it counts as unseen
_MOVING_SHARE = 0.1  # of the plant's ordinary speed, or of the largest command: less is next to none
_RARE = 0.01  # of the samples: a motion that is rarer is missing
_FEW_COMMANDS = 6  # changes of the command in all recordings: fewer are few
_FEW_READINGS = 400  # readings in all recordings: fewer are few
_SAME_SPEED = 0.1  # of the median speed: speeds within that distance of it count as one steady speed
_MOSTLY = 0.8  # of the moving samples: with more at one speed, there is hardly another
_POOR_SHARE = 0.25  # of the effects that could be added: with more unseen, the inputs show too little


def in_sight(
    simulator: Simulator, problem: Problem, linear: Linear
) -> tuple[tuple[DetectableSize, ...], Excitation]:
    """The smallest size of each effect that would have been seen, and whether the inputs could show enough."""
    found = detectable(simulator, problem, linear)
    unseen = tuple(one.effect.id for one in found if not _ordinary_would_show(one, problem))
    lacking = missing_motions(problem) if unseen else ()
    enough = not unseen or (not lacking and len(unseen) <= _POOR_SHARE * len(found))
    return tuple(_as_size(one, problem) for one in found), Excitation(enough, lacking, unseen)


def _ordinary_would_show(one: Detectable, problem: Problem) -> bool:
    """Whether an ordinary size would be seen; one that has no name yet leaves nothing to see."""
    if max(abs(start) for start in one.effect.parameters[0].starts) < one.effect.notable:
        return True
    if one.size is None:
        return False
    main = one.effect.parameters[0].in_frame(problem.plant.layout.frame).scaled(problem.scale)
    sizes = [abs(start) * main.si for start in main.starts]
    if one.seen_above:
        return one.size <= _ORDINARY_TIMES * max(sizes)
    return one.size >= min(sizes) / _ORDINARY_TIMES


def _as_size(one: Detectable, problem: Problem) -> DetectableSize:
    layout = problem.plant.layout
    names = [layout.parameters[Slot(one.effect.id, p.symbol)] for p in one.effect.parameters[:2]]
    main = names[0]
    name = f"{main.name} − {names[1].name}" if one.difference else main.name
    size = None if one.size is None else one.size / main.si
    return DetectableSize(one.effect.id, one.effect.name, name, size, main.unit, one.seen_above)


def missing_motions(problem: Problem) -> tuple[str, ...]:
    """Motions that the inputs of these recordings never cause, in words."""
    speed = np.concatenate([smoothed(s)[1] for s in problem.signals])
    command = np.concatenate([s.command_at_samples() for s in problem.signals])
    moving = speed[np.abs(speed) > _MOVING_SHARE * problem.scale.speed]
    said = []
    if moving.size and min(np.mean(moving > 0.0), np.mean(moving < 0.0)) < _RARE:
        said.append("it never turns the other way")
    if moving.size and _is_one_speed(np.abs(moving)):
        said.append("it runs at hardly more than one steady speed")
    changes = sum(int(np.count_nonzero(np.diff(s.command))) for s in problem.signals)
    if changes < _FEW_COMMANDS:
        said.append(_few_changes(changes))
    small = np.abs(command) < _MOVING_SHARE * max(float(np.max(np.abs(command))), 1e-12)
    if np.mean(small) < _RARE:
        said.append("its command never rests near zero")
    said += _small_reach(problem)
    readings = sum(int(np.isfinite(s.measured).sum()) for s in problem.signals)
    if readings < _FEW_READINGS:
        said.append(f"there are only {readings} readings")
    first = problem.signals[0]
    if first.input_kind == "power_pct" and all(np.all(s.command_mode == MODE_DRIVE) for s in problem.signals):
        said.append("it never runs out without current")
    return tuple(said)


def _few_changes(count: int) -> str:
    if count > 1:
        return f"its command changes only {count} times"
    return "its command changes once" if count else "its command never changes"


def _is_one_speed(speeds: Sequence[float] | np.ndarray) -> bool:
    usual = float(np.median(speeds))
    return bool(np.mean(np.abs(np.asarray(speeds) - usual) < _SAME_SPEED * usual) > _MOSTLY)


def _small_reach(problem: Problem) -> list[str]:
    if problem.plant.layout.frame == "linear" or problem.signals[0].is_speed:
        return []
    reach = max(float(np.nanmax(s.measured) - np.nanmin(s.measured)) for s in problem.signals)
    return ["it turns by less than one turn"] if reach < 2.0 * math.pi else []
