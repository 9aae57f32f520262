"""Concealed sensor cases: which effects, how large, and what a rig does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, Literal, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.sensors import button as buttons
from nxt_twin.blind.sensors import echo as echoes
from nxt_twin.blind.sensors import photodiode as photodiodes
from nxt_twin.blind.sensors.button import ButtonMechanism
from nxt_twin.blind.sensors.echo import EchoMechanism
from nxt_twin.blind.sensors.photodiode import Photodiode
from nxt_twin.recording.recording import Recording

SensorPlantKind = Literal["ultrasonic_sensor", "light_sensor", "touch_sensor"]
SensorSize = Literal["small", "medium", "large"]

SENSOR_SIZES: Final[tuple[SensorSize, ...]] = ("small", "medium", "large")
_PAPER_DISTANCES_MM: Final = np.arange(138.0, 1539.0, 100.0)


@final
@dataclass(frozen=True)
class SensorCase:
    """A concealed case: what a solver gets, and the truth.

    Attributes:
        content: what `case.yaml` holds.
        recordings: in its order.
        effects: the true parameters of each effect, by their names in JSON; of one that no library holds, none.
    """

    content: Mapping[str, Any]
    recordings: tuple[Recording, ...]
    effects: Mapping[str, Mapping[str, float]]


@final
@dataclass(frozen=True)
class _Made:
    """What an effect does to the mechanism, and its true parameters."""

    changes: Mapping[str, Any]
    truth: Mapping[str, float]


def _blind_zone(size: SensorSize, rng: Generator) -> _Made:
    below = {"small": 25.0, "medium": 40.0, "large": 80.0}[size] * rng.uniform(0.9, 1.1)
    changes = {"blanked_mm": below, "second_bounce": float(rng.choice([0.0, 0.5]))}
    return _Made(changes, {"blind_distance_mm": below})


def _near_offset(size: SensorSize, rng: Generator) -> _Made:
    offset = {"small": 8.0, "medium": 20.0, "large": 35.0}[size] * rng.uniform(0.9, 1.1)
    below = float(rng.uniform(150.0, 300.0))
    late_us = 2e3 * offset / echoes.speed_of_sound_m_per_s(20.0)
    changes = {"late_us": late_us, "late_below_mm": below, "late_share": float(rng.choice([1.0, 0.9]))}
    return _Made(changes, {"offset_mm": offset, "below_mm": below})


def _range_noise(size: SensorSize, rng: Generator) -> _Made:
    growth = {"small": 0.006, "medium": 0.015, "large": 0.04}[size] * rng.uniform(0.9, 1.1)
    per_m_us = 2e6 * growth / echoes.speed_of_sound_m_per_s(20.0)
    return _Made({"jitter_us_per_m": per_m_us}, {"noise_per_distance": growth})


def _dropout(size: SensorSize, rng: Generator) -> _Made:
    widest = {"small": 55.0, "medium": 40.0, "large": 25.0}[size] * rng.uniform(0.9, 1.1)
    best, turning = float(rng.uniform(350.0, 550.0)), 1.0
    margin = turning * (widest / 10.0) ** 2
    changes = {"margin_db": margin, "best_mm": best, "turning_db": turning}
    return _Made(changes, {"max_angle_deg": widest, "best_distance_mm": best})


def _sound_speed(size: SensorSize, rng: Generator) -> _Made:
    off = {"small": 5.0, "medium": 12.0, "large": 22.0}[size] * rng.choice([-1.0, 1.0])
    return _Made({"temperature_c": 20.0 + off}, {"air_temperature_c": 20.0 + off})


def _room_light(size: SensorSize, rng: Generator) -> _Made:
    light = {"small": 6.0, "medium": 25.0, "large": 80.0}[size] * rng.uniform(0.9, 1.1)
    return _Made({"room_raw": light}, {"offset_raw": -light})


def _saturation(size: SensorSize, rng: Generator) -> _Made:
    ceiling = {"small": 455.0, "medium": 400.0, "large": 300.0}[size] * rng.uniform(0.98, 1.02)
    changes = {"ceiling_raw": ceiling, "headroom_raw": float(rng.choice([4.0, 15.0]))}
    return _Made(changes, {"knee_raw": 900.0 - ceiling})


def _flicker(size: SensorSize, rng: Generator) -> _Made:
    swing = {"small": 2.5, "medium": 8.0, "large": 25.0}[size] * rng.uniform(0.9, 1.1)
    mains = float(rng.choice([50.0, 60.0]))
    changes = {"swing_raw": swing, "mains_hz": mains}
    return _Made(changes, {"frequency_hz": 2.0 * mains, "amplitude_raw": swing})


def _hysteresis(size: SensorSize, rng: Generator) -> _Made:
    gap_mm = {"small": 0.05, "medium": 0.12, "large": 0.3}[size] * rng.uniform(0.9, 1.1)
    return _Made({"back_mm": 2.1 - gap_mm}, {})


SENSOR_EFFECTS: Mapping[SensorPlantKind, Mapping[str, Callable[[SensorSize, Generator], _Made]]] = (
    MappingProxyType(
        {
            "ultrasonic_sensor": {
                "ultrasonic_blind_zone": _blind_zone,
                "ultrasonic_near_offset": _near_offset,
                "ultrasonic_range_noise": _range_noise,
                "ultrasonic_dropout": _dropout,
                "ultrasonic_sound_speed": _sound_speed,
            },
            "light_sensor": {
                "light_ambient_offset": _room_light,
                "light_saturation": _saturation,
                "light_flicker": _flicker,
            },
            "touch_sensor": {"touch_hysteresis": _hysteresis},
        }
    )
)
"""By kind of sensor and effect id, how an effect is made."""

SENSOR_SURPRISES: Mapping[SensorPlantKind, Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "ultrasonic_sensor": {
            "unknown_bent_scale": {"bent_per_m": 0.06},
            "unknown_drift": {"drift_mm_per_min": 30.0},
        },
        "light_sensor": {"unknown_wavy_gradient": {"wave_raw": 12.0}},
        "touch_sensor": {"unknown_creep": {"creep_g_per_min": 6.0}},
    }
)
"""What no library holds."""


def make_sensor_case(
    kind: SensorPlantKind, effects: Sequence[str], seed: int, size: SensorSize = "medium"
) -> SensorCase:
    """Make a concealed case.

    Args:
        kind: of the sensor.
        effects: ids out of `SENSOR_EFFECTS` or `SENSOR_SURPRISES`; none is a clean case.
        seed: of everything random.
        size: of each effect.
    """
    rng = np.random.default_rng(seed)
    changes: dict[str, Any] = {}
    truths: dict[str, Mapping[str, float]] = {}
    for effect in effects:
        if effect in SENSOR_SURPRISES[kind]:
            made = _Made(SENSOR_SURPRISES[kind][effect], {})
        else:
            made = SENSOR_EFFECTS[kind][effect](size, rng)
        changes |= made.changes
        truths[effect] = made.truth
    match kind:
        case "ultrasonic_sensor":
            recordings = _ultrasonic_recordings(changes, rng)
        case "light_sensor":
            recordings = _light_recordings(changes, rng)
        case "touch_sensor":
            recordings, pressed = _touch_recordings(changes, rng)
            truths = {effect: truth or pressed for effect, truth in truths.items()}
    content = {"plant": {"kind": kind}, "recordings": [recording.name for recording in recordings]}
    return SensorCase(content, recordings, truths)


def _stamps(count: int, period_s: float, rng: Generator) -> FloatArray:
    """Polls at about a pace, with the jitter of a host."""
    return np.cumsum(period_s + rng.gamma(2.0, 1.5e-3, count))


def _ultrasonic_recordings(changes: Mapping[str, Any], rng: Generator) -> tuple[Recording, ...]:
    """A sweep square on, and the sensor turned at the paper's distances."""
    sensor = replace(
        EchoMechanism(jitter_us=float(rng.uniform(8.0, 20.0)), truncates=bool(rng.integers(2))), **changes
    )
    swept = np.repeat(np.arange(10.0, 1550.0, float(rng.choice([4.0, 7.0]))), 3)
    angles = np.arange(0.0, 71.0, 5.0)
    turned = np.repeat(np.array([(d, a) for d in _PAPER_DISTANCES_MM for a in angles]), 4, axis=0)
    again = rng.uniform(10.0, 1500.0, 300)
    rows = ((swept, np.zeros(swept.size)), (turned[:, 0], turned[:, 1]), (again, np.zeros(300)))
    recordings = []
    for number, (distance, angle) in enumerate(rows, 1):
        time_s = _stamps(distance.size, 0.06, rng)
        columns = {
            "time_s": time_s,
            "s4_ultrasonic_cm": echoes.readings_cm(sensor, time_s, distance, angle, rng),
            "rig_distance_mm": distance,
            "rig_angle_deg": angle,
        }
        recordings.append(Recording(f"r{number}.csv", columns))
    return tuple(recordings)


def _light_recordings(changes: Mapping[str, Any], rng: Generator) -> tuple[Recording, ...]:
    """The gradient there and back four times; the room's light, if there is any, in two of them."""
    room = float(changes.get("room_raw", 0.0))
    sensor = replace(Photodiode(noise_raw=float(rng.uniform(1.5, 4.0))), **changes)
    recordings = []
    for number in range(1, 5):
        position = 280.0 * (1.0 - np.abs(np.linspace(-1.0, 1.0, 400)))
        time_s = _stamps(position.size, 0.02, rng)
        here = replace(sensor, room_raw=room if number in (2, 4) else 0.0)
        raw = photodiodes.readings_raw(here, time_s, position, float(rng.uniform(0.0, 6.0)), rng)
        recordings.append(
            Recording(f"r{number}.csv", {"time_s": time_s, "s3_light_raw": raw, "rig_position_mm": position})
        )
    return tuple(recordings)


def _touch_recordings(
    changes: Mapping[str, Any], rng: Generator
) -> tuple[tuple[Recording, ...], Mapping[str, float]]:
    """Slow presses and releases, and what the button's forces are."""
    sensor = replace(
        ButtonMechanism(preload_g=float(rng.uniform(0.0, 15.0)), rub_g=float(rng.uniform(0.1, 0.4))),
        **changes,
    )
    recordings = []
    for number in (1, 2, 3):
        top = 90.0 + float(rng.uniform(0.0, 10.0))
        cycle = np.concatenate([np.arange(0.0, top, 0.4), np.arange(top, 0.0, -0.4)])
        force = np.tile(cycle, 8)
        time_s = _stamps(force.size, 0.02, rng)
        told = buttons.readings(sensor, time_s, force, rng)
        recordings.append(
            Recording(f"r{number}.csv", {"time_s": time_s, "s1_touch": told, "rig_force_g": force})
        )
    forces = {
        "press_force_g": buttons.press_force_g(sensor),
        "release_force_g": buttons.release_force_g(sensor),
    }
    return tuple(recordings), forces
