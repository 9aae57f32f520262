"""What may have changed: each parameter, natural groups of them, each effect of the library; and what each promises."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter, design_of
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.fitting.held import are_held
from nxt_twin.diagnose.fitting.losses import SOFT
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.search.trials import addable_effects as lacking
from nxt_twin.physics.effects.magnetic import COMMUTATION_RIPPLE
from nxt_twin.physics.effects.timing import SAMPLE_HOLD
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import Scale

_GROUPS = (("gravity", "inertia"), ("gravity", "phase", "inertia"), ("coulomb", "viscous"))
_HUNG = "gravity_load"
PLAINER: Final = {
    "angle_dependent_friction": "coulomb",
    "asymmetric_friction": "coulomb",
    "asymmetric_viscous_friction": "viscous",
    "friction_warmup": "coulomb",
    "load_dependent_friction": "coulomb",
    "quadratic_drag": "viscous",
    "sample_hold": "command_delay",
    "stale_samples": "command_delay",
}
"""What says nearly as much as a law with less: a parameter's symbol, or an effect's id."""

_FROM_A_MOMENT_ON = frozenset({"payload_inertia", "hanging_payload"})
MOST_CYCLES = 40
"""A turn of the hub: what a search tries at most where nothing else explains the side after."""

_LARGEST_SIGNATURE = 1e3  # in errors of the fit, either way; a run that blew up is no better than that
_LARGEST_STRETCH = 10.0  # prior standard deviation of the factor that stretches an effect's signature


@final
@dataclass(frozen=True)
class ChangeCandidate:
    """One way in which the side after may differ.

    Attributes:
        slots: indices of the model's ways in which it differs.
        effect: id of an effect that acts after, if any.
        start: its starting values, SI by symbol.
    """

    slots: tuple[int, ...]
    effect: str | None = None
    start: tuple[tuple[str, float], ...] = ()

    def put(self, model: Model, scale: Scale) -> Model:
        """`model` with it."""
        wider = model.differing(self.slots)
        return wider if self.effect is None else wider.with_effect(self.effect, dict(self.start), scale)


def candidates_for(fitter: JointFitter, model: Model, scale: Scale) -> list[ChangeCandidate]:
    """What `model` does not yet let differ; an effect once for each of its starts."""
    index = {variable.slots[0].symbol: n for n, variable in enumerate(model.shared)}
    groups = [tuple(index[symbol] for symbol in group) for group in _GROUPS if set(group) <= index.keys()]
    free = {*model.may_differ}
    found: list[tuple[int, ...]] = [(n,) for n in model.may_differ]
    found += [group for group in groups if set(group) & free and set(group) <= {*model.differs, *free}]
    every = [ChangeCandidate(tuple(sorted(each))) for each in found]
    for new in new_effects(fitter, model, scale):
        every.append(new)
        if new.effect == _HUNG and index["inertia"] not in model.differs:
            every.append(ChangeCandidate((index["inertia"],), new.effect, new.start))
    return every


def new_effects(fitter: JointFitter, model: Model, scale: Scale) -> list[ChangeCandidate]:
    """Each effect that `model` does not have, once for each of its starts.

    Over windows, readings that are held and a late command move alike: only where readings repeat can they be held.
    """
    held = are_held([job.signals for job in fitter.sides[-1].jobs])
    ruled_out = set() if held else {SAMPLE_HOLD.id}
    return [
        ChangeCandidate((), effect.id, tuple(start.items()))
        for effect in lacking(model.after, fitter.sides[-1].jobs[0].signals)
        if effect.id not in {*_FROM_A_MOMENT_ON, *ruled_out} and "outlier" not in effect.terms
        for start in starts_of(effect, scale)
    ]


def rhythms(fitter: JointFitter, model: Model, scale: Scale) -> list[ChangeCandidate]:
    """Commutation ripple that `model` does not have, once for each whole number of cycles a turn.

    A rhythm that is a tenth off promises nothing, so that the starts of the library miss those between them.
    """
    every = [each for each in new_effects(fitter, model, scale) if each.effect == COMMUTATION_RIPPLE.id]
    symbol = COMMUTATION_RIPPLE.parameters[1].symbol
    starts = [
        {**dict(each.start), symbol: float(cycles)} for each in every for cycles in range(2, MOST_CYCLES + 1)
    ]
    found = dict.fromkeys(tuple(start.items()) for start in starts)
    return [ChangeCandidate((), COMMUTATION_RIPPLE.id, start) for start in found]


def promising(
    fitter: JointFitter, joint: JointFit, every: Sequence[ChangeCandidate], scale: Scale, most: int
) -> list[ChangeCandidate]:
    """The candidates that promise most beside `joint`, best first; of an effect's starts the best alone."""
    promised = sorted(promises(fitter, joint, every, scale), key=lambda item: -item[0])
    best: dict[tuple[tuple[int, ...], str | None], ChangeCandidate] = {}
    for gain, each in promised:
        if gain > 0.0:
            best.setdefault((each.slots, each.effect), each)
    return list(best.values())[:most]


def plainer(fitter: JointFitter, bare: JointFit, effect_id: str, scale: Scale) -> list[ChangeCandidate]:
    """What may say with less what the effect says that was taken out of `bare`.

    A promise is a straight line's: of friction that has tripled it misleads, and a law may come first.
    """
    wanted, ways = PLAINER.get(effect_id), bare.model.ways
    every = [
        each
        for each in candidates_for(fitter, bare.model, scale)
        if wanted in (each.effect, *(ways[n].slot.symbol for n in each.slots if len(each.slots) == 1))
    ]
    return promising(fitter, bare, every, scale, 1) or every[:1]


def promises(
    fitter: JointFitter, joint: JointFit, every: Sequence[ChangeCandidate], scale: Scale
) -> list[tuple[float, ChangeCandidate]]:
    """What each candidate seems to gain on the last side beyond its penalty, nats, before any is fitted."""
    view = _View(fitter, joint)
    penalty = 0.5 * float(np.log(max(fitter.worth(), 2.0)))
    models = [each.put(joint.model, scale) for each in every]
    signatures = view.signatures(
        [model if each.effect else None for model, each in zip(models, every, strict=True)]
    )
    return [
        (
            view.gain(each.slots, signature)
            - penalty * (len(each.slots) + len(model.added) * bool(each.effect)),
            each,
        )
        for each, model, signature in zip(every, models, signatures, strict=True)
    ]


@final
class _View:
    """What the last side looks like from a fitted model: residuals and slopes there."""

    def __init__(self, fitter: JointFitter, joint: JointFit) -> None:
        self._fitter, self._joint = fitter, joint
        model, x = joint.model, joint.x
        slopes = fitter.slopes(model, x, joint.error, "fitted")
        self._hessian, self._gradient = fitter.normal_equations(model, x, slopes, "fitted")
        self._residual = slopes.residual[-1]
        self._weight = fitter.sides[-1].weight("fitted") / np.sqrt(1.0 + (self._residual / SOFT) ** 2)
        self._design = design_of(model, slopes.slope[-1], after=len(fitter.sides) > 1)
        self._slope = slopes.slope[-1][: len(model.shared)]
        self._base = _quadratic(self._hessian, self._gradient)

    def signatures(self, models: Sequence[Model | None]) -> list[FloatArray | None]:
        """How the effects of each model at their starts move the readings of the last side, in errors."""
        fitter, joint = self._fitter, self._joint
        side = fitter.sides[-1]
        base = joint.model.plant_at(joint.x, after=True)
        plants = [model.after.with_values(_common(joint)) for model in models if model]
        if not plants:
            return [None] * len(models)
        vectors = [plant.vectors() for plant in [base, *plants]]
        values, active = (np.array(part) for part in zip(*vectors, strict=True))
        jobs = [only for (only,) in side.with_states(fitter.simulator, values[:1], active[:1])]
        results = fitter.simulator.run(values, active, jobs)
        masks = side.masks("fitted")
        found = np.concatenate([r.predicted[:, m] for r, m in zip(results, masks, strict=True)], axis=1)
        moved = np.nan_to_num((found[1:] - found[0]) / joint.error)
        left = iter(np.clip(moved, -_LARGEST_SIGNATURE, _LARGEST_SIGNATURE))
        return [next(left) if model else None for model in models]

    def gain(self, slots: Sequence[int], signature: FloatArray | None) -> float:
        """What letting these differ promises, nats, after all that the model moves already has been moved."""
        new = [n for n in slots if n not in self._joint.model.differs]
        ways = [self._joint.model.ways[n] for n in new]
        rows = [way.of(self._slope) for way in ways]
        tight = [way.spread**-2.0 for way in ways]
        if signature is not None:
            rows, tight = [*rows, signature], [*tight, _LARGEST_STRETCH**-2.0]
        extra = np.array(rows)
        corner = (extra * self._weight) @ extra.T + np.diag(tight)
        side = (self._design * self._weight) @ extra.T
        gradient = -extra @ (self._weight * self._residual)
        hessian = np.block([[self._hessian, side], [side.T, corner]])
        whole = np.concatenate([self._gradient, gradient])
        if signature is not None:
            stretch = -np.linalg.lstsq(hessian, whole, rcond=1e-12)[0][-1]
            if stretch <= 0.0:
                return 0.0
        return _quadratic(hessian, whole) - self._base


def _common(joint: JointFit) -> dict[Slot, float]:
    """What the fit moved, as far as an effect does not replace it."""
    model = joint.model
    plant = model.plant_at(joint.x, after=True)
    return {slot: plant.values[slot] for v in model.shared for slot in v.slots if slot in plant.values}


def _quadratic(hessian: FloatArray, gradient: FloatArray) -> float:
    """The fall to the lowest point of a paraboloid."""
    step = np.linalg.lstsq(hessian, gradient, rcond=1e-12)[0]
    return 0.5 * float(gradient @ step)
