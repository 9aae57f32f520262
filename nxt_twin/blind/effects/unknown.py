"""Concealed physics that no library holds; the right answer is to say that it is unknown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation
from nxt_twin.blind.kinds import Equation
from nxt_twin.blind.truth import surprises

Sampler = Callable[[Situation], Draw]


def _surprise(kind: int, a: float, b: float = 0.0, c: float = 0.0, d: float = 0.0) -> Draw:
    numbers = {"surprise_a": a, "surprise_b": b, "surprise_c": c, "surprise_d": d}
    return Draw(params=dict(numbers), motor={"surprise": float(kind), **numbers})


def _switching_detent(now: Situation) -> Draw:
    torque = now.sized((0.01, 0.02), (0.03, 0.045), (0.06, 0.09))
    cycles, below = now.one_of(2.0, 3.0, 5.0), now.between(2.0, 5.0)
    return _surprise(surprises.SWITCHING_DETENT, torque, cycles, below, now.angle_rad())


def _angle_speed_drag(now: Situation) -> Draw:
    slope = now.sized((2e-3, 3e-3), (4.5e-3, 7e-3), (9e-3, 12e-3))
    return _surprise(surprises.ANGLE_SPEED_DRAG, slope, now.one_of(1.0, 2.0), d=now.angle_rad())


def _amplifier_memory(now: Situation) -> Draw:
    share = now.sized((0.8, 1.0), (0.5, 0.65), (0.3, 0.4))
    return _surprise(surprises.AMPLIFIER_MEMORY, share, now.between(0.3, 0.8))


def _resonant_fan(now: Situation) -> Draw:
    drag = now.sized((2e-5, 3e-5), (4e-5, 6e-5), (8e-5, 1.2e-4))
    return _surprise(
        surprises.RESONANT_FAN, drag, now.between(6.0, 10.0), now.between(6.0, 9.0), now.between(0.6, 1.2)
    )


def _belt_slip(now: Situation) -> Draw:
    slip = now.sized((8e-3, 12e-3), (16e-3, 24e-3), (30e-3, 50e-3))
    return _surprise(surprises.BELT_SLIP, now.between(2e-3, 5e-3), slip, now.between(5e-5, 2e-4))


def _periodic_push(now: Situation) -> Draw:
    torque = now.sign() * now.sized((0.02, 0.04), (0.07, 0.11), (0.15, 0.25))
    period_s, push_s = now.between(1.7, 3.5), now.between(0.25, 0.6)
    return _surprise(surprises.PERIODIC_PUSH, torque, period_s, push_s, now.between(0.2, 1.5))


def _shaken_grease(now: Situation) -> Draw:
    slope = now.sized((4e-3, 6e-3), (9e-3, 14e-3), (20e-3, 35e-3))
    return _surprise(surprises.SHAKEN_GREASE, slope, now.between(0.3, 1.5), now.between(10.0, 30.0))


def _swapped_sense(now: Situation) -> Draw:
    window_s = now.sized((0.04, 0.06), (0.1, 0.15), (0.25, 0.4))
    return _surprise(surprises.SWAPPED_SENSE, now.between(1.7, 4.0), window_s, now.between(0.3, 1.5))


def _one_sided_ripple(now: Situation) -> Draw:
    share = now.sized((0.15, 0.25), (0.35, 0.5), (0.65, 0.9))
    return _surprise(surprises.ONE_SIDED_RIPPLE, share, now.one_of(1.0, 2.0, 3.0), d=now.angle_rad())


def _pawl(now: Situation) -> Draw:
    torque = now.sized((0.012, 0.02), (0.03, 0.05), (0.07, 0.11))
    return _surprise(surprises.PAWL, torque, now.one_of(1.0, 2.0, 3.0), 0.05, now.angle_rad())


def _rising_slew(now: Situation) -> Draw:
    return _surprise(surprises.RISING_SLEW, now.sized((12.0, 20.0), (4.0, 7.0), (1.2, 2.5)))


def _thermal_foldback(now: Situation) -> Draw:
    budget = now.sized((0.25, 0.35), (0.1, 0.15), (0.04, 0.06))
    return _surprise(surprises.THERMAL_FOLDBACK, budget, now.between(1.0, 4.0))


def _speed_band_push(now: Situation) -> Draw:
    torque = now.sign() * now.sized((0.01, 0.016), (0.025, 0.04), (0.06, 0.09))
    return _surprise(surprises.SPEED_BAND_PUSH, torque, now.between(4.0, 8.0), now.between(0.8, 1.5))


def _lost_film(now: Situation) -> Draw:
    torque = now.sized((0.01, 0.016), (0.025, 0.04), (0.06, 0.09))
    return _surprise(surprises.LOST_FILM, torque, now.between(8.0, 10.0), now.between(1.5, 3.0))


_SAMPLERS: Final[dict[str, tuple[Equation, Sampler]]] = {
    "switching_detent": ("torque_balance", _switching_detent),
    "angle_speed_drag": ("torque_balance", _angle_speed_drag),
    "amplifier_memory": ("electrical", _amplifier_memory),
    "resonant_fan": ("torque_balance", _resonant_fan),
    "belt_slip": ("kinematic", _belt_slip),
    "periodic_push": ("torque_balance", _periodic_push),
    "shaken_grease": ("torque_balance", _shaken_grease),
    "swapped_sense": ("measurement", _swapped_sense),
    "one_sided_ripple": ("electrical", _one_sided_ripple),
    "pawl": ("torque_balance", _pawl),
    "rising_slew": ("electrical", _rising_slew),
    "thermal_foldback": ("electrical", _thermal_foldback),
    "speed_band_push": ("torque_balance", _speed_band_push),
    "lost_film": ("torque_balance", _lost_film),
}

UNKNOWN: tuple[ConcealedEffect, ...] = tuple(
    ConcealedEffect(
        name, equation, sampler, known=False, clashes=tuple(other for other in _SAMPLERS if other != name)
    )
    for name, (equation, sampler) in _SAMPLERS.items()
)
