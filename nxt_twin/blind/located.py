"""Where a diagnosis says that the baseline fails, beside where something was hidden."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

from nxt_twin.blind.effects.library import EFFECTS
from nxt_twin.blind.kinds import Equation

ALARM_P: Final = 0.01


@final
@dataclass(frozen=True)
class LocatedOnset:
    """When something set in, s since the beginning of one recording, with the bounds that are given for it."""

    recording: str
    time_s: float
    low_s: float
    high_s: float


@final
@dataclass(frozen=True)
class OnsetPlace:
    """The parts of a diagnosis about the place of the mismatch that the benchmark judges.

    Attributes:
        equation: that it names, one of the four of docs/formats.md#diagnosis-json.
        loudest: that for which the strongest of its sources speaks, of five; no effect's name takes part in it.
        least_p: the least p-value of its sources; None where it gives none.
        onsets: moments at which something sets in, the strongest first.
    """

    equation: str | None
    loudest: str | None
    least_p: float | None
    onsets: tuple[LocatedOnset, ...]


@final
@dataclass(frozen=True)
class Located:
    """The place, judged.

    Attributes:
        truth: the equation of what is hidden; None unless exactly one thing is.
        named: whether the equation that the diagnosis names is that one; None without `truth`. The JSON format counts
            what joins two bodies to the balance of torques.
        unaided: whether its loudest source speaks for that one.
        alarm: whether a source's p-value is below 1 %; None where it gives none.
        event: when what is hidden set in; None where it did not within a recording.
        onset: the moment that the diagnosis gives for that recording, or for any where there was no event.
    """

    truth: Equation | None
    named: bool | None
    unaided: bool | None
    alarm: bool | None
    event: LocatedOnset | None
    onset: LocatedOnset | None

    @property
    def onset_error_s(self) -> float | None:
        """By how much the moment that is given is off; None where one of the two is missing."""
        if self.event is None or self.onset is None:
            return None
        return abs(self.onset.time_s - self.event.time_s)

    @property
    def onset_held(self) -> bool | None:
        """Whether the true moment lies within the bounds that are given; None where one of the two is missing."""
        if self.event is None or self.onset is None:
            return None
        return self.onset.low_s <= self.event.time_s <= self.onset.high_s


NOWHERE: Final = OnsetPlace(None, None, None, ())
UNPLACED: Final = Located(None, None, None, None, None, None)


def parse_place(mismatch: Mapping[str, Any]) -> OnsetPlace:
    """Take from a diagnosis's mismatch what is judged; what is left out is not judged.

    Raises:
        KeyError, TypeError, ValueError: if a key is missing or of another type.
    """
    sources = mismatch.get("sources", ())
    return OnsetPlace(
        equation=mismatch.get("equation"),
        loudest=max(sources, key=lambda one: float(one["strength"]))["equation"] if sources else None,
        least_p=min(float(one["p_value"]) for one in sources) if sources else None,
        onsets=tuple(
            LocatedOnset(one["recording"], *(float(one[key]) for key in ("time_s", "low_s", "high_s")))
            for one in mismatch.get("onsets", ())
        ),
    )


def locate_score(answer: Mapping[str, Any], place: OnsetPlace) -> Located:
    """Compare what is said of where with the answer."""
    effects = answer["effects"]
    truth = _equation(effects[0]) if len(effects) == 1 else None
    event = _event(effects[0]["params"]) if len(effects) == 1 else None
    onsets = [onset for onset in place.onsets if event is None or onset.recording == event.recording]
    return Located(
        truth=truth,
        named=None if truth is None else place.equation == _of_four(truth),
        unaided=None if truth is None else place.loudest == truth,
        alarm=None if place.least_p is None else place.least_p < ALARM_P,
        event=event,
        onset=onsets[0] if onsets else None,
    )


def _equation(effect: Mapping[str, Any]) -> Equation | None:
    """The equation that an effect changes, as its answer says or, in answers that do not, the library."""
    told: Equation | None = effect.get("equation")
    held = EFFECTS.get(effect["id"])
    return told or (held.equation if held else None)


def _of_four(equation: Equation) -> str:
    return "torque_balance" if equation == "kinematic" else equation


def _event(params: Mapping[str, float]) -> LocatedOnset | None:
    """The moment from which an effect acts, if it is within a recording."""
    from_s = params.get("from_s", 0.0)
    if from_s <= 0.0 or "from_recording" not in params:
        return None
    return LocatedOnset(f"r{int(params['from_recording'])}.csv", from_s, from_s, from_s)
