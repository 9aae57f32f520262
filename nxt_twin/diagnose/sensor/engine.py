"""From a sensor case to a diagnosis: re-fit the ideal sensor, locate, explain, judge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, final

import numpy as np

from nxt_twin.diagnose.diagnosis import (
    Alternative,
    Confusion,
    Diagnosis,
    Estimate,
    Fit,
    FoundEffect,
    HeldOutRun,
    Mismatch,
    Moved,
    NextExperiment,
    Verdict,
)
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.rivals import share_of_belief
from nxt_twin.diagnose.sensor import words
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.explain import RIVAL_NATS, SensorExplanation, explain
from nxt_twin.diagnose.sensor.judge import held_out_runs, noise_floor, overall
from nxt_twin.diagnose.sensor.leftover import Left, regimes_of, spells_of, what_is_left
from nxt_twin.diagnose.sensor.light_problem import LightProblem
from nxt_twin.diagnose.sensor.problem import SensorProblem, standard_errors
from nxt_twin.diagnose.sensor.runs import KINDS, channel_of, runs_of, truth_column, unit_of
from nxt_twin.diagnose.sensor.structure import SensorFitter, SensorStructure
from nxt_twin.diagnose.sensor.touch_problem import TouchProblem
from nxt_twin.diagnose.sensor.ultrasonic_problem import UltrasonicProblem
from nxt_twin.errors import DiagnosisError
from nxt_twin.recording.case import Case
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.sensors.light import LightParameters
from nxt_twin.sensors.touch import TouchParameters
from nxt_twin.sensors.ultrasonic import UltrasonicParameters

STRUCTURED_NATS = 10.0  # least gain of bins along a covariate
STRUCTURED_SIZE = 0.15  # standard deviations of the noise, at least
MOST_LEFT = 0.3  # share of the nats of residual and effects together
LARGE_SIZE = 0.5  # standard deviations of the noise above which the residual is large
MOST_LEFT_IF_LARGE = 0.1  # share of the nats of residual and effects together
BY_CHANCE = 1e-5
"""When what is left is more than noise: bins along something predict it by so many nats, it is so large beside the
noise, and chance would do it so rarely. Where effects were found and it goes with what some effect acts along, it must
also be that part of all there was, or, if it is as large as half the noise, the lesser part."""

_PARAMETERS: Mapping[str, type[UltrasonicParameters] | type[LightParameters] | type[TouchParameters]] = {
    "ultrasonic_sensor": UltrasonicParameters,
    "light_sensor": LightParameters,
    "touch_sensor": TouchParameters,
}


@final
@dataclass(frozen=True)
class SensorModel:
    """The improved sensor, as the keys of a YAML file."""

    config: Mapping[str, Any]

    def to_config(self) -> dict[str, Any]:
        """The keys, as a plant gives its own."""
        return dict(self.config)


@final
@dataclass(frozen=True)
class SensorAnswer:
    """A diagnosis, and the improved sensor that belongs to it."""

    diagnosis: Diagnosis
    model: SensorModel


@final
@dataclass(frozen=True)
class _SensorEvidence:
    """Everything that a sensor's diagnosis is put together from."""

    case: Case
    kind: str
    fitter: SensorFitter
    ideal: SensorStructure
    final: SensorStructure
    explanation: SensorExplanation
    left: tuple[Left, ...]
    runs: tuple[HeldOutRun, ...]
    ignored: tuple[str, ...]
    seed: int


def is_sensor_case(case: Case) -> bool:
    """Whether a case is about a sensor (docs/formats.md#sensor-cases)."""
    return (isinstance(case.plant, dict) and case.plant.get("kind") in KINDS) or _named_kind(case) in KINDS


def diagnose_sensor(case: Case, *, seed: int = 0, progress: Progress = lambda _: None) -> SensorAnswer:
    """Say what `case`'s ideal sensor leaves out, if anything.

    Args:
        case: a case about a sensor.
        seed: of the tie-breaking within whole readings; nothing else is random.
        progress: told in words what is being done.

    Raises:
        DiagnosisError: the readings or their truth are missing or too few.
        SensorError: the baseline is no sensor.
    """
    problem, ignored = problem_of(case)
    fitter = SensorFitter(problem, seed)
    progress("re-fitting the ideal sensor")
    ideal = fitter.baseline()
    explanation = explain(fitter, ideal, progress)
    progress("judging on what was held out")
    ideal, final = fitter.on_everything(ideal), explanation.best
    evidence = _SensorEvidence(
        case=case,
        kind=sensor_kind(case),
        fitter=fitter,
        ideal=ideal,
        final=final,
        explanation=explanation,
        left=tuple(what_is_left(problem, _known(fitter, final))),
        runs=held_out_runs(fitter, ideal, final),
        ignored=ignored,
        seed=seed,
    )
    return SensorAnswer(_diagnosis(evidence), SensorModel(problem.to_config(final.values, final.ids)))


def problem_of(case: Case) -> tuple[SensorProblem, tuple[str, ...]]:
    """A sensor case made ready, and the keys of its baseline that this tool does not know.

    Raises:
        DiagnosisError: it is no sensor case, or has not what it needs.
    """
    kind = sensor_kind(case)
    config = load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant
    known = {field.name for field in fields(_PARAMETERS[kind])} | {"kind", "effects"}
    given = _PARAMETERS[kind].from_config({key: value for key, value in config.items() if key in known})
    ignored = tuple(sorted(str(key) for key in set(config) - known))
    runs, channel = runs_of(case, kind), channel_of(case, kind)
    match given:
        case UltrasonicParameters():
            return UltrasonicProblem(runs, channel, given), ignored
        case LightParameters():
            return LightProblem(runs, channel, given), ignored
        case TouchParameters():
            return TouchProblem(runs, channel, given, truth_column(case, kind)), ignored


def sensor_kind(case: Case) -> str:
    """What kind of sensor a case is about.

    Raises:
        DiagnosisError: it is no sensor case.
    """
    kind = case.plant.get("kind") if isinstance(case.plant, dict) else _named_kind(case)
    if kind not in KINDS:
        mend = f"its plant needs a kind: {', '.join(KINDS)}"
        raise DiagnosisError("is no sensor case", where=case.name, mend=mend)
    return str(kind)


def _named_kind(case: Case) -> object:
    return load_plant_config(case.plant).get("kind") if isinstance(case.plant, str) else None


def _known(fitter: SensorFitter, structure: SensorStructure) -> Any:  # noqa: ANN401  # float array
    """The residuals of everything that is not held out; NaN elsewhere."""
    return np.where(fitter.split.known, fitter.scores(structure.values), np.nan)


def _diagnosis(evidence: _SensorEvidence) -> Diagnosis:
    problem = evidence.fitter.problem
    verdict = _verdict(evidence)
    effects = tuple(_found_effects(evidence))
    fit = Fit(
        metric="RMSE of the expected reading, held-out",
        unit=problem.unit,
        baseline=overall(evidence.runs, lambda run: run.baseline),
        improved=overall(evidence.runs, lambda run: run.improved),
        floor=noise_floor(evidence.fitter, evidence.final, evidence.seed),
    )
    structured = [left for left in evidence.left if _is_structured(left)]
    learns = any(run.held_out for run in problem.runs) and any("@" in name for name in evidence.final.names)
    said = words.notes(effects, structured[0] if structured else None, evidence.final.independent, learns)
    if evidence.ignored:
        said = (
            *said,
            f"Keys of the baseline that no sensor has are passed over: {', '.join(evidence.ignored)}.",
        )
    return Diagnosis(
        name=evidence.case.name,
        verdict=verdict,
        sentence=words.sentence(verdict, effects, fit),
        refit=_refit(evidence),
        mismatch=_mismatch(evidence, verdict),
        effects=effects,
        alternatives=_alternatives(evidence),
        fit=fit,
        next_experiment=_next_experiment(evidence, verdict),
        notes=said,
        held_out=evidence.runs,
        leftover=None,
    )


def _verdict(evidence: _SensorEvidence) -> Verdict:
    """Adequate, explained or unexplained, by what is left beside what was found."""
    structured = [left for left in evidence.left if _is_structured(left)]
    if not evidence.final.active:
        return "unexplained" if structured else "adequate"
    if not structured:
        return "explained"
    most = max(structured, key=lambda left: left.nats)
    if most.along.removeprefix("spread of ") in evidence.fitter.problem.untouched:
        return "unexplained"
    allowed = MOST_LEFT_IF_LARGE if most.size > LARGE_SIZE else MOST_LEFT
    return "unexplained" if most.nats > allowed * (most.nats + _gained(evidence)) else "explained"


def _gained(evidence: _SensorEvidence) -> float:
    """What the effects together gain, nats."""
    each = [evidence.fitter.problem.log_each(s.values) for s in (evidence.final, evidence.ideal)]
    return float(np.sum((each[0] - each[1])[evidence.fitter.split.known]))


def _is_structured(left: Left) -> bool:
    return left.nats > STRUCTURED_NATS and left.size > STRUCTURED_SIZE and left.p_value < BY_CHANCE


def _found_effects(evidence: _SensorEvidence) -> list[FoundEffect]:
    final = evidence.final
    found = []
    for effect in final.active:
        rivals = evidence.explanation.rivals[effect.id]
        behind = [*(rival.behind for rival in rivals), evidence.explanation.gained[effect.id]]
        found.append(
            FoundEffect(
                id=effect.id,
                name=effect.name,
                equation=effect.equation,
                params=_estimates(evidence.fitter, effect, final),
                probability=share_of_belief(0.0, behind),
                confusable_with=tuple(
                    Confusion(rival.effect.id, words.why_confusable(effect, rival.effect, rival.behind))
                    for rival in rivals
                    if rival.behind < RIVAL_NATS
                ),
            )
        )
    return found


def _estimates(fitter: SensorFitter, effect: SensorEffect, final: SensorStructure) -> dict[str, Estimate]:
    """The effect's parameters; where several laws would do, their mean, with the laws' disagreement in the doubt."""
    if effect.stepped:
        walked, covariance = fitter.wandered(final)
        return fitter.problem.estimates(effect, walked, final.names, covariance)
    structures = [fitter.under_law(final, law) for law in effect.laws] or [(final, 0.0)]
    most = max(nats for _, nats in structures)
    weights = np.exp(np.array([nats - most for _, nats in structures]))
    weights /= weights.sum()
    each = [
        fitter.problem.estimates(effect, structure.values, structure.names, fitter.covariance(structure))
        for structure, _ in structures
    ]
    averaged = {}
    for name, first in each[0].items():
        values, stds = (np.array([getattr(one[name], key) for one in each]) for key in ("value", "std"))
        mean = float(weights @ values)
        std = float(np.sqrt(weights @ (stds**2 + (values - mean) ** 2)))
        averaged[name] = Estimate(mean, std, first.unit)
    return averaged


def _refit(evidence: _SensorEvidence) -> dict[str, Moved]:
    """The ideal sensor's own parameters, from where they were given to where the final fit has them."""
    final, fitter = evidence.final, evidence.fitter
    stds = standard_errors(final.names, fitter.covariance(final))
    start = fitter.problem.base_start()
    given = _given(evidence.case)
    return {
        part.name: Moved(
            float(given.get(part.name, start[part.name])),
            final.values[part.name],
            stds[part.name],
            unit_of(part.name),
        )
        for part in fitter.problem.base()
        if part.name in stds
    }


def _given(case: Case) -> Mapping[str, Any]:
    return load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant


def _mismatch(evidence: _SensorEvidence, verdict: Verdict) -> Mismatch:
    """When and in which regime the re-fitted ideal sensor fails, measured by the noise of the improved one."""
    problem = evidence.fitter.problem
    if verdict == "adequate":
        return Mismatch(problem.channel, (), (), None)
    noise = {name: value for name, value in evidence.final.values.items() if "noise" in name}
    scores = evidence.fitter.scores({**evidence.ideal.values, **noise, **_off_noise(problem)})
    return Mismatch(problem.channel, spells_of(problem, scores), regimes_of(problem, scores), "measurement")


def _off_noise(problem: SensorProblem) -> dict[str, float]:
    """The values that switch off effects which are noise themselves."""
    fields_off = [problem.off(effect) for effect in problem.effects]
    return {name: value for off in fields_off for name, value in off.items() if "noise" in name}


def _alternatives(evidence: _SensorEvidence) -> tuple[Alternative, ...]:
    """What came nearest in the place of each effect, with its own error on what is held out."""
    rivals = [rival for near in evidence.explanation.rivals.values() for rival in near]
    listed = []
    for rival in sorted(rivals, key=lambda rival: rival.behind)[:3]:
        runs = held_out_runs(evidence.fitter, evidence.ideal, evidence.fitter.on_everything(rival.structure))
        behind = [0.0, *(other.behind for other in rivals if other is not rival)]
        error = overall(runs, lambda run: run.improved)
        listed.append(Alternative(rival.effect.id, share_of_belief(rival.behind, behind), error))
    return tuple(listed)


def _next_experiment(evidence: _SensorEvidence, verdict: Verdict) -> NextExperiment | None:
    for effect in evidence.final.active:
        for rival in evidence.explanation.rivals[effect.id]:
            if rival.behind < RIVAL_NATS:
                return words.experiment_between(effect, rival.effect, evidence.kind)
    if verdict == "unexplained":
        return words.experiment_for_unknown(evidence.kind, evidence.left[0])
    return None
