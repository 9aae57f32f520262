"""Fits an adopted model once more when far more readings are there: its effects stay, their numbers get better."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import final

from nxt_twin.diagnose.engine import fit_as_it_stands
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.gain import Gain, gain
from nxt_twin.twin.records import Event

_TIMES = 2.0
_LATEST_S = 90.0


@final
@dataclass(frozen=True)
class Adoption:
    """A model that was taken over with effects.

    Attributes:
        given: the model before any effect was taken over, as a diagnosis is given it.
        began_s: when the recording began that it was found in; effects that change with time count from there.
        seconds: how long that was.
    """

    given: Plant
    began_s: float
    seconds: float

    def is_recent(self, now_s: float) -> bool:
        """Whether the readings from then on still tell of it: a divergence then speaks of its numbers."""
        return now_s - self.began_s <= _LATEST_S

    def is_due(self, now_s: float) -> bool:
        """Whether enough readings came since that its numbers are worth another fit."""
        return now_s - self.began_s >= _TIMES * self.seconds


@final
@dataclass(frozen=True)
class Refitted:
    """A model with better numbers; `began_s` as of `Adoption`."""

    port: Port
    began_s: float
    plant: Plant
    gain: Gain

    def told(self, now_s: float) -> Event:
        """The event that tells it."""
        words = (
            f"port {self.port.upper()}: the model's parameters are fitted again to more readings "
            f"(free-run error {self.gain.before_deg:.3g} deg before, {self.gain.after_deg:.3g} deg after)"
        )
        return Event(now_s, "adopted", words, self.port, tacho_column(self.port))


@final
class Refitter:
    """Fits one model at a time, beside the session.

    Args:
        executor: where.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._running: Future[Refitted] | None = None

    @property
    def is_free(self) -> bool:
        """Whether it could begin."""
        return self._running is None

    def start(self, port: Port, plant: Plant, recording: Recording) -> None:
        """Fit a motor's model to a recording of it."""
        self._running = self._executor.submit(fitted_again, port, plant, recording)

    def finished(self) -> Refitted | None:
        """A model that is much nearer than the one before; None where there is none, or not yet."""
        if self._running is None or not self._running.done():
            return None
        run, self._running = self._running, None
        if run.exception() is not None:  # the model in use stays: it is as good as it was
            return None
        found = run.result()
        return found if found.gain.large else None


def fitted_again(port: Port, plant: Plant, recording: Recording) -> Refitted:
    """Fit a motor's model, with the effects that it has, to a recording of it."""
    case = Case("live", Path(), plant.to_config(), (recording,), (), port)
    better = fit_as_it_stands(case).plant
    return Refitted(port, float(recording.time_s[0]), better, gain(plant, better, recording, port))
