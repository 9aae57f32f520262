"""Gains of the true changes on a pair: the measure of whether a search could find them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any, final

import numpy as np

from nxt_twin.blind.aims import DETECTABLE_NATS
from nxt_twin.blind.pairs.touches import TOUCHES, MotorTouch
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.blind.whole import write_whole
from nxt_twin.diagnose.changed.engine import ReadyPair, ready_pairs
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.place import HERE, Place
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case, read_case


@final
@dataclass(frozen=True)
class PairReach:
    """The true changes, fitted from their true sizes.

    Attributes:
        gain_nats: of each change beside the others, on the readings that are fitted (BIC), by the touch's id.
        check_nats: that gain on the readings that only check.
        shared_rms: errors of one plant on both sides, before and after, in windows that only check, SI.
        true_rms: errors of the true structure there, SI.
        tolerance: error that does not matter, SI.
    """

    gain_nats: Mapping[str, float]
    check_nats: Mapping[str, float]
    shared_rms: tuple[float, ...]
    true_rms: tuple[float, ...]
    tolerance: float

    @property
    def is_detectable(self) -> bool:
        """Whether the recordings show every change at all."""
        matters = max(self.shared_rms) > self.tolerance
        return matters and all(gain > DETECTABLE_NATS for gain in self.gain_nats.values())


def reach_pair(case: Case, changes: Sequence[Mapping[str, Any]]) -> PairReach:
    """Fit the true structure of a pair, and what remains of it without each of its changes.

    Args:
        case: of a pair.
        changes: as the sealed answer has them.

    Raises:
        NxtTwinError: the sides cannot be compared; its text says why.
    """
    before = replace(case, name="before", recordings=case.before, holdout=(), before=())
    (pair,) = ready_pairs(before, [case])
    with Simulator(pair.model.plant.layout) as simulator:
        fitter = JointFitter(simulator, pair.windows.sides, pair.tolerance)
        alone = JointFitter(simulator, pair.windows.sides[:1], pair.tolerance)
        first = alone.fit(pair.model, pair.model.start())
        shared = fitter.fit(pair.model, first.x)
        true = _fitted(fitter, pair, shared, changes)
        penalty = 0.5 * float(np.log(max(fitter.worth(), 2.0)))
        gains, checks = {}, {}
        for change in changes:
            rest = [other for other in changes if other is not change]
            less = _fitted(fitter, pair, shared, rest)
            name = str(change["id"])
            gains[name] = less.cost - true.cost - penalty * (true.model.size - less.model.size)
            checks[name] = less.check_cost - true.check_cost
    return PairReach(gains, checks, shared.check_rms, true.check_rms, pair.tolerance)


def _fitted(
    fitter: JointFitter, pair: ReadyPair, shared: JointFit, changes: Sequence[Mapping[str, Any]]
) -> JointFit:
    """The likeliest fit of these changes, from their true sizes; numbers that no answer tells start anywhere."""
    starts = list(product(*(_starts(pair, change) for change in changes)))
    fits = []
    for own in starts:
        model, moved = pair.model, dict[int, float]()
        for touch, factors, effect in own:
            moved |= factors
            if effect is not None and touch.effect is not None:
                model = model.with_effect(touch.effect, effect, pair.problems[0].scale)
        model = model.differing(tuple(moved))
        x = model.moved_from(shared.model, shared.x)
        count = len(model.shared)
        for place, n in enumerate(model.differs, start=count):
            x[place] = moved[n]
        fits.append((model, x))
    return min((fitter.fit(model, x) for model, x in fits), key=lambda fit: fit.cost)


Start = tuple[MotorTouch, dict[int, float], dict[str, float] | None]


def _starts(pair: ReadyPair, change: Mapping[str, Any]) -> list[Start]:
    """Where a true change may begin: parameters by their true factor, an effect by its true numbers."""
    touch, model = TOUCHES[str(change["id"])], pair.model
    factors = dict.fromkeys(_ways(model, touch.companions), 0.0)
    if change["factor"] is not None:
        factors |= {n: float(np.log(change["factor"])) for n in _ways(model, touch.names)}
        return [(touch, factors, None)]
    effect = model.plant.layout.effect(str(touch.effect))
    known = {
        parameter.symbol: change["params"][parameter.name] * parameter.si
        for parameter in effect.parameters
        if parameter.name in change["params"]
    }
    distinct = {
        tuple(sorted(start.items())): start
        for start in ({**one, **known} for one in starts_of(effect, pair.problems[0].scale))
    }
    return [(touch, factors, start) for start in distinct.values()]


def _ways(model: Model, names: frozenset[str]) -> list[int]:
    """The ways of a model to differ in parameters of these names."""
    parameters = model.plant.layout.parameters
    return [n for n, way in enumerate(model.ways) if parameters[way.slot].name in names]


def reach_pairs(
    folders: Sequence[Path], answers: Path, out: Path, *, place: Place = HERE
) -> Iterator[NameAndFailure]:
    """Write the gains of the true changes of each pair into `out`; what is there is passed over."""
    out.mkdir(parents=True, exist_ok=True)
    tasks = [(folder, answers / f"{folder.name}.json", out / f"{folder.name}.json") for folder in folders]
    waiting = [task for task in tasks if not task[2].exists()]
    yield from spread((CaseTask(task[0].name, _reach, task) for task in waiting), place)


def _reach(folder: Path, answer: Path, target: Path) -> NameAndFailure:
    try:
        found = reach_pair(read_case(folder), read_sealed(answer, folder)["changes"])
    except NxtTwinError as error:
        return folder.name, str(error)
    write_whole(target, json.dumps(asdict(found)))
    return folder.name, ""


def read_reach(file: Path) -> PairReach | None:
    """Read the gains of the true changes of a pair; None where nobody wrote them."""
    if not file.exists():
        return None
    held = json.loads(file.read_text(encoding="utf-8"))
    return PairReach(**{**held, "shared_rms": tuple(held["shared_rms"]), "true_rms": tuple(held["true_rms"])})
