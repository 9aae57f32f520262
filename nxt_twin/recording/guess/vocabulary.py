"""What people call the columns of their logs, and the units that they write behind them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from nxt_twin.recording.columns import DriveMode
from nxt_twin.recording.guess.profile import TableColumn

_WRITTEN = """
time: t time timestamp stamp ms millis micros seconds sec clock date datetime elapsed
time: zeit uhrzeit tempo temps tiempo tijd czas
counter: index frame row id n nr no sample step count counter
split: episode run trial experiment segment repeat rep versuch
mode: enabled enable mode active brake coast bridge drive
goal: action goal target setpoint setpt reference ref desired des soll sollwinkel sollwert consigne qg
angle: angle ang theta phi position pos qm q tacho encoder enc ticks counts rotation state deg rad
angle: winkel drehwinkel ángulo angulo angolo hoek kąt
speed: speed velocity vel omega rpm qd dq rate geschwindigkeit drehzahl vitesse velocidad velocità snelheid
power: power pwm duty dutycycle throttle leistung stellgröße puissance potencia potenza vermogen
voltage: voltage volt volts vir u uin spannung tensión tension tensione spanning
current: current amps ampere i strom courant corriente corrente
torque: torque tau effort moment drehmoment
force: force kraft
sign: dir direction sign sens richtung forward reverse sentido
pulse: servo pulse us microseconds micros
command: cmd cmds command commands commanded input control ctrl out motor
told: cmd cmds command commands commanded
supply: battery batterie batt bat vbat supply vin vcc vbus akku
raw: raw ticks counts count encoder enc steps present
derived: raw filtered filt err error est estimated dt
aside: temperature temp celsius humidity pressure checksum crc
"""
_LINES = [(line.partition(":")[0], line.partition(":")[2]) for line in _WRITTEN.strip().splitlines()]
NAMES: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        subject: frozenset(word for own, words in _LINES if own == subject for word in words.split())
        for subject, _ in _LINES
    }
)
"""Words of a column's name by what they speak for."""

MODE_WORDS: Mapping[str, DriveMode] = MappingProxyType(
    {
        **dict.fromkeys(("drive", "on", "run", "running", "pwm", "active", "enabled"), "drive"),
        **dict.fromkeys(("coast", "off", "free", "idle", "disabled", "released"), "coast"),
        **dict.fromkeys(("brake", "braking", "short", "stop"), "brake"),
        "float": "float",
    }
)
"""What a bridge does, as people write it."""

_UNITS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(
            ("s", "sec", "secs", "seconds", "second", "sekunden", "secondes", "segundos"), ("time", "s")
        ),
        **dict.fromkeys(("ms", "msec", "millis", "milliseconds"), ("time", "ms")),
        **dict.fromkeys(("us", "µs", "usec", "micros", "microseconds"), ("time", "us")),
        **dict.fromkeys(("ns", "nsec", "nanoseconds"), ("time", "ns")),
        **dict.fromkeys(
            (
                "deg",
                "degree",
                "degrees",
                "°",
                "grad",
                "degrés",
                "degres",
                "grados",
                "gradi",
                "graus",
                "graden",
            ),
            ("angle", "deg"),
        ),
        **dict.fromkeys(("rad", "radian", "radians", "radianes", "radianti"), ("angle", "rad")),
        **dict.fromkeys(("turn", "turns", "rev", "revs", "revolutions"), ("angle", "turn")),
        **dict.fromkeys(("ticks", "tick", "counts", "count", "steps", "cnt"), ("ticks", "ticks")),
        **{word: ("position", word) for word in ("m", "mm", "cm", "um")},
        **dict.fromkeys(("deg/s", "°/s", "dps", "deg/sec"), ("speed", "deg/s")),
        **dict.fromkeys(("rad/s", "rad/sec"), ("speed", "rad/s")),
        **dict.fromkeys(("rpm", "1/min", "u/min"), ("speed", "rpm")),
        **{word: ("speed", word) for word in ("m/s", "mm/s")},
        **dict.fromkeys(("%", "pct", "percent", "prozent", "pourcent", "porcentaje"), ("power", "pct")),
        **dict.fromkeys(("v", "volt", "volts"), ("voltage", "V")),
        "mv": ("voltage", "mV"),
        **dict.fromkeys(("a", "amp", "amps"), ("current", "A")),
        "ma": ("current", "mA"),
        **dict.fromkeys(("nm", "n·m", "n*m", "n m"), ("torque", "Nm")),
        **dict.fromkeys(("mnm", "m n m"), ("torque", "mNm")),
        "n": ("force", "N"),
    }
)
_SUFFIXES = ("rad_per_s", "deg_per_s", "m_per_s")


def has(column: TableColumn, subject: str) -> bool:
    """Whether the column's name has a word for `subject`."""
    words = (*column.words, *_no_unit(column))
    return bool(NAMES[subject].intersection(words))


def _no_unit(column: TableColumn) -> tuple[str, ...]:
    """The words in a name's brackets, where they are no unit: `Stellgröße (PWM %)`."""
    stated = column.stated_unit.lower()
    return () if stated in _UNITS else tuple(stated.split())


def quantity_and_unit(column: TableColumn) -> tuple[str, str]:
    """The quantity of the column's unit and the unit, as `--columns` writes it; empty where none is stated."""
    for stated in (column.stated_unit.lower(), *_endings(column), *reversed(_no_unit(column))):
        if stated in _UNITS:
            return _UNITS[stated]
    return "", ""


def is_unit(text: str) -> bool:
    """Whether a text is a unit as people write it."""
    return text.lower() in _UNITS


def _endings(column: TableColumn) -> list[str]:
    """What may be a unit at the end of a name: `speed_deg_per_s`, `angle_deg`, `angle/deg`, `t ms`."""
    name = column.name.lower()
    long = [suffix.replace("_per_", "/") for suffix in _SUFFIXES if name.endswith(suffix)]
    last = column.words[-1] if len(column.words) > 1 else ""
    parted = name.rpartition("/")[2] if "/" in name else ""
    whole = name if len(name) > 1 else ""
    single = last if len(last) > 1 or name.endswith((f"_{last}", f" {last}")) else ""
    return [*long, whole, parted, single]
