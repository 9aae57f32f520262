"""From a case to a diagnosis: re-fit, locate, explain, judge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.diagnose import words
from nxt_twin.diagnose.diagnosis import (
    Alternative,
    Confusion,
    Diagnosis,
    Equation,
    Estimate,
    Fit,
    FoundEffect,
    HeldOutRun,
    Leftover,
    Mismatch,
    Moved,
    NextExperiment,
    Verdict,
)
from nxt_twin.diagnose.explain import RIVAL_NATS, Explanation, explain, probability
from nxt_twin.diagnose.judge import FreeRun, free_runs, leftover_nats, noise_floor, overall, stale_readings
from nxt_twin.diagnose.locate import regimes, spells
from nxt_twin.diagnose.noise import first_guess
from nxt_twin.diagnose.problem import Problem, problem_of
from nxt_twin.diagnose.residuals import Residuals, residuals
from nxt_twin.diagnose.structure import Structure, Workshop
from nxt_twin.diagnose.units import Units, units_of
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import FloatArray

Progress = Callable[[str], None]

STRUCTURED_NATS = 15.0
STRUCTURED_TORQUE = 2e-3
LARGE_TORQUE = 3e-2
MOST_LEFT = 0.3
FAR_OFF = 4.0
"""When what is left is more than noise: a flexible function of the state foretells it by so many nats and it is at
least the second, or it is the third whatever foretells it; as fractions of a torque ordinary for the plant. Where
effects were found, it must also be the fourth of all that there was to explain. Where none was found, free runs
over readings that only check must not be the fifth times as far off as noise alone."""


@final
@dataclass(frozen=True)
class Answer:
    """A diagnosis, and the improved plant that belongs to it."""

    diagnosis: Diagnosis
    plant: Plant


@final
@dataclass(frozen=True)
class _Evidence:
    """Everything that a diagnosis is put together from."""

    problem: Problem
    units: Units
    explanation: Explanation
    baseline: Structure
    final: Structure
    before: Residuals
    after: Residuals
    baseline_runs: list[FreeRun]
    final_runs: list[FreeRun]


def diagnose(case: Case, *, seed: int = 0, progress: Progress = lambda _: None) -> Answer:
    """Say what physics `case`'s baseline leaves out, if any.

    Args:
        case: the baseline and its recordings.
        seed: of the random shifts behind the regimes' p-values; nothing else is random.
        progress: told in words what is being done.

    Raises:
        NxtTwinError: the case cannot be diagnosed; its text says why.
    """
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        progress("re-fitting the baseline")
        workshop = Workshop(simulator, problem)
        noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
        baseline = workshop.settle(workshop.fit(problem.plant, noise))
        explanation = explain(workshop, baseline, progress)
        progress("fitting on every reading that is not held out")
        final = workshop.fit_everything(explanation.best.plant, explanation.best.noise)
        refit = _best_baseline(workshop, baseline, final) if explanation.found else final
        progress("judging on what was held out")
        evidence = _Evidence(
            problem=problem,
            units=units_of(problem.plant.layout.frame, problem.signals[0]),
            explanation=explanation,
            baseline=refit,
            final=final,
            before=residuals(simulator, refit.plant, problem.everything(), final.noise),
            after=residuals(simulator, final.plant, problem.everything(), final.noise),
            baseline_runs=free_runs(simulator, problem, refit.plant, final.plant, final.noise),
            final_runs=free_runs(simulator, problem, final.plant, final.plant, final.noise),
        )
        return Answer(_diagnosis(simulator, evidence, seed), final.plant)


def _best_baseline(workshop: Workshop, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline at its best in free run, so that what was found is not held against a straw man.

    The likeliest noise of a model that lacks much can swallow so much that its parameters mean nothing; under
    the noise of the improved plant they have to carry the motion.
    """
    own = workshop.fit_everything(baseline.plant, baseline.noise)
    sober = workshop.fit_on_everything(workshop.problem.plant, final.noise)
    return min(own, sober, key=lambda structure: structure.free_run_rms[0])


def fit_as_it_stands(case: Case) -> Structure:
    """Fit the parameters of the case's plant on everything that is not held out, looking for nothing else."""
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        workshop = Workshop(simulator, problem)
        noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
        return workshop.fit_everything(problem.plant, noise)


def problem_for(case: Case) -> Problem:
    """Make a case ready, with a named plant looked up."""
    config = load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant
    return problem_of(case.name, config, case.recordings, case.holdout, case.port)


def _diagnosis(simulator: Simulator, evidence: _Evidence, seed: int) -> Diagnosis:
    problem, units = evidence.problem, evidence.units
    verdict = _verdict(evidence)
    effects = tuple(_found_effects(evidence))
    fit = Fit(
        metric="free-run RMSE, held-out",
        unit=units.reading,
        baseline=overall(evidence.baseline_runs) * units.reading_factor,
        improved=overall(evidence.final_runs) * units.reading_factor,
        floor=noise_floor(problem, evidence.final.noise) * units.reading_factor,
    )
    mismatch = _mismatch(evidence, verdict, seed)
    held_out = tuple(_held_out(evidence))
    return Diagnosis(
        name=problem.name,
        verdict=verdict,
        sentence=words.sentence(verdict, effects, fit),
        refit=_refit(evidence),
        mismatch=mismatch,
        effects=effects,
        alternatives=_alternatives(simulator, evidence),
        fit=fit,
        next_experiment=_next_experiment(evidence, verdict),
        notes=words.notes(problem, evidence.final.plant, held_out, _stale(simulator, evidence)),
        held_out=held_out,
        leftover=_leftover(evidence),
    )


def _verdict(evidence: _Evidence) -> Verdict:
    """Adequate, explained or unexplained, by what is left beside what was found."""
    left = leftover_nats(evidence.after)
    before, after = (_torque_share(evidence.problem, s) for s in (evidence.baseline, evidence.final))
    structured = left > STRUCTURED_NATS and after > STRUCTURED_TORQUE
    large = after > LARGE_TORQUE
    if not evidence.explanation.found:
        floor = noise_floor(evidence.problem, evidence.final.noise)
        runs_away = evidence.final.free_run_rms[0] > FAR_OFF * floor
        return "unexplained" if structured or large or runs_away else "adequate"
    gained = evidence.baseline.fitted.cost - evidence.final.fitted.cost
    mostly_left = structured and left > MOST_LEFT * (left + gained)
    return "unexplained" if mostly_left or (large and after > 0.5 * before) else "explained"


def _torque_share(problem: Problem, structure: Structure) -> float:
    """The unknown torque that a structure leaves, as a fraction of one that is ordinary for the plant."""
    inertia = structure.plant.values[Slot(BASE_OWNER, "inertia")]
    return structure.noise.disturbance_std * inertia / problem.scale.torque


def _mismatch(evidence: _Evidence, verdict: Verdict, seed: int) -> Mismatch:
    names = [signals.name for signals in evidence.problem.signals]
    channel = evidence.problem.signals[0].channel
    if verdict == "adequate":
        return Mismatch(channel, (), (), None)
    found = evidence.explanation.found
    nearest = [effect for effect, _ in (found or evidence.explanation.refused)]
    equation: Equation = nearest[0].equation_of if nearest else "torque_balance"
    return Mismatch(channel, spells(evidence.before, names), regimes(evidence.before, seed), equation)


def _found_effects(evidence: _Evidence) -> list[FoundEffect]:
    plant, stds = evidence.final.plant, _stds(evidence.final)
    listed = []
    for effect, _ in evidence.explanation.found:
        params = {}
        for slot, parameter in plant.layout.parameters.items():
            if slot.owner == effect.id:
                value, std = plant.values[slot] / parameter.si, stds.get(slot, 0.0) / parameter.si
                params[parameter.name] = Estimate(value, std, parameter.unit)
        rivals = evidence.explanation.rivals.get(effect.id, ())
        near = [rival for rival in rivals if rival.behind < RIVAL_NATS]
        listed.append(
            FoundEffect(
                id=effect.id,
                name=effect.name,
                equation=effect.equation,
                params=params,
                probability=probability(0.0, [rival.behind for rival in rivals]),
                confusable_with=tuple(
                    Confusion(rival.effect.id, words.why_confusable(effect, rival.effect, rival.behind))
                    for rival in near
                ),
            )
        )
    return listed


def _alternatives(simulator: Simulator, evidence: _Evidence) -> tuple[Alternative, ...]:
    """The structures with one effect exchanged that came nearest, with their own error on what is held out."""
    rivals = [rival for near in evidence.explanation.rivals.values() for rival in near]
    listed = []
    for rival in sorted(rivals, key=lambda rival: rival.behind)[:3]:
        plant = rival.structure.plant
        runs = free_runs(simulator, evidence.problem, plant, evidence.final.plant, evidence.final.noise)
        behind = [0.0, *(other.behind for other in rivals if other is not rival)]
        rmse = overall(runs) * evidence.units.reading_factor
        listed.append(Alternative(rival.effect.id, probability(rival.behind, behind), rmse))
    return tuple(listed)


def _refit(evidence: _Evidence) -> dict[str, Moved]:
    given, plant, stds = evidence.problem.plant, evidence.final.plant, _stds(evidence.final)
    return {
        parameter.name: Moved(
            given.values[slot] / parameter.si,
            plant.values[slot] / parameter.si,
            stds[slot] / parameter.si,
            parameter.unit,
        )
        for slot, parameter in plant.layout.parameters.items()
        if slot in given.values and slot in plant.values and slot in stds
    }


def _stds(structure: Structure) -> dict[Slot, float]:
    """Standard deviations, SI: from the fit's covariance, and for the share of a fault from counting."""
    shares = {
        Slot(effect.id, effect.parameters[0].symbol)
        for effect in structure.plant.effects
        if "outlier" in effect.terms
    }
    counted = {slot: structure.plant.values[slot] for slot in shares}
    readings = max(structure.fitted.readings, 1)
    stds = np.sqrt(np.maximum(np.diag(structure.fitted.covariance), 0.0))
    return {
        **{slot: float(np.sqrt(share * (1.0 - share) / readings)) for slot, share in counted.items()},
        **{
            slot: float(std) * ratio
            for variable, std in zip(structure.fitted.variables, stds, strict=True)
            for slot, ratio in zip(variable.slots, variable.ratios, strict=True)
        },
    }


def _held_out(evidence: _Evidence) -> list[HeldOutRun]:
    units = evidence.units
    listed = []
    for before, after in zip(evidence.baseline_runs, evidence.final_runs, strict=True):
        signals = before.held_out.signals
        shown = before.held_out.counted
        factor = units.reading_factor
        listed.append(
            HeldOutRun(
                recording=signals.name,
                time_s=(signals.time_s - signals.time_s[0])[shown],
                command=signals.command_at_samples()[shown] * units.command_factor,
                command_label=units.command,
                measured=signals.measured[shown] * factor,
                baseline=before.predicted[shown] * factor,
                improved=after.predicted[shown] * factor,
                stale=after.stale[shown].astype(np.float64),
                baseline_rmse=before.rms * factor,
                improved_rmse=after.rms * factor,
            )
        )
    return listed


def _stale(simulator: Simulator, evidence: _Evidence) -> dict[str, FloatArray]:
    """Times of late-stamped readings by recording, s since its beginning."""
    problem, final = evidence.problem, evidence.final
    every = {s.name: s for s in [*problem.signals, *(part.signals for part in problem.held_out)]}
    found = {}
    for name, signals in every.items():
        stale = stale_readings(simulator, signals, final.plant, final.noise)
        if stale.any():
            found[name] = (signals.time_s - signals.time_s[0])[stale]
    return found


def _leftover(evidence: _Evidence) -> Leftover:
    units, before, after = evidence.units, evidence.before, evidence.after
    return Leftover(
        unit=units.torque,
        speed_unit=units.speed,
        position_unit=units.position,
        time_s=before.time_s,
        speed=before.speed,
        position=before.position * units.position_factor,
        before=before.unknown,
        after=after.unknown,
    )


def _next_experiment(evidence: _Evidence, verdict: Verdict) -> NextExperiment | None:
    for effect, _ in evidence.explanation.found:
        for rival in evidence.explanation.rivals.get(effect.id, ()):
            if rival.behind < RIVAL_NATS:
                return words.experiment_between(effect, rival.effect)
    return words.experiment_for_unknown() if verdict == "unexplained" else None
