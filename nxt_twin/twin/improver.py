"""Has motors diagnosed while they are watched, and puts what is found in their models' place."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import final

from nxt_twin.diagnose.engine import MotorAnswer
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.recording.program import MotorProgram
from nxt_twin.twin.adopt import Adopter, Finished, adoption_events, battery_is_another
from nxt_twin.twin.again import Adoption, Refitted, Refitter
from nxt_twin.twin.apart import Apart
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.history import History
from nxt_twin.twin.monitor import MotorMonitor
from nxt_twin.twin.records import Event, Sink

RunExperiment = Callable[[MotorProgram, float], float]
"""Runs a program once from a moment on, and says when it will be over."""

_BEFORE_ONSET_S = 20.0
"""So much from before the onset is diagnosed as well: what came on is told by what was before, and may have come on a
while before it showed."""
_CHECKED_S = 60.0
"""So much of a motor that is not off its model is diagnosed: more costs time, and tells little more."""

_WELL_DATED_S = 1e-3
"""Standard deviation of the moments of readings up to which a motor on its model is diagnosed: a diagnosis takes stamps
that are wrong by more, as over Bluetooth, for physics. Without any, as of a table from elsewhere, nobody knows it."""


@final
class Improver:
    """Diagnoses a motor that is off its model; and now and then one that is not, since a diagnosis sees more.

    Args:
        adopter: diagnoses; None diagnoses nothing.
        twin: of the brick.
        monitors: one for each motor.
        history: of each motor.
        sink: is told what comes of it.
        experiment: runs what a diagnosis asks for; None runs none.
    """

    def __init__(
        self,
        adopter: Adopter | None,
        twin: BrickTwin,
        monitors: Mapping[Port, MotorMonitor],
        history: Mapping[Port, History],
        sink: Sink,
        experiment: RunExperiment | None,
    ) -> None:
        self._adopter, self._twin, self._monitors, self._history = adopter, twin, monitors, history
        self._sink, self._experiment = sink, experiment
        self._gathered_s: dict[Port, float] = {}
        self._taken: dict[Port, Adoption] = {}
        self._fitted_again: set[Port] = set()
        self._refitter = None if adopter is None else Refitter(adopter.executor)
        self._apart = Apart()

    def step(self, now_s: float, doubt_s: float) -> None:
        """Begin what is due, and take over what has been found; `doubt_s` is how well readings are dated."""
        if self._adopter is None:
            return
        for port, monitor in self._monitors.items():
            if monitor.diverging:
                self._diagnose(self._adopter, port, self._apart.since(port, monitor.since_s, now_s), now_s)
            elif port in self._taken:
                self._fit_again(port, self._taken[port], now_s)
            elif monitor.trouble is None and 0.0 < doubt_s <= _WELL_DATED_S:
                self._check(self._adopter, port, now_s)
        self._end(self._adopter, now_s)

    def _end(self, adopter: Adopter, now_s: float) -> None:
        """Take over what has been found."""
        refitted = None if self._refitter is None else self._refitter.finished()
        if refitted is not None and refitted.port in self._fitted_again:
            self._take_numbers(refitted, now_s)
        finished = adopter.finished()
        if finished is None:
            return
        if finished.answer is not None:
            self._take_over(finished, finished.answer, now_s)
        elif not finished.unasked:
            self._go_on(finished, now_s)

    def begin_anew(self, port: Port) -> None:
        """Forget a motor's past readings: later readings cannot be compared with them."""
        self._history[port].clear()
        self._forget(port)

    def _forget(self, port: Port) -> None:
        self._apart.forget(port)
        self._taken.pop(port, None)
        self._fitted_again.discard(port)

    def _diagnose(self, adopter: Adopter, port: Port, since_s: float, now_s: float) -> None:
        gathered = now_s >= self._gathered_s.get(port, math.inf)
        if adopter.wants(port, self._history[port].seconds_since(since_s), asked=gathered):
            self._gathered_s.pop(port, None)
            taken = self._taken.get(port)
            if taken is not None and taken.is_recent(now_s):
                self._diagnose_anew(adopter, port, taken)
            else:
                self._start(adopter, port, since_s - _BEFORE_ONSET_S)

    def _diagnose_anew(self, adopter: Adopter, port: Port, taken: Adoption) -> None:
        """Diagnose the model as it was given, from all readings: a few of them led to numbers that do not last.

        Against the model with these numbers, their error would look like more that is missing.
        """
        recording = self._history[port].recording(taken.began_s, self._twin.supply_at)
        adopter.start(port, taken.given, recording, in_use=self._twin.plant_as_run(port))

    def _fit_again(self, port: Port, taken: Adoption, now_s: float) -> None:
        """Fit what was adopted once more, as soon as there are twice the readings."""
        refitter = self._refitter
        if refitter is None or port in self._fitted_again or not refitter.is_free or not taken.is_due(now_s):
            return
        self._fitted_again.add(port)
        recording = self._history[port].recording(taken.began_s, self._twin.supply_at)
        refitter.start(port, self._twin.plant_as_run(port), recording)

    def _check(self, adopter: Adopter, port: Port, now_s: float) -> None:
        if adopter.may_check(port, self._history[port].seconds_since(now_s - _CHECKED_S)):
            self._start(adopter, port, now_s - _CHECKED_S, unasked=True)

    def _start(self, adopter: Adopter, port: Port, from_s: float, *, unasked: bool = False) -> None:
        recording = self._history[port].recording(from_s, self._twin.supply_at)
        weighed = self._twin.motor(port).probabilities
        adopter.start(port, self._twin.plant_as_run(port), recording, weighed, unasked=unasked)

    def _go_on(self, finished: Finished, now_s: float) -> None:
        """With the model that there is, and with what the diagnosis asks for, if that can be run."""
        port, onset_s = finished.port, self._monitors[finished.port].since_s
        where, experiment = f"port {port.upper()}:", finished.experiment
        if experiment is None or self._experiment is None:
            words = f"{where} {finished.why_not}; the twin keeps its model"
            self._sink.event(Event(now_s, "undiagnosed", words, port, onset_s=onset_s))
            return
        self._gathered_s[port] = self._experiment(experiment, now_s)
        lasts_s = self._gathered_s[port] - now_s
        words = f"{where} {finished.why_not}; the motor now runs '{experiment.name}' for {lasts_s:.0f} s to tell more"
        self._sink.event(Event(now_s, "gathering", words, port, onset_s=onset_s))

    def _take_over(self, finished: Finished, answer: MotorAnswer, now_s: float) -> None:
        port, told_of_battery = finished.port, battery_is_another(answer.diagnosis.refit)
        before = self._taken.get(port) if finished.anew else None
        given = self._twin.plant_as_run(port) if before is None else before.given
        self._adopt(port, answer.plant, finished.began_s, now_s, told_of_battery=told_of_battery)
        self._forget(port)
        if answer.diagnosis.effects:
            self._taken[port] = Adoption(given, finished.began_s, finished.seconds)
        for event in adoption_events(finished, answer.diagnosis, now_s):
            self._sink.event(event)

    def _take_numbers(self, refitted: Refitted, now_s: float) -> None:
        self._adopt(refitted.port, refitted.plant, refitted.began_s, now_s, told_of_battery=False)
        self._sink.event(refitted.told(now_s))

    def _adopt(
        self, port: Port, plant: Plant, began_s: float, now_s: float, *, told_of_battery: bool
    ) -> None:
        held = self._history[port].held(began_s)
        self._twin.adopt(port, plant, began_s, held, told_of_battery=told_of_battery)
        self._monitors[port].forget(now_s, proving=True)
