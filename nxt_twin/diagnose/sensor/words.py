"""What a sensor's diagnosis says to a person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from nxt_twin.diagnose.diagnosis import Fit, FoundEffect, NextExperiment, Verdict
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.leftover import Left
from nxt_twin.diagnose.telling.words import listed

_EXPERIMENTS: Final = {
    "ultrasonic_sensor": "a flat wall square on, from contact to 1.5 m in steps of 1 cm with 20 readings at each, "
    "then the sensor turned by 10° and 30°; a thermometer beside it",
    "light_sensor": "the whole gradient there and back in a dark and in a lit room, then 10 s at rest at either end",
    "touch_sensor": "ten slow presses and releases, one gram at a time, then ten after a minute's rest",
}

_ANY_SCALE: Final = (
    "A scale error of another cause, such as the sensor's own clock, looks like another speed of sound. "
    "The temperature stands for the scale until a thermometer confirms it."
)


def sentence(verdict: Verdict, effects: Sequence[FoundEffect], fit: Fit) -> str:
    """What is wrong, in one sentence."""
    figures = f"from {fit.baseline:.3g} to {fit.improved:.3g} {fit.unit} on held-out readings"
    named = listed([effect.name for effect in effects])
    those = "these" if len(effects) > 1 else "it"
    if verdict == "adequate":
        return (
            f"Nothing is missing: the re-fitted ideal sensor predicts held-out readings to "
            f"{fit.improved:.3g} {fit.unit}."
        )
    falls = fit.improved < 0.98 * fit.baseline
    if verdict == "explained" and falls:
        return f"The ideal sensor leaves out {named}; with {those}, the error falls {figures}."
    if verdict == "explained":
        return (
            f"The ideal sensor leaves out {named}: the scatter of readings changes and their mean does not; "
            f"the error on held-out readings stays at {fit.improved:.3g} {fit.unit}."
        )
    if effects:
        helps = "help" if len(effects) > 1 else "helps"
        return (
            f"Something is missing that no known effect accounts for; {named} {helps} ({figures}), "
            "but the residual exceeds noise."
        )
    return (
        "Something is missing that no known effect accounts for; the error on held-out readings "
        f"stays at {fit.improved:.3g} {fit.unit}."
    )


def why_confusable(effect: SensorEffect, other: SensorEffect, behind: float) -> str:
    """Why these recordings leave it open which of two effects it is."""
    told = effect.confusable_with.get(other.id) or other.confusable_with.get(effect.id)
    likeness = (
        f"in its place it does better by {-behind:.1f} nats"
        if behind < 0.0
        else f"in its place it does worse by only {behind:.1f} nats"
    )
    return f"{likeness}; {told}" if told else f"{likeness} on these recordings"


def experiment_between(effect: SensorEffect, other: SensorEffect, kind: str) -> NextExperiment:
    """What would tell two effects apart."""
    told = effect.confusable_with.get(other.id) or other.confusable_with.get(effect.id)
    why = f"these recordings do not tell {effect.name} from {other.name}"
    return NextExperiment(why=why, input=told or _EXPERIMENTS[kind])


def experiment_for_unknown(kind: str, left: Left) -> NextExperiment:
    """What to record when nothing known accounts for the mismatch."""
    along = left.along.replace("_", " ")
    return NextExperiment(
        why=f"the residual follows {along}, and no known effect has its shape", input=_EXPERIMENTS[kind]
    )


def notes(
    effects: Sequence[FoundEffect], left: Left | None, independent: float, learns: bool
) -> tuple[str, ...]:
    """Plain remarks: what a parameter stands for, what is left, how the held-out error is counted."""
    said = []
    if any(effect.id == "ultrasonic_sound_speed" for effect in effects):
        said.append(_ANY_SCALE)
    if any(effect.id == "light_ambient_offset" for effect in effects):
        said.append("Room light is given relative to the first recording.")
    if learns:
        said.append(
            "The first fifth of a held-out recording gives its room light and mains phase, "
            "and does not count in the error."
        )
    if independent < 0.7:
        said.append(
            f"Neighbouring readings err alike: they count as {100 * independent:.0f} % of their number "
            "in the search and in the intervals."
        )
    if left is not None:
        said.append(f"The residual is largest along {left.along.replace('_', ' ')} ({left.nats:.0f} nats).")
    return tuple(said)
