"""From recordings made before and after to what has changed: fit each side, then both, and choose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.changed.choose import Chooser, Chosen
from nxt_twin.diagnose.changed.held_out import Predicted, predicted_after
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model, all_shared
from nxt_twin.diagnose.changed.null import alarm_nats, lacking_nats
from nxt_twin.diagnose.changed.sides import Side, every_signal, side_of, supply_unread, window_for
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.problem import Problem, problem_of
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.configs import load_plant_config

LIMIT_NATS = 5.0
"""What a change has to gain beyond its penalty where no repeats tell how far one state varies."""

_SAFETY = 1.5  # times what repeats seem to differ: they are few
_INEXACT = 2.0  # times what an effect helps before: another load asks more of what the model lacks

Progress = Callable[[str], None]


@final
@dataclass(frozen=True)
class Compared:
    """All that was found out about a side after.

    Attributes:
        after: that side's problem.
        shared: one plant on both sides.
        free: everything different.
        chosen: the few differences that earned their place, fitted on every reading.
        predicted: readings after that were not fitted, by the plant before and with the changes.
        covariance: of the chosen model's numbers, inside.
        net_of_free: what everything different gains beyond the chosen changes and its penalty, nats.
        tolerance: error of a simulation that does not matter, SI.
        limit_nats: what a change had to gain.
        calibrated: whether repeats told that limit.
        window_s: length of the windows of simulation.
    """

    before: Problem
    after: Problem
    shared: JointFit
    free: JointFit
    chosen: Chosen
    predicted: Predicted
    covariance: FloatArray
    net_of_free: float
    tolerance: float
    limit_nats: float
    calibrated: bool
    window_s: float


def compare(
    before: Case, afters: Sequence[Case], tolerance: float | None = None, progress: Progress = lambda _: None
) -> list[Compared]:
    """Say for each side after what differs from the side before, under the plant of the latter.

    Raises:
        NxtTwinError: a side cannot be compared; its text says why.
    """
    config = load_plant_config(before.plant) if isinstance(before.plant, str) else before.plant
    problems = [
        problem_of(each.name, config, each.recordings, each.holdout, each.port, tolerance)
        for each in (before, *afters)
    ]
    _refuse_other_input(problems)
    window_s = min(window_for(every_signal(problem)) for problem in problems)
    sides = [
        _side(case, problem, window_s) for case, problem in zip((before, *afters), problems, strict=True)
    ]
    model = all_shared(problems[0].plant, problems[0].scale)
    unread = all_shared(problems[0].plant, problems[0].scale, supply_unread=True)
    with Simulator(problems[0].plant.layout) as simulator:
        found = []
        for case, problem, side in zip(afters, problems[1:], sides[1:], strict=True):
            progress(f"comparing {side.name} with {sides[0].name}")
            own = unread if supply_unread(before) or supply_unread(case) else model
            found.append(
                _compared(simulator, own, (problems[0], problem), (sides[0], side), progress, window_s)
            )
        return found


def _side(case: Case, problem: Problem, window_s: float) -> Side:
    checking = frozenset(recording.name for recording in case.holdout)
    signals = every_signal(problem)
    noise = first_guess(problem.plant, signals, problem.scale.torque)
    return side_of(case.name, signals, checking, window_s, noise)


def _refuse_other_input(problems: Sequence[Problem]) -> None:
    first = problems[0].signals[0]
    for problem in problems[1:]:
        kind = problem.signals[0].input_kind
        if kind != first.input_kind:
            raise DiagnosisError(
                f"is driven by {kind}, and {problems[0].name} by {first.input_kind}",
                where=problem.name,
                mend="compare recordings that are driven alike",
            )


def _compared(
    simulator: Simulator,
    model: Model,
    problems: tuple[Problem, Problem],
    sides: tuple[Side, Side],
    progress: Progress,
    window_s: float,
) -> Compared:
    before, after = problems
    tolerance = max(before.tolerance, after.tolerance)
    fitter = JointFitter(simulator, sides, tolerance)
    progress("fitting the side before")
    alone = JointFitter(simulator, sides[:1], tolerance)
    first = alone.fit(model, model.start())
    every = model.differing(range(len(model.shared)))
    progress("fitting both sides")
    free = fitter.fit(every, every.moved_from(model, first.x))
    shared = fitter.fit(model, first.x)
    alarms = [alarm_nats(alone, first), _of_after(simulator, sides[1], free, tolerance)]
    known = [each for each in alarms if each is not None]
    limit = max([LIMIT_NATS, *(_SAFETY * each for each in known)])
    inexact = max(0.0, _INEXACT * lacking_nats(alone, first, before.scale) - limit)
    chooser = Chooser(fitter, before.scale, limit, inexact)
    chosen = chooser.chosen(shared, progress)
    progress("fitting every reading")
    best = chosen.joint
    last = fitter.fit(best.model, best.x, "everything")
    wider = best.model.differing(range(len(best.model.shared)))
    free = fitter.fit(wider, wider.moved_from(best.model, best.x)) if best.model.size > model.size else free
    return Compared(
        before,
        after,
        shared,
        free,
        replace(chosen, joint=replace(last, check_rms=best.check_rms, check_cost=best.check_cost)),
        predicted_after(fitter, best),
        fitter.covariance(last),
        chooser.weighing.net(best, free),
        tolerance,
        limit,
        bool(known),
        window_s,
    )


def _of_after(simulator: Simulator, side: Side, free: JointFit, tolerance: float) -> float | None:
    """The alarms among the repeats of the side after, at what it is by itself."""
    count = len(free.model.shared)
    own = replace(free, model=_bare(free.model), x=np.asarray(free.x[:count] + free.x[count:]))
    return alarm_nats(JointFitter(simulator, (side,), tolerance), own)


def _bare(model: Model) -> Model:
    return replace(model, differs=())
