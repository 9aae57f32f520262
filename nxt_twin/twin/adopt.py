"""From a divergence to a better model, while the session goes on: diagnose what was seen, take over what is found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, final

from nxt_twin.diagnose.diagnosis import Diagnosis, Moved
from nxt_twin.diagnose.engine import Answer, diagnose
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.gain import Gain, gain
from nxt_twin.twin.records import Event

T = TypeVar("T")

ENOUGH_S = 12.0
_TRIES = 4
_WORTHWHILE = 0.7
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
    """

    port: Port
    began_s: float
    answer: Answer | None
    why_not: str
    gain: Gain | None = None


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

    Attributes:
        diagnoses: what was found, in order, with the motor it is about.
    """

    def __init__(self, executor: Executor, enough_s: float = ENOUGH_S) -> None:
        self._executor = executor
        self._enough_s = enough_s
        self._running: tuple[Port, float, Future[tuple[Answer, Gain]]] | None = None
        self._tries: dict[Port, int] = {}
        self.diagnoses: list[tuple[Port, Diagnosis]] = []

    def wants(self, port: Port, seen_s: float) -> bool:
        """Whether it is time to diagnose a motor that has been off its model for so long.

        Each further try waits for twice as much.
        """
        tries = self._tries.get(port, 0)
        return self._running is None and tries < _TRIES and seen_s >= self._enough_s * 2.0**tries

    def start(self, port: Port, plant: Plant, recording: Recording) -> None:
        """Diagnose a motor, from a recording of it, against the model that it has."""
        self._tries[port] = self._tries.get(port, 0) + 1
        case = Case("live", Path(), plant.to_config(), (recording,), (), port)
        began_s = float(recording.time_s[0])
        self._running = (port, began_s, self._executor.submit(_diagnosed, case, plant, port))

    def finished(self) -> Finished | None:
        """What came of the diagnosis, once, when it is over."""
        if self._running is None or not self._running[2].done():
            return None
        port, began_s, future = self._running
        self._running = None
        error = future.exception()
        if error is not None:
            return Finished(port, began_s, None, _why(error))
        answer, gained = future.result()
        self.diagnoses.append((port, answer.diagnosis))
        if not _better(answer.diagnosis):
            return Finished(port, began_s, None, "no known effect explains the divergence so far")
        if not (answer.diagnosis.effects or gained.worthwhile):
            errors = _errors(gained)
            return Finished(port, began_s, None, f"re-fitted parameters do not improve the model ({errors})")
        self._tries[port] = 0 if answer.diagnosis.effects else self._tries[port]
        return Finished(port, began_s, answer, "", gained)

    def close(self) -> None:
        """Wait for nothing more."""
        self._executor.shutdown(wait=False, cancel_futures=True)


def _diagnosed(case: Case, plant: Plant, port: Port) -> tuple[Answer, Gain]:
    answer = diagnose(case)
    return answer, gain(plant, answer.plant, case.recordings[0], port)


def _why(error: BaseException) -> str:
    """What is said of a diagnosis that failed; whatever it failed of, the brick has to be watched on."""
    if isinstance(error, NxtTwinError):
        return str(error)
    return f"the diagnosis failed by an error in nxt-twin ({type(error).__name__}: {error})"


def _better(diagnosis: Diagnosis) -> bool:
    """Whether what was found is worth taking over."""
    if diagnosis.verdict != "unexplained":
        return True
    return bool(diagnosis.effects) and diagnosis.fit.improved < _WORTHWHILE * diagnosis.fit.baseline


def battery_is_another(refit: Mapping[str, Moved]) -> bool:
    """Whether a diagnosis is sure that the battery's resistance is not what it was: all motors would have the new one.

    One motor within seconds hardly tells it, and what it tells of its own effects is good with either.
    """
    moved = refit.get(_BATTERY)
    if moved is None or moved.interval_95 is None:
        return True
    low, high = moved.interval_95
    return not low <= moved.before <= high


def told(port: Port, time_s: float, answer: Answer, gained: Gain) -> list[Event]:
    """What a diagnosis that was taken over says, as events."""
    diagnosis, channel = answer.diagnosis, tacho_column(port)
    where = f"port {port.upper()}:"
    named = [
        Event(
            time_s,
            "effect_named",
            f"{where} the diagnosis finds {effect.name} (probability {effect.probability:.2f})",
            port,
            channel,
            strength=effect.probability,
        )
        for effect in diagnosis.effects
    ]
    names = tuple(effect.name for effect in diagnosis.effects)
    what = (
        f"the model now has {', '.join(names)}"
        if names
        else "the model's parameters were off and are re-fitted"
    )
    if diagnosis.verdict == "unexplained":
        what += "; more is missing, and no known effect explains it"
    return [
        *named,
        Event(time_s, "adopted", f"{where} {what} ({_errors(gained)})", port, channel, effects=names),
    ]


def _errors(gained: Gain) -> str:
    return f"free-run error {gained.before_deg:.3g} deg before, {gained.after_deg:.3g} deg after"
