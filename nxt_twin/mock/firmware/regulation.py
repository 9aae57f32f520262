"""The regulators that run every 101 ms: speed, position, and two motors in step.

Source: LEGO NXT firmware 1.29, d_output.c.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, final

from firmware_protocol import RegulationMode
from nxt_twin.mock.firmware.integers import bounded, quotient, remainder, s8, s16
from nxt_twin.mock.firmware.motor import MotorControl

SPEED_MAX: Final = 100
"""In percent; also the counts in 100 ms at that speed, so that a speed is its own change of setpoint."""
_GAIN_DIVISOR: Final = 32
_TERM_MAX: Final = 100
_NO_SATURATION: Final = 0x01

_SYNC: Final = int(RegulationMode.SYNC)


@final
class Synchronisation:
    """The state of a pair's regulator."""

    __slots__ = ("accumulated_error", "old_error", "turned")

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget."""
        self.accumulated_error = 0
        self.old_error = 0
        self.turned = 0


def regulate(
    motors: Sequence[MotorControl], index: int, pair: Synchronisation, period_ms: int, options: int
) -> None:
    """Run one motor's regulator at the end of its period.

    Args:
        motors: all three.
        index: which one.
        pair: the memory of the synchronised pair.
        period_ms: the regulation period in the IO map.
        options: the regulation options in the IO map.
    """
    motor = motors[index]
    if motor.regulation & RegulationMode.POSITION:
        _regulate_position(motor, period_ms, options)
    elif motor.regulation & RegulationMode.SPEED:
        change = _share(motor.target_speed, motor, period_ms)
        error = motor.old_error - motor.period_count + change
        motor.drive_at(_pid(motor, error, options))
    elif motor.regulation & _SYNC:
        two = _second_of_pair(motors, index)
        if two is not None:
            _synchronise(motor, two, pair)


def _pid(motor: MotorControl, error: int, options: int) -> int:
    gain_p, gain_i, gain_d = (gain // _GAIN_DIVISOR for gain in motor.gains)
    error = bounded(error, 32000)
    proportional = error * gain_p
    derivative = (error - motor.old_error) * gain_d
    motor.old_error = error
    motor.accumulated_error = bounded(quotient(motor.accumulated_error * 3 + error, 4), 800)
    integral = motor.accumulated_error * gain_i
    if not options & _NO_SATURATION:
        proportional = bounded(proportional, _TERM_MAX)
        integral = bounded(integral, _TERM_MAX)
    output = quotient(proportional + integral + derivative, 2)
    if abs(output) > SPEED_MAX:
        motor.overloaded = True
    return bounded(output, SPEED_MAX)


def _share(change: int, motor: MotorControl, period_ms: int) -> int:
    """A change per 100 ms as whole counts per period; what rounding leaves is made up for later."""
    whole = quotient(change * period_ms, 100)
    motor.position_fraction += remainder(change * period_ms, 100)
    if motor.position_fraction > 50:
        motor.position_fraction -= 100
        return whole + 1
    if motor.position_fraction < -50:
        motor.position_fraction += 100
        return whole - 1
    return whole


def _regulate_position(motor: MotorControl, period_ms: int, options: int) -> None:
    if motor.max_speed:
        _plan_speed(motor, motor.limit_count - motor.position_target, period_ms)
        motor.position_target += _share(motor.target_speed, motor, period_ms)
    else:
        motor.position_target = motor.limit_count
    motor.drive_at(_pid(motor, motor.position_target - motor.count, options))


def _plan_speed(motor: MotorControl, way: int, period_ms: int) -> None:
    """The speed from which the motor can still stop in time, reached with no more than its acceleration."""
    distance = abs(way)
    if motor.max_acceleration and distance < SPEED_MAX * SPEED_MAX // 2:
        wanted = int(math.sqrt(max(0, 2 * distance * motor.max_acceleration)))
        wanted = bounded(wanted, motor.max_speed)
    else:
        wanted = min(distance, motor.max_speed)
    change = (-wanted if way < 0 else wanted) - motor.target_speed
    if motor.max_acceleration:
        step = quotient(motor.max_acceleration * period_ms, 100)
        motor.speed_fraction += remainder(motor.max_acceleration * period_ms, 100)
        if motor.speed_fraction > 50:
            motor.speed_fraction -= 100
            step += 1
        change = bounded(change, step)
    motor.target_speed = s8(motor.target_speed + change)


def _second_of_pair(motors: Sequence[MotorControl], index: int) -> MotorControl | None:
    """The motor that this one leads: A leads B, else C; B leads C."""
    for other in motors[index + 1 :]:
        if other.regulation & _SYNC:
            return other
    return None


def _synchronise(one: MotorControl, two: MotorControl, pair: Synchronisation) -> None:
    gain_p, gain_i, gain_d = (gain // _GAIN_DIVISOR for gain in one.gains)
    pair.turned += 2 * _turn_rate(one, two)
    difference = bounded(one.block_count - two.block_count + pair.turned, 500)
    proportional = difference * gain_p
    derivative = (difference - pair.old_error) * gain_d
    pair.old_error = difference
    pair.accumulated_error = bounded(s16(pair.accumulated_error + difference), 900)
    integral = pair.accumulated_error * gain_i
    correction = quotient(proportional + integral + derivative, 4)
    turning = one.turn != 0
    one.drive_at(_corrected(one.target_speed, -correction, turning=turning))
    two.drive_at(_corrected(two.target_speed, correction, turning=turning))


def _turn_rate(one: MotorControl, two: MotorControl) -> int:
    if one.turn == 0:
        return 0
    if one.block_count == 0 and two.block_count == 0:
        return one.turn
    forward = one.target_speed >= 0
    inner = two if forward == (one.turn > 0) else one
    return quotient(inner.turn * (inner.target_speed if forward else -inner.target_speed), 100)


def _corrected(target: int, correction: int, *, turning: bool) -> int:
    speed = bounded(target + correction, SPEED_MAX)
    return bounded(speed, abs(target)) if turning else speed
