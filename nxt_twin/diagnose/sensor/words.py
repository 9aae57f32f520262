"""The sentences of a sensor's diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from nxt_twin.diagnose.diagnosis import Fit, FoundEffect, NextExperiment, Verdict
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.leftover import Left
from nxt_twin.diagnose.telling.words import listed

_EXPERIMENTS: Final = {
    "ultrasonic_sensor": "a flat wall at 0°, from contact to 1.5 m in steps of 1 cm, with 20 readings at each. "
    "Then at 10° and at 30°. Note the air temperature",
    "light_sensor": "the whole gradient both ways, in a dark and in a lit room; then 10 s at rest at each end",
    "touch_sensor": "ten slow presses and releases in steps of 1 g; then ten more after a minute of rest",
}

_ANY_SCALE: Final = (
    "A scale error of the sensor's own clock looks like another speed of sound. "
    "The temperature is a scale factor until a thermometer confirms it."
)


def sentence(verdict: Verdict, effects: Sequence[FoundEffect], fit: Fit) -> str:
    """The verdict with its figures, for a person; at most two sentences."""
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
            f"The ideal sensor leaves out {named}. With {those}, the model predicts the scatter of readings; "
            f"the error on held-out readings stays at {fit.improved:.3g} {fit.unit}."
        )
    if effects:
        helps = "help" if len(effects) > 1 else "helps"
        return (
            f"Something is missing, and no known effect accounts for all of it. {named[:1].upper()}{named[1:]} {helps} "
            f"({figures}); the rest is more than noise."
        )
    return (
        "Something is missing, and it is no effect that nxt-twin knows; the error on held-out readings "
        f"stays at {fit.improved:.3g} {fit.unit}."
    )


def why_confusable(effect: SensorEffect, other: SensorEffect, behind: float) -> str:
    """Why these recordings leave it open which of two effects it is."""
    told = effect.confusable_with.get(other.id) or other.confusable_with.get(effect.id)
    likeness = (
        f"in its place, the log-likelihood is {-behind:.1f} nats higher"
        if behind < 0.0
        else f"in its place, the log-likelihood is only {behind:.1f} nats lower"
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
            "The first fifth of a held-out recording gives its room light and mains phase. "
            "The error leaves this fifth out."
        )
    if independent < 0.7:
        said.append(
            f"The errors of neighbouring readings are correlated. The search and the intervals count the readings as "
            f"{100 * independent:.0f} % of their number."
        )
    if left is not None:
        said.append(f"The residual depends most on {left.along.replace('_', ' ')} ({left.nats:.0f} nats).")
    return tuple(said)
