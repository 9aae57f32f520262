"""From a divergence to a better model, while the session goes on: diagnose what was seen, take over what is found."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, final

from nxt_twin.diagnose.diagnosis import Diagnosis, Moved
from nxt_twin.diagnose.engine import Answer, diagnose
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
CHECK_S = 15.0
"""After so much of a model without a divergence it is diagnosed all the same, and again after twice as much.

Only until an effect is adopted: what a second one explains is too often the error of the first one's numbers.
"""
_CHECKS = 3
_TRIES = 4
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
        answer: what to take over; None where there is nothing.
        why_not: why there is nothing.
        gain: what its plant gains over the model in use; None where there is no answer.
        weak_battery: the probability that the battery gives way notably more than was taken for granted.
        experiment: what to run, so that the next diagnosis can tell more; None where nothing is to be run.
        unasked: whether the motor was not off its model when the diagnosis began.
    """

    port: Port
    began_s: float
    answer: Answer | None
    why_not: str
    gain: Gain | None = None
    weak_battery: float = 0.0
    experiment: MotorProgram | None = None
    unasked: bool = False


@final
@dataclass(frozen=True)
class _Running:
    """A diagnosis that is under way; fields as of `Finished`, and of what it was given."""

    port: Port
    began_s: float
    leaning: Mapping[str, float]
    unasked: bool
    future: Future[tuple[Answer, Gain]]


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
        diagnoses: what was found, in order, with the motor it is about.
    """

    def __init__(
        self, executor: Executor, enough_s: float = ENOUGH_S, *, experimenting: bool = False
    ) -> None:
        self._executor = executor
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
        return self._running is None and checks < _CHECKS and seen_s >= CHECK_S * 2.0**checks

    def start(
        self,
        port: Port,
        plant: Plant,
        recording: Recording,
        weighed: Mapping[str, float] | None = None,
        *,
        unasked: bool = False,
    ) -> None:
        """Diagnose a motor, from a recording of it, against the model that it has.

        Args:
            port: of the motor.
            plant: its model.
            recording: of it.
            weighed: how probable each effect has come out while the motor was watched.
            unasked: whether the motor is not off its model.
        """
        counted = self._checks if unasked else self._tries
        counted[port] = counted.get(port, 0) + 1
        case = Case("live", Path(), plant.to_config(), (recording,), (), port)
        began_s = float(recording.time_s[0])
        leaning = leaning_to(weighed or {})
        future = self._executor.submit(_diagnosed, case, plant, port, leaning)
        self._running = _Running(port, began_s, leaning, unasked, future)

    def finished(self) -> Finished | None:
        """What came of the diagnosis, once, when it is over."""
        if self._running is None or not self._running.future.done():
            return None
        run, self._running = self._running, None
        error = run.future.exception()
        if error is not None:
            return Finished(run.port, run.began_s, None, _why(error), unasked=run.unasked)
        answer, gained = run.future.result()
        self.diagnoses.append((run.port, answer.diagnosis))
        weak = weak_battery(answer.diagnosis, run.leaning.get(BATTERY_SAG.id, 0.0))
        named = bool(answer.diagnosis.effects) or weak >= _SURE
        reason = why_not(answer.diagnosis, gained, named=named)
        surely = is_earned(answer.diagnosis) and gained.any if named else gained.large
        if run.unasked and not surely:
            reason = reason or "nothing is surely missing"
        experiment = self._asked_for(run, answer.diagnosis, found=not reason)
        if experiment is not None:
            reason = reason or _doubt(answer.diagnosis)
        if reason:
            return Finished(run.port, run.began_s, None, reason, experiment=experiment, unasked=run.unasked)
        if named:
            self._tries[run.port], self._checks[run.port] = 0, _CHECKS
        self._doubted.discard(run.port)
        return Finished(run.port, run.began_s, answer, "", gained, weak, unasked=run.unasked)

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
        self._executor.shutdown(wait=False, cancel_futures=True)


def _diagnosed(case: Case, plant: Plant, port: Port, leaning: Mapping[str, float]) -> tuple[Answer, Gain]:
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


def leaning_to(weighed: Mapping[str, float]) -> dict[str, float]:
    """Log-likelihood that the weighed effects add to a diagnosis, nats by id.

    They have seen the readings that are diagnosed, and know few effects. So they break ties, and no more.
    """
    return {name: _TIE_NATS for name, probability in weighed.items() if probability >= _SURE}


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
    that was off. It is 0 beside effects that were found, and where something is left unexplained.

    Args:
        diagnosis: of a plant with the resistance that is taken for granted.
        leaning_nats: what the weighed effects add.
    """
    moved = diagnosis.refit.get(_BATTERY)
    if diagnosis.effects or diagnosis.verdict == "unexplained" or moved is None or moved.std <= 0.0:
        return 0.0
    beyond = (moved.after - moved.before - BATTERY_SAG.notable) / moved.std
    surely = 0.5 * math.erfc(-beyond / math.sqrt(2.0))
    weight = surely * math.exp(leaning_nats)
    return weight / (weight + 1.0 - surely)


def told(finished: Finished, diagnosis: Diagnosis, time_s: float) -> list[Event]:
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
        Event(time_s, "adopted", f"{where} {what}{gained}", port, channel, effects=tuple(sure)),
    ]


def _errors(gained: Gain) -> str:
    return f"free-run error {gained.before_deg:.3g} deg before, {gained.after_deg:.3g} deg after"
