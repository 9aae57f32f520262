"""From a case to a diagnosis: re-fit, locate, explain, judge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import (
    Diagnosis,
    FalseAlarmRate,
    Fit,
    HeldOutRun,
    Horizon,
    Leftover,
    Tolerance,
    Verdict,
)
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.parted import FEWEST_PARTED
from nxt_twin.diagnose.fitting.problem import Problem, problem_of
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.inquiry import inquire
from nxt_twin.diagnose.judging.colour import COLOURED
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.judging.floors import refitted_floors
from nxt_twin.diagnose.judging.horizons import nearest_horizon
from nxt_twin.diagnose.judging.judge import overall, stale_readings
from nxt_twin.diagnose.judging.sight import in_sight
from nxt_twin.diagnose.judging.verdict import (
    LIMITS,
    Record,
    is_patchwork,
    is_stalled,
    is_unseen,
    leaves_little,
    verdict_of,
)
from nxt_twin.diagnose.next.next_step import next_experiment
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.telling import words
from nxt_twin.diagnose.telling.bounds import at_bounds
from nxt_twin.diagnose.telling.estimates import refitted, unmoved
from nxt_twin.diagnose.telling.far import furthest_off, moved_far, moved_notably, stays
from nxt_twin.diagnose.telling.findings import alternatives, found_effects, nearest_effect, too_weak
from nxt_twin.diagnose.telling.notes import notes, on_the_load, onsets_told
from nxt_twin.diagnose.telling.signs import lost_signs
from nxt_twin.diagnose.where.mismatch import mismatch_of
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.configs import load_plant_config

_FLOORS = 1  # random numbers of their own, so that no other figure depends on them


@final
@dataclass(frozen=True)
class MotorAnswer:
    """A diagnosis, the improved plant that belongs to it, and the numbers that the verdict on a motor rests on."""

    diagnosis: Diagnosis
    plant: Plant
    record: Record | None = None


def diagnose(
    case: Case,
    *,
    seed: int = 0,
    tolerance: float | None = None,
    without: frozenset[str] = frozenset(),
    leaning: Mapping[str, float] | None = None,
    progress: Progress = lambda _: None,
) -> MotorAnswer:
    """Say what physics `case`'s baseline leaves out, if any.

    Args:
        case: the baseline and its recordings.
        tolerance: error of a simulation that does not matter, SI (rad, m, or per second). None takes half a step of
            the encoder, or the roughness of its readings.
        seed: of the random shifts behind the regimes' p-values; nothing else is random.
        without: ids of effects that are not tried, to see what a diagnosis says of physics that it does not know.
        leaning: what speaks beforehand for effects, nats by id, as a live session has it. It ranks effects that gain
            nearly alike; what an effect has to gain stays as it is.
        progress: told in words what is being done.

    Raises:
        NxtTwinError: the case cannot be diagnosed; its text says why.
    """
    problem = replace(problem_for(case, tolerance), without=without, leaning=leaning or {})
    with Simulator(problem.plant.layout) as simulator:
        rng = np.random.default_rng(seed)
        evidence = inquire(simulator, problem, rng, progress)
        if is_unseen(evidence.record) and holds_others_out(case):
            progress("only what was held out errs: once more, with others held out")
            first = tuple(part.signals.name for part in problem.held_out)
            other = replace(problem_for(case, tolerance, second=True), instead_of=first)
            other = replace(other, without=problem.without, leaning=problem.leaning)
            turned = inquire(simulator, other, rng, progress)
            evidence = turned if verdict_of(turned.record) == "explained" else evidence
        return MotorAnswer(_diagnosis(simulator, evidence, seed, rng), evidence.written, evidence.record)


def fit_as_it_stands(case: Case) -> Structure:
    """Fit the parameters of the case's plant on everything that is not held out, looking for nothing else."""
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
        return fit_everything(Fitter(simulator, problem), problem.plant, noise)


def problem_for(case: Case, tolerance: float | None = None, *, second: bool = False) -> Problem:
    """Make a case ready, with a named plant looked up; `second` as `problem_of` has it."""
    config = load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant
    return problem_of(case.name, config, case.recordings, case.holdout, case.port, tolerance, second=second)


def holds_others_out(case: Case) -> bool:
    """Whether other recordings of `case` could be held out: it names none, and has three at least."""
    return not case.holdout and len(case.recordings) >= FEWEST_PARTED


def _diagnosis(simulator: Simulator, evidence: Evidence, seed: int, rng: Generator) -> Diagnosis:
    problem, units = evidence.problem, evidence.units
    verdict = verdict_of(evidence.record)
    effects = found_effects(simulator, evidence)
    fit = _fit(evidence, _floors(simulator, evidence, seed, complete=verdict != "unexplained"))
    sizes, excitation = in_sight(simulator, problem, evidence.linear)
    held_out = tuple(_held_out(evidence))
    refit = refitted(evidence)
    alarms = evidence.false_alarms
    load = on_the_load(refit)
    sentence = words.sentence(
        verdict,
        effects,
        fit,
        excitation,
        {one.id: one.name for one in sizes},
        patchwork=is_patchwork(evidence.record),
        instead=furthest_off(problem.plant, evidence.baseline.plant) if evidence.record.restores else "",
        loose=_is_loose(evidence),
    )
    doubtful = unmoved(refit)
    far = moved_far(problem.plant, evidence.final.plant, doubtful)
    small = (
        *at_bounds(problem, evidence.final.plant),
        *moved_notably(problem.plant, evidence.final.plant, doubtful),
        *words.loose(effects),
        *words.too_small([one.effect.name for one in evidence.needless]),
        *words.too_weak([effect.name for effect, _, _ in too_weak(evidence, verdict)]),
        *words.unnamed([one.name for one in evidence.explanation.unnamed]),
    )
    rest = _what_is_left(evidence, verdict)
    faults = (
        *_stood_still(evidence, verdict),
        *(lost_signs(problem.signals) if verdict == "unexplained" else ()),
    )
    sentence = " ".join([*far, sentence, *small, *load, *rest, *faults])
    return Diagnosis(
        name=problem.name,
        verdict=verdict,
        sentence=sentence,
        refit=refit,
        mismatch=mismatch_of(simulator, evidence, verdict, seed),
        effects=effects,
        alternatives=alternatives(simulator, evidence, verdict),
        fit=fit,
        next_experiment=next_experiment(simulator, evidence, verdict, excitation, fit, rng),
        notes=_notes(simulator, evidence, held_out, fit),
        held_out=held_out,
        leftover=_leftover(evidence),
        detectable=sizes,
        excitation=excitation,
        false_alarm_rate=FalseAlarmRate(alarms.rate, alarms.upper_95, alarms.of),
        nearest=nearest_effect(evidence, verdict),
        tolerance=Tolerance(evidence.problem.tolerance * units.reading_factor, units.reading, fit.improved),
    )


def _notes(
    simulator: Simulator, evidence: Evidence, held_out: tuple[HeldOutRun, ...], fit: Fit
) -> tuple[str, ...]:
    """Remarks on the recordings, the effects' onsets and the plants."""
    stale, by_chance = _stale(simulator, evidence), evidence.record.by_chance
    return (
        *notes(evidence.problem, evidence.final.plant, held_out, stale, fit, by_chance=by_chance),
        *onsets_told(evidence.onset_told),
        *_what_stays(evidence),
        *_what_is_written(evidence),
    )


def _is_loose(evidence: Evidence) -> bool:
    """Whether windows of two seconds err by much, mostly since the fitted readings leave parameters open."""
    window = nearest_horizon(evidence.final_errors, evidence.problem.window_s)
    open_more = evidence.doubts[window] > evidence.floors[window]
    return evidence.record.remaining > LIMITS.nearly and bool(open_more)


def _what_is_left(evidence: Evidence, verdict: Verdict) -> tuple[str, ...]:
    """A sentence on a remaining error that is significant and does not matter."""
    if verdict == "unexplained" or not leaves_little(evidence.record):
        return ()
    units = evidence.units
    return (words.below_tolerance(evidence.problem.tolerance * units.reading_factor, units.reading),)


def _stood_still(evidence: Evidence, verdict: Verdict) -> tuple[str, ...]:
    """A sentence on stalls where they leave names in doubt."""
    in_doubt = verdict == "unexplained" and is_stalled(evidence.record)
    return (words.stood_still(evidence.record.stalled_share),) if in_doubt else ()


def _what_stays(evidence: Evidence) -> tuple[str, ...]:
    """A remark where single steps ask for other numbers than the given ones, which simulate better.

    Effects that were found move the numbers anew: then nothing is said of the baseline's.
    """
    if evidence.problem.by_windows or evidence.explanation.found:
        return ()
    wanted = evidence.explanation.baseline.plant
    coloured = evidence.record.colour > COLOURED
    return stays(evidence.problem.plant, evidence.baseline.plant, wanted, coloured=coloured)


def _what_is_written(evidence: Evidence) -> tuple[str, ...]:
    """Remarks where the plant that is handed on is not the improved one, or not the best at each horizon."""
    beaten = words.beaten(evidence.beaten_at)
    if evidence.written is evidence.final.plant:
        return beaten
    which = "re-fitted baseline" if evidence.written is evidence.baseline.plant else "model as it was given"
    return (
        f"At some horizon the improved plant predicts unseen readings worse: the {which} is handed on.",
        *beaten,
    )


def _floors(simulator: Simulator, evidence: Evidence, seed: int, *, complete: bool) -> tuple[float, ...]:
    """What a correct model would reach at each horizon, SI."""
    reached = (evidence.given_errors, evidence.baseline_errors, evidence.final_errors)
    own = np.random.default_rng([seed, _FLOORS])
    problem, final, covariance = evidence.problem, evidence.final, evidence.covariance
    return refitted_floors(simulator, problem, final, covariance, reached, own, complete=complete)


def _fit(evidence: Evidence, floors: tuple[float, ...]) -> Fit:
    factor = evidence.units.reading_factor
    seconds = evidence.final_errors.seconds
    columns = (
        evidence.given_errors.rms,
        evidence.baseline_errors.rms,
        evidence.final_errors.rms,
        floors,
    )
    floor = floors[nearest_horizon(evidence.final_errors, evidence.problem.window_s)]
    return Fit(
        metric="free-run RMSE, held-out",
        unit=evidence.units.reading,
        baseline=overall(evidence.baseline_runs) * factor,
        improved=overall(evidence.final_runs) * factor,
        floor=floor * factor,
        horizons=tuple(
            Horizon(None if np.isinf(own) else own, *(float(value) * factor for value in row))
            for own, *row in zip(seconds, *columns, strict=True)
        ),
    )


def _held_out(evidence: Evidence) -> list[HeldOutRun]:
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


def _stale(simulator: Simulator, evidence: Evidence) -> dict[str, FloatArray]:
    """Times of late-stamped readings by recording, s since its beginning."""
    problem, final = evidence.problem, evidence.final
    every = {s.name: s for s in [*problem.signals, *(part.signals for part in problem.held_out)]}
    found = {}
    for name, signals in every.items():
        stale = stale_readings(simulator, signals, final.plant, final.noise)
        if stale.any():
            found[name] = (signals.time_s - signals.time_s[0])[stale]
    return found


def _leftover(evidence: Evidence) -> Leftover:
    units, before, after = evidence.units, evidence.before, evidence.after
    constant = evidence.final.plant.values.get(Slot(BASE_OWNER, "torque_constant"))
    linear = evidence.problem.plant.layout.frame == "linear"
    driven = "driving force (N)" if linear else "driving torque (N·m)"
    return Leftover(
        unit=units.torque,
        speed_unit=units.speed,
        position_unit=units.position,
        time_s=before.time_s,
        speed=before.speed,
        position=before.position * units.position_factor,
        before=before.unknown,
        after=after.unknown,
        drive=before.drive if constant is None else before.drive / constant,
        drive_label=driven if constant is None else "current (A)",
    )
