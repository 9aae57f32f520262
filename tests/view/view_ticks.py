"""Made-up but lifelike polls of a live session: three motors, of which one meets a torque its model does not have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event, Innovation, MotorBelief, Tick

POLL_S = 0.02
ONSET_S = 6.0
CHANNELS = ("s1_light_raw", "s4_ultrasonic_cm")
PORTS: tuple[Port, ...] = ("a", "b", "c")


def some_ticks(count: int = 600, *, ports: tuple[Port, ...] = PORTS, seed: int = 1) -> list[Tick]:
    """Polls at 50 Hz; from `ONSET_S` on, motor a feels a drag."""
    return list(_ticks(count, ports, np.random.default_rng(seed)))


def _ticks(count: int, ports: tuple[Port, ...], random: np.random.Generator) -> Iterator[Tick]:
    late_s = 0.0
    for number in range(count):
        sent_s = number * POLL_S + late_s
        received_s = sent_s + 0.006 + abs(random.normal(0.0, 0.002))
        readings = [_tacho(port, received_s, random) for port in ports]
        readings.append(
            _reading("s1_light_raw", "raw", received_s, 480 + 60 * math.sin(received_s), 6.0, random)
        )
        if number % 5 == 0:
            readings.append(
                _reading(
                    "s4_ultrasonic_cm", "cm", received_s, 40 + 25 * math.sin(0.4 * received_s), 0.7, random
                )
            )
        yield Tick(
            number=number,
            sent_s=sent_s,
            received_s=received_s,
            motors=tuple(_motor(port, received_s, random) for port in ports),
            innovations=tuple(readings),
            battery_v=7.9 - 0.002 * received_s + random.normal(0.0, 0.01) if number % 50 == 0 else None,
        )


def _motion(port: Port, time_s: float) -> tuple[float, float]:
    rate = {"a": 0.5, "b": 0.8, "c": 0.3}[port]
    return 700 / rate * (1 - math.cos(rate * time_s)), 700 * math.sin(rate * time_s)


def _tacho(port: Port, time_s: float, random: np.random.Generator) -> Innovation:
    angle, speed = _motion(port, time_s)
    off = 0.004 * speed if port == "a" and time_s > ONSET_S else 0.0
    measured = float(math.floor(angle + off + random.normal(0.0, 0.7)))
    return Innovation(time_s, f"{port}_tacho_deg", "deg", measured, angle - 0.5, 0.8)


def _reading(
    channel: str, unit: str, time_s: float, model: float, std: float, random: np.random.Generator
) -> Innovation:
    stray = random.random() < 0.02
    measured = 255.0 if stray and unit == "cm" else round(model + random.normal(0.0, std))
    return Innovation(time_s, channel, unit, measured, model, std**2, accepted=measured != 255.0)


def _motor(port: Port, time_s: float, random: np.random.Generator) -> MotorBelief:
    angle, speed = _motion(port, time_s)
    dragged = port == "a" and time_s > ONSET_S
    torque = (-3e-5 * speed if dragged else 0.0) + random.normal(0.0, 1.5e-3)
    sure = 1 / (1 + math.exp(-(time_s - ONSET_S - 1.5) * 3)) if port == "a" else 0.02
    return MotorBelief(
        port=port,
        power_pct=60.0 if math.sin(time_s) > 0 else -60.0,
        mode="drive",
        angle_deg=angle,
        speed_deg_per_s=speed,
        current_a=0.1,
        unknown_torque_nm=torque,
        unknown_torque_std_nm=3e-3,
        effects={"nothing": 1 - sure, "viscous_friction": 0.6 * sure, "constant_load": 0.4 * sure},
    )


def some_events() -> list[Event]:
    """What a session with `some_ticks` says."""
    return [
        Event(0.0, "started", "The session began: motors A, B and C, ultrasonic on 4, light on 1."),
        Event(
            7.2, "divergence", "Motor A departs from its model since 6.0 s.", "a", onset_s=6.0, strength=31.0
        ),
        Event(
            8.9, "effect_named", "Motor A: viscous friction explains it, 88 % probable.", "a", strength=0.88
        ),
        Event(9.5, "low_battery", "The battery is low: 6.4 V."),
    ]


def in_order(ticks: list[Tick], events: list[Event]) -> list[Tick | Event]:
    """Both, by time."""
    both: list[Tick | Event] = [*ticks, *events]
    return sorted(both, key=lambda each: each.received_s if isinstance(each, Tick) else each.time_s)


def grows(values: list[float]) -> bool:
    """Whether each is larger than the one before."""
    return all(after > before for before, after in pairwise(values))
