"""The names in JSON and plant files, in words for a person."""

from __future__ import annotations

from nxt_twin.diagnose.diagnosis import Diagnosis, Source, Verdict
from nxt_twin.physics.effect import Equation

VERDICTS: dict[Verdict, str] = {
    "adequate": "nothing is missing",
    "explained": "the missing physics is found",
    "unexplained": "something unknown is missing",
}

EQUATIONS: dict[Equation, str] = {
    "torque_balance": "the torque balance: what drives the shaft and what brakes it",
    "electrical": "the electrical side: battery, bridge and winding",
    "kinematic": "the kinematics: how the motor's motion becomes the motion that is measured",
    "measurement": "the measurement: how the sensor turns the truth into a reading",
    "timing": "the timing: when commands act and when readings are taken",
}

SOURCES: dict[Source, str] = {
    "actuator": "a torque in the actuator or on its axis",
    "battery": "the battery, the bridge or the winding",
    "transmission": "the transmission between motor and sensor",
    "encoder": "the encoder's readings",
    "clock_or_link": "the clock or the link: stamps and delays",
}

_UNIT_ENDINGS = (
    "_nm_s2_per_rad2",
    "_raw_per_mm",
    "_nm_s_per_rad",
    "_v_s_per_rad",
    "_nm_per_rad",
    "_nm_per_a",
    "_n_s2_per_m2",
    "_deg_per_s",
    "_rad_per_s",
    "_n_s_per_m",
    "_per_joule",
    "_m_per_s",
    "_n_per_m",
    "_v_per_s",
    "_kg_m2",
    "_rad_s",
    "_ohm",
    "_pct",
    "_raw",
    "_deg",
    "_rad",
    "_nm",
    "_hz",
    "_kg",
    "_mm",
    "_cm",
    "_h",
    "_v",
    "_s",
    "_a",
    "_n",
    "_g",
    "_c",
    "_m",
)


def spelled_out(name: str) -> str:
    """A key of a plant file or of the JSON as words, without its unit: `breakaway_torque_nm` as `breakaway torque`."""
    for ending in _UNIT_ENDINGS:
        if name.endswith(ending) and len(name) > len(ending):
            name = name.removesuffix(ending)
            break
    return name.replace("_", " ")


def quantity(channel: str) -> str:
    """The quantity of a measured column in words: `a_tacho_deg` as `tacho A`."""
    port, _, rest = spelled_out(channel).partition(" ")
    if len(port) <= 2 and rest:
        return f"{rest} {port.upper()}"
    return spelled_out(channel) or "output"


def improves(diagnosis: Diagnosis) -> bool:
    """Whether there is an improved model beside the re-fitted baseline."""
    return diagnosis.verdict != "adequate" and bool(diagnosis.effects)


def counted(count: int, thing: str) -> str:
    """`one more run`, `13 more runs`."""
    words = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
    number = words[count] if count < len(words) else str(count)
    return f"{number} {thing}" if count == 1 else f"{number} {thing}s"


def ordinal(number: int) -> str:
    """`2nd`, `3rd`, `11th`."""
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def capitalise(text: str) -> str:
    """The text with its first letter large and the others untouched."""
    return text[:1].upper() + text[1:]


def as_sentence(text: str) -> str:
    """The text as a sentence: its first letter large, and a full stop behind it where no mark ends it."""
    return capitalise(text) if text.endswith((".", "!", "?", ":")) else f"{capitalise(text)}."
