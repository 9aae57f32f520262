"""Make, solve and score concealed robots over a range of seeds."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, final

import numpy as np

from nxt_twin.blind.robot.world import ROBOT_EFFECTS, ROBOT_SURPRISES, RobotWorld, make_world
from nxt_twin.blind.share import Share
from nxt_twin.blind.whole import write_whole
from nxt_twin.diagnose.robot.engine import diagnose_robot
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.place import HERE, Place
from nxt_twin.recording.case import Case

RobotCaseKind = Literal["single", "pair", "clean", "unknown"]

_BOUNDS: Final = {"exact": 0.85, "clean wrong": 0.03, "unknown misnamed": 0.15}


@final
@dataclass(frozen=True)
class RobotPlan:
    """One case to make: its kind, what it conceals, its seed."""

    kind: RobotCaseKind
    effects: tuple[str, ...]
    seed: int


@final
@dataclass(frozen=True)
class RobotOutcome:
    """The answer of a diagnosis to one case, and whether the truth lies in its intervals.

    Attributes:
        plan: the case.
        verdict: as given.
        named: ids of the effects that were named.
        inside: of each named parameter whose truth is known, whether its 95 % interval holds it.
    """

    plan: RobotPlan
    verdict: str
    named: tuple[str, ...]
    inside: tuple[bool, ...]

    @property
    def exact(self) -> bool:
        """The right verdict with exactly the right names; an unknown effect has to be refused."""
        if self.plan.kind == "unknown":
            return self.verdict == "unexplained"
        wanted = "explained" if self.plan.effects else "adequate"
        return self.verdict == wanted and set(self.named) == set(self.plan.effects)


def plan_robots(
    first_seed: int, *, singles: int, pairs: int, clean: int, unknown: int
) -> tuple[RobotPlan, ...]:
    """Cases whose seeds count up from `first_seed`: effects in turn, pairs drawn, surprises in turn."""
    rng = np.random.default_rng(first_seed)
    known, strange = tuple(ROBOT_EFFECTS), tuple(ROBOT_SURPRISES)
    contents: list[tuple[RobotCaseKind, tuple[str, ...]]] = [
        ("single", (known[n % len(known)],)) for n in range(singles)
    ]
    for _ in range(pairs):
        one, other = sorted(rng.choice(len(known), 2, replace=False))
        contents.append(("pair", (known[one], known[other])))
    contents += [("clean", ())] * clean
    contents += [("unknown", (strange[n % len(strange)],)) for n in range(unknown)]
    order = rng.permutation(len(contents))
    return tuple(
        RobotPlan(contents[place][0], contents[place][1], first_seed + number)
        for number, place in enumerate(order)
    )


def solve_robots(plans: Sequence[RobotPlan], folder: Path, place: Place = HERE) -> Iterator[RobotOutcome]:
    """Make and diagnose each case, in the order in which they end; what `folder` holds already is not done again.

    Raises:
        NxtTwinError: a case cannot be diagnosed; those that have been are kept.
    """
    folder.mkdir(parents=True, exist_ok=True)
    # Workers of a cluster have folders of their own to start from.
    tasks = [(plan, folder.resolve()) for plan in plans]
    with closing(each(_solved, tasks, place)) as outcomes:  # type: ignore[type-var]
        for outcome in outcomes:
            if outcome.result is None:
                why = outcome.failure.text if outcome.failure else "no answer"
                raise NxtTwinError(why, where=f"robot-{outcome.task[0].seed}")
            yield outcome.result


def _solved(task: tuple[RobotPlan, Path]) -> RobotOutcome:
    plan, folder = task
    # A seed conceals something else in a range of other counts, whose answer may stand in the folder.
    target = folder / f"robot-{plan.seed}-{'+'.join(plan.effects) or 'clean'}.json"
    world = make_world(plan.effects, plan.seed)
    if not target.exists():
        write_whole(target, to_json(diagnose_robot(case_of_world(world, plan.seed)).diagnosis))
    return _outcome(plan, world, json.loads(target.read_text(encoding="utf-8")))


def case_of_world(world: RobotWorld, seed: int) -> Case:
    """The case of a world that a solver may see."""
    fitted = len(world.content["recordings"])
    runs = world.recordings
    return Case(f"robot-{seed}", Path(), world.content["plant"], runs[:fitted], runs[fitted:], None)


def _outcome(plan: RobotPlan, world: RobotWorld, said: dict[str, Any]) -> RobotOutcome:
    inside = []
    for effect in said["effects"]:
        truth = world.effects.get(_key(effect), {})
        for name, value in truth.items():
            if name in effect["params"]:
                low, high = effect["params"][name]["interval_95"]
                inside.append(bool(low <= value <= high))
    named = tuple(map(_key, said["effects"]))
    return RobotOutcome(plan, said["verdict"], named, tuple(inside))


def _key(effect: dict[str, Any]) -> str:
    """An effect's id, behind the side of the motor that has it."""
    motor = effect.get("motor")
    return f"{motor}_motor.{effect['id']}" if motor else str(effect["id"])


def robots_as_text(outcomes: Sequence[RobotOutcome]) -> str:
    """The table, the aims, and each case that is not exact."""
    lines = [f"{'cases':24} exact"]
    for kind in ("single", "pair", "clean", "unknown"):
        some = [one for one in outcomes if one.plan.kind == kind]
        if some:
            lines.append(f"{kind:24} {Share(sum(one.exact for one in some), len(some))}")
    for effect in ROBOT_EFFECTS:
        some = [one for one in outcomes if one.plan.effects == (effect,)]
        if some:
            lines.append(f"  {effect:31} {Share(sum(one.exact for one in some), len(some))}")
    lines.append("")
    lines += [
        f"{name:24} {value:.3f}  {'≥' if name == 'exact' else '≤'} {_BOUNDS[name]:.2f}  {'met' if met else 'MISSED'}"
        for name, value, met in _aims(outcomes)
    ]
    inside = [held for one in outcomes if one.exact for held in one.inside]
    if inside:
        lines.append(f"parameters within their 95 % interval: {Share(sum(inside), len(inside))}")
    for one in outcomes:
        if not one.exact:
            hidden, named = (", ".join(ids) or "nothing" for ids in (one.plan.effects, one.named))
            lines.append(f"seed {one.plan.seed}, {hidden}: {one.verdict}, {named}")
    return "\n".join(lines)


def _aims(outcomes: Sequence[RobotOutcome]) -> list[tuple[str, float, bool]]:
    """The shares of known effects that are exact, of clean cases that are wrong, of unknown ones that are explained."""
    hidden = [one.exact for one in outcomes if one.plan.kind in ("single", "pair")]
    clean = [not one.exact for one in outcomes if one.plan.kind == "clean"]
    unknown = [one.verdict == "explained" for one in outcomes if one.plan.kind == "unknown"]
    shares = {"exact": hidden, "clean wrong": clean, "unknown misnamed": unknown}
    found = []
    for name, held in shares.items():
        if held:
            share = sum(held) / len(held)
            found.append((name, share, share >= _BOUNDS[name] if name == "exact" else share <= _BOUNDS[name]))
    return found
