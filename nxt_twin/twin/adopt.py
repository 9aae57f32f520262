"""From a divergence to a better model, while the session goes on: diagnose what was seen, take over what is found."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar, final

from nxt_twin.diagnose.diagnosis import Diagnosis, Moved
from nxt_twin.diagnose.engine import MotorAnswer, diagnose
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.effects.electrical import BATTERY_SAG
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.recording.program import MotorProgram
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.gain import Gain, gain
from nxt_twin.twin.records import Event

T = TypeVar("T")

ENOUGH_S = 12.0
CHECKS_S = (15.0, 25.0, 37.0, 60.0)
"""After so much of a model without a divergence it is diagnosed all the same: what grows slowly shows late.

Only until an effect is adopted: what a second one explains is too often the error of the first one's numbers.
"""
_TRIES = 4
_FEW = 2
_NOT_DONE = 4.0
"""Tolerances of a simulation up to which a diagnosis that finds nothing has found all: else it is asked again, as far
more readings may tell it what is missing."""
_WORTHWHILE = 0.7
_SURE = 0.8
_TIE_NATS = 3.0
_BATTERY = "internal_resistance_ohm"


@final
@dataclass(frozen=True)
class Finished:
    """What came of a diagnosis.

    Attributes:
        port: of the motor.
        began_s: when its recording began, from which effects count that change with time.
        seconds: how long that was.
        answer: what to take over; None where there is nothing.
        why_not: why there is nothing.
        gain: what its plant gains over the model in use; None where there is no answer.
        weak_battery: the probability that the battery gives way notably more than was taken for granted.
        experiment: what to run, so that the next diagnosis can tell more; None where nothing is to be run.
        unasked: whether the motor was not off its model when the diagnosis began.
        anew: whether a model was diagnosed that lacks what was adopted before, so that the answer takes its place.
    """

    port: Port
    began_s: float
    seconds: float
    answer: MotorAnswer | None
    why_not: str
    gain: Gain | None = None
    weak_battery: float = 0.0
    experiment: MotorProgram | None = None
    unasked: bool = False
    anew: bool = False


@final
@dataclass(frozen=True)
class _Running:
    """A diagnosis that is under way; fields as of `Finished`, and of what it was given."""

    port: Port
    began_s: float
    seconds: float
    leaning: Mapping[str, float]
    unasked: bool
    anew: bool
    future: Future[tuple[MotorAnswer, Gain]]


@final
class AtOnce(Executor):
    """Does what it is given at once, in the caller's thread: for tests, and wherever time is virtual."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:  # noqa: ANN401
        """Do it, and give what came of it."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except (
            Exception
        ) as error:  # as an executor with threads of its own does: whoever waits for it is told
            future.set_exception(error)
        return future


@final
class Adopter:
    """Diagnoses one motor at a time, and not for ever.

    Args:
        executor: where the diagnosis runs, beside the session.
        enough_s: how much must have been seen since the onset.
        experimenting: whether the session can run what a diagnosis asks for, before it takes over what is in doubt.

    Attributes:
        executor: as given.
        diagnoses: what was found, in order, with the motor it is about.
    """

    def __init__(
        self, executor: Executor, enough_s: float = ENOUGH_S, *, experimenting: bool = False
    ) -> None:
        self.executor = executor
        self._enough_s = enough_s
        self._experimenting = experimenting
        self._doubted: set[Port] = set()
        self._running: _Running | None = None
        self._tries: dict[Port, int] = {}
        self._checks: dict[Port, int] = {}
        self.diagnoses: list[tuple[Port, Diagnosis]] = []

    def wants(self, port: Port, seen_s: float, *, asked: bool = False) -> bool:
        """Whether it is time to diagnose a motor that has been off its model for so long.

        Each further try waits for twice as much, or until what the last one asked for was run (`asked`).
        """
        tries = self._tries.get(port, 0)
        enough = asked or seen_s >= self._enough_s * 2.0**tries
        return self._running is None and tries < _TRIES and enough

    def may_check(self, port: Port, seen_s: float) -> bool:
        """Whether a motor that has been on its model for `seen_s` is diagnosed nevertheless."""
        checks = self._checks.get(port, 0)
        return self._running is None and checks < len(CHECKS_S) and seen_s >= CHECKS_S[checks]

    def start(
        self,
        port: Port,
        plant: Plant,
        recording: Recording,
        weighed: Mapping[str, float] | None = None,
        *,
        unasked: bool = False,
        in_use: Plant | None = None,
    ) -> None:
        """Diagnose a motor, from a recording of it, against a model.

        Args:
            port: of the motor.
            plant: the model.
            recording: of it.
            weighed: how probable each effect has come out while the motor was watched.
            unasked: whether the motor is not off its model.
            in_use: the model that the answer has to be nearer than; None for `plant`.
        """
        counted = self._checks if unasked else self._tries
        counted[port] = counted.get(port, 0) + 1
        case = Case("live", Path(), plant.to_config(), (recording,), (), port)
        began_s, ended_s = float(recording.time_s[0]), float(recording.time_s[-1])
        leaning = leaning_to(weighed or {}, plant)
        future = self.executor.submit(_diagnosed, case, in_use or plant, port, leaning)
        anew = in_use is not None
        self._running = _Running(port, began_s, ended_s - began_s, leaning, unasked, anew, future)

    def finished(self) -> Finished | None:
        """What came of the diagnosis, once, when it is over."""
        if self._running is None or not self._running.future.done():
            return None
        run, self._running = self._running, None
        ended = Finished(run.port, run.began_s, run.seconds, None, "", unasked=run.unasked, anew=run.anew)
        error = run.future.exception()
        if error is not None:
            return replace(ended, why_not=_why(error))
        answer, gained = run.future.result()
        self.diagnoses.append((run.port, answer.diagnosis))
        weak = weak_battery(answer.diagnosis, run.leaning.get(BATTERY_SAG.id, 0.0))
        named = bool(answer.diagnosis.effects) or weak >= _SURE
        reason = self._why_not(run, answer.diagnosis, gained, named=named)
        experiment = self._asked_for(run, answer.diagnosis, found=not reason)
        if experiment is not None:
            reason = reason or _doubt(answer.diagnosis)
        if reason:
            return replace(ended, why_not=reason, experiment=experiment)
        if named:
            self._tries[run.port], self._checks[run.port] = 0, len(CHECKS_S)
        self._doubted.discard(run.port)
        return replace(ended, answer=answer, gain=gained, weak_battery=weak)

    def _why_not(self, run: _Running, diagnosis: Diagnosis, gained: Gain, *, named: bool) -> str:
        """Why what a diagnosis found is not taken over; empty where it is."""
        reason = why_not(diagnosis, gained, named=named)
        surely = is_earned(diagnosis) and gained.kept if named else gained.large
        if run.unasked and not surely:
            reason = reason or "nothing is surely missing"
        if run.anew and not diagnosis.effects:
            reason = reason or "all readings together show nothing else"
        if leaves_much(diagnosis) and self._tries.get(run.port, 0) < _FEW:
            reason = (
                reason
                or f"re-fitted parameters leave much ({_errors(gained)}), and more readings may tell why"
            )
        return reason

    def _asked_for(self, run: _Running, diagnosis: Diagnosis, *, found: bool) -> MotorProgram | None:
        """What to run before the next diagnosis: always where nothing was found, once where it is in doubt."""
        port = run.port
        if not self._experimenting or diagnosis.next_experiment is None or run.unasked:
            return None
        if found and (port in self._doubted or is_earned(diagnosis)):
            return None
        if found:
            self._doubted.add(port)
        return diagnosis.next_experiment.program

    def close(self) -> None:
        """Wait for nothing more."""
        self.executor.shutdown(wait=False, cancel_futures=True)


def _diagnosed(
    case: Case, plant: Plant, port: Port, leaning: Mapping[str, float]
) -> tuple[MotorAnswer, Gain]:
    answer = diagnose(case, leaning=leaning)
    return answer, gain(plant, answer.plant, case.recordings[0], port)


def _why(error: BaseException) -> str:
    """What is said of a diagnosis that failed; whatever it failed of, the brick has to be watched on."""
    if isinstance(error, NxtTwinError):
        return str(error)
    return f"the diagnosis failed by an error in nxt-twin ({type(error).__name__}: {error})"


def why_not(diagnosis: Diagnosis, gained: Gain, *, named: bool) -> str:
    """Why what was found is not worth taking over; empty where it is."""
    if diagnosis.verdict == "unexplained":
        fit = diagnosis.fit  # its baseline is re-fitted: it may hide what the model in use lacks
        nearer = min(fit.improved / fit.baseline, gained.after_deg / gained.before_deg) < _WORTHWHILE
        return "" if diagnosis.effects and nearer else "no known effect explains the divergence so far"
    if named or gained.worthwhile:
        return ""
    return f"re-fitted parameters do not improve the model ({_errors(gained)})"


def is_earned(diagnosis: Diagnosis) -> bool:
    """Whether what was found is all that is missing, and each name sure; or nothing is missing."""
    return diagnosis.verdict != "unexplained" and all(one.probability >= _SURE for one in diagnosis.effects)


def leaning_to(weighed: Mapping[str, float], plant: Plant) -> dict[str, float]:
    """Log-likelihood that the weighed effects add to a diagnosis of `plant`, nats by id.

    They have seen the readings that are diagnosed, and know few effects. So they break ties, and no more. An effect
    that is not weighed may be behind one that looks like it, and shares its nats.
    """
    known = {effect.id: effect for effect in plant.layout.effects}
    leaning = {}
    for name, probability in weighed.items():
        if probability < _SURE or name not in known:
            continue
        alike = [other for other in known[name].confusable_with if other in known and other not in weighed]
        leaning.update(dict.fromkeys((name, *alike), _TIE_NATS))
    return leaning


def leaves_much(diagnosis: Diagnosis) -> bool:
    """Whether a diagnosis finds nothing, and yet leaves an error that matters: it may not have seen enough."""
    left = diagnosis.tolerance
    return not diagnosis.effects and left is not None and left.remaining > _NOT_DONE * left.value


def _doubt(diagnosis: Diagnosis) -> str:
    """What keeps the found names from being taken over yet."""
    names = ", ".join(f"{one.name} (probability {one.probability:.2f})" for one in diagnosis.effects)
    more = "" if diagnosis.verdict != "unexplained" else " and more that no known effect explains"
    return f"the diagnosis finds {names}{more}, which is not sure"


def battery_is_another(refit: Mapping[str, Moved]) -> bool:
    """Whether a diagnosis is sure that the battery's resistance is not what it was: all motors would have the new one.

    One motor within seconds hardly tells it, and what it tells of its own effects is good with either.
    """
    moved = refit.get(_BATTERY)
    if moved is None or moved.interval_95 is None:
        return True
    low, high = moved.interval_95
    return not low <= moved.before <= high


def weak_battery(diagnosis: Diagnosis, leaning_nats: float = 0.0) -> float:
    """The probability that the battery gives way notably more than a session takes for granted.

    The plant file does not have its resistance. So that is missing physics, though a diagnosis finds it as a number
    that was off. It is 0 beside effects that were found, and where something is left unexplained or much is left.

    Args:
        diagnosis: of a plant with the resistance that is taken for granted.
        leaning_nats: what the weighed effects add.
    """
    moved = diagnosis.refit.get(_BATTERY)
    if diagnosis.effects or diagnosis.verdict == "unexplained" or leaves_much(diagnosis):
        return 0.0
    if moved is None or moved.std <= 0.0:
        return 0.0
    beyond = (moved.after - moved.before - BATTERY_SAG.notable) / moved.std
    surely = 0.5 * math.erfc(-beyond / math.sqrt(2.0))
    weight = surely * math.exp(leaning_nats)
    return weight / (weight + 1.0 - surely)


def adoption_events(finished: Finished, diagnosis: Diagnosis, time_s: float) -> list[Event]:
    """The events that tell an adopted diagnosis."""
    port, channel = finished.port, tacho_column(finished.port)
    where = f"port {port.upper()}:"
    sure = {effect.name: effect.probability for effect in diagnosis.effects}
    if finished.weak_battery >= _SURE:
        sure[BATTERY_SAG.name] = finished.weak_battery
    named = [
        Event(
            time_s,
            "effect_named",
            f"{where} the diagnosis finds {name} (probability {probability:.2f})",
            port,
            channel,
            strength=probability,
        )
        for name, probability in sure.items()
    ]
    what = (
        f"the model now has {', '.join(sure)}"
        if sure
        else "the model's parameters were off and are re-fitted"
    )
    if diagnosis.verdict == "unexplained":
        what += "; more is missing, and no known effect explains it"
    gained = "" if finished.gain is None else f" ({_errors(finished.gain)})"
    return [
        *named,
        Event(
            time_s,
            "adopted",
            f"{where} {what}{gained}",
            port,
            channel,
            effects=tuple(sure),
            instead=finished.anew,
        ),
    ]


def _errors(gained: Gain) -> str:
    return f"free-run error {gained.before_deg:.3g} deg before, {gained.after_deg:.3g} deg after"
