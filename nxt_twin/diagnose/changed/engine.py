"""From recordings made before and after to what has changed: fit each side, then both, and choose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.changed.choose import Chooser, Chosen
from nxt_twin.diagnose.changed.drift import with_drift
from nxt_twin.diagnose.changed.held_out import Predicted, predicted_after
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model, all_shared
from nxt_twin.diagnose.changed.null import alarm_nats, lacking_nats
from nxt_twin.diagnose.changed.play import CLOSE_WINDOW_S
from nxt_twin.diagnose.changed.sides import Side, every_signal, side_of, supply_unread, window_for
from nxt_twin.diagnose.changed.weighing import CLOSE_NATS, Weighing
from nxt_twin.diagnose.fitting.noise import first_noise, reading_floor
from nxt_twin.diagnose.fitting.problem import Problem, problem_of
from nxt_twin.diagnose.progress import Progress
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.effects.timing import COMMAND_DELAY
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.configs import load_plant_config

LIMIT_NATS = 5.0
"""What a change has to gain beyond its penalty where no repeats tell how far one state varies."""

ERRS_MORE_AFTER = 1.5
"""Times the error before: what one model of both sides does not predict after, though no reading is rougher.

The roughness of readings is no wish of a person's: within it, a stiction that gained 80 nats and a sag that gained 98
were not searched for on seeds 871 and 873. Of 185 unchanged pairs of seeds 870 and 872 within it, 20 err by more."""

_SAFETY = 1.5  # times what repeats seem to differ: they are few
_INEXACT = 2.0  # times what an effect helps before: another load asks more of what the model lacks


@final
@dataclass(frozen=True)
class Windows:
    """Both sides in windows of `length_s`, s, in which all is decided, and in close ones, which show play."""

    sides: tuple[Side, Side]
    close: tuple[Side, Side]
    length_s: float


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
        drifted: with the chosen changes, and with friction that differs as from run to run where that is likelier.
        net_of_free: what everything different gains beyond `drifted` and its penalty, nats.
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
    drifted: JointFit
    net_of_free: float
    tolerance: float
    limit_nats: float
    calibrated: bool
    window_s: float


@final
@dataclass(frozen=True)
class ReadyPair:
    """Two sides made ready to be compared.

    Attributes:
        problems: of the sides before and after.
        windows: both sides in windows of simulation.
        model: all that they may share, and the ways in which they may differ.
        is_wished: whether a person gave the tolerance; otherwise it is how rough readings are.
    """

    problems: tuple[Problem, Problem]
    windows: Windows
    model: Model
    is_wished: bool = False

    @property
    def tolerance(self) -> float:
        """Error of a simulation that does not matter, SI."""
        return max(problem.tolerance for problem in self.problems)

    @property
    def as_read(self) -> float:
        """The least error that readings can have, SI."""
        least = reading_floor([*self.problems[0].signals, *self.problems[1].signals])
        return min(self.tolerance, least) if least > 0.0 else self.tolerance

    def is_predicted(self, shared: JointFit) -> bool:
        """Whether one plant predicts both sides within the tolerance, so that nothing which matters has changed."""
        before, after = shared.check_rms
        as_well = self.is_wished or after <= ERRS_MORE_AFTER * before
        return self.is_within(shared) and as_well

    def is_within(self, shared: JointFit) -> bool:
        """Whether the errors of both sides are within the tolerance, however unequal they are."""
        return max(shared.check_rms) <= self.tolerance


def ready_pairs(before: Case, afters: Sequence[Case], tolerance: float | None = None) -> list[ReadyPair]:
    """Make `before` and each of `afters` ready, under the plant of the former.

    Raises:
        NxtTwinError: a side cannot be compared; its text says why.
    """
    config = load_plant_config(before.plant) if isinstance(before.plant, str) else before.plant
    cases = (before, *afters)
    problems = [
        problem_of(each.name, config, each.recordings, each.holdout, each.port, tolerance) for each in cases
    ]
    _refuse_other_input(problems)
    window_s = min(window_for(every_signal(problem)) for problem in problems)
    sides, close = (
        [_side(case, problem, length) for case, problem in zip(cases, problems, strict=True)]
        for length in (window_s, min(window_s, CLOSE_WINDOW_S))
    )
    return [
        ReadyPair(
            (problems[0], problems[n]),
            Windows((sides[0], sides[n]), (close[0], close[n]), window_s),
            all_shared(
                problems[0].plant,
                problems[0].scale,
                supply_unread=supply_unread(before) or supply_unread(case),
            ),
            tolerance is not None,
        )
        for n, case in enumerate(afters, start=1)
    ]


def compare(
    before: Case, afters: Sequence[Case], tolerance: float | None = None, progress: Progress = lambda _: None
) -> list[Compared]:
    """Say for each side after what differs from the side before, under the plant of the latter.

    Raises:
        NxtTwinError: a side cannot be compared; its text says why.
    """
    found = []
    for each in ready_pairs(before, afters, tolerance):
        progress(f"comparing {each.problems[1].name} with {before.name}")
        with Simulator(each.model.plant.layout) as simulator:
            found.append(_at_both_lengths(simulator, each, progress))
    return found


def _at_both_lengths(
    simulator: Simulator,
    pair: ReadyPair,
    progress: Progress,
) -> Compared:
    """By long windows; where they show no change, by close ones, which show a slight change of a parameter.

    Over a second, what the model leaves out adds up until it hides friction that is some percent higher.
    """
    windows = pair.windows
    found = _compared(simulator, pair, LIMIT_NATS, progress)
    predicted = pair.is_predicted(found.shared)
    if found.chosen.joint.model.changes or predicted or windows.length_s <= CLOSE_WINDOW_S:
        return found
    progress("looking closer")
    near = Windows(windows.close, windows.close, CLOSE_WINDOW_S)
    closer = _compared(simulator, replace(pair, windows=near), CLOSE_NATS, progress)
    return closer if is_seen_closer(closer.chosen.joint.model) else found


def is_seen_closer(model: Model) -> bool:
    """Whether all that differs is what close windows show better: slight parameters of load and friction, a delay."""
    return model.changes > 0 and {*model.effects} <= {COMMAND_DELAY.id} and not model.motor_constants


def _side(case: Case, problem: Problem, window_s: float) -> Side:
    checking = frozenset(recording.name for recording in case.holdout)
    signals = [one.of_any_age() for one in every_signal(problem)]  # so that a period has a size on both sides
    noise = first_noise(problem.plant, signals, problem.scale.torque)
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


def _penalty(fitter: JointFitter) -> float:
    """Of one number, nats: by the Bayesian information criterion."""
    return 0.5 * math.log(max(fitter.worth(), 2.0))


def _compared(simulator: Simulator, pair: ReadyPair, least_nats: float, progress: Progress) -> Compared:
    before, after = pair.problems
    model, windows, tolerance = pair.model, pair.windows, pair.tolerance
    sides = windows.sides
    fitter, close = (JointFitter(simulator, each, tolerance, pair.as_read) for each in (sides, windows.close))
    progress("fitting the side before")
    alone = JointFitter(simulator, sides[:1], tolerance, pair.as_read)
    first = alone.fit(model, model.start())
    every = model.differing(range(len(model.shared)))
    progress("fitting both sides")
    free = fitter.fit(every, every.moved_from(model, first.x))
    shared = fitter.fit(model, first.x)
    alarm = alarm_nats(alone, first)
    limit = max(least_nats, _SAFETY * (alarm or 0.0))
    inexact = max(0.0, _INEXACT * lacking_nats(alone, first, before.scale) - limit)
    weighing = Weighing(_penalty(fitter), limit, inexact, before.scale, pair.is_within(shared))
    chooser = Chooser(fitter, close, weighing, free, first)
    chosen = Chosen(shared, {}, ()) if pair.is_predicted(shared) else chooser.chosen(shared, progress)
    progress("fitting every reading")
    best = chosen.joint
    last = fitter.fit(best.model, best.x, "everything")
    wider = best.model.differing(range(len(best.model.shared)))
    free = fitter.fit(wider, wider.moved_from(best.model, best.x)) if best.model.size > model.size else free
    drifted = with_drift(fitter, best)
    return Compared(
        before,
        after,
        shared,
        free,
        replace(chosen, joint=replace(last, check_rms=best.check_rms, check_cost=best.check_cost)),
        predicted_after(fitter, best),
        fitter.covariance(last),
        drifted,
        weighing.net(drifted, free),
        tolerance,
        limit,
        alarm is not None,
        windows.length_s,
    )
