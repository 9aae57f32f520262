"""The ramps and limits of running motors, singly and in pairs.

Source: LEGO NXT firmware 1.29, d_output.c.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from firmware_protocol import RegulationMode, RunState
from nxt_twin.mock.firmware.integers import quotient, s8, s16, sign_of
from nxt_twin.mock.firmware.motor import COUNT_MAX, MotorControl

SPEED_MIN: Final = 10
"""Ramps start and end at this speed."""
_STALL_TICKS: Final = 100

_SYNC: Final = int(RegulationMode.SYNC)
_SPEED: Final = int(RegulationMode.SPEED)


def ramp_up(motor: MotorControl) -> None:
    """One tick of a ramp up: 1 % more for each equal share of the way."""
    direction = sign_of(motor.set_speed)
    if motor.target_speed == 0:
        motor.target_speed = direction * SPEED_MIN
    else:
        if motor.ramp_step == 0:
            way = motor.limit_count - motor.ramp_start
            motor.ramp_step = s16(quotient(way, motor.set_speed - motor.target_speed))
            motor.ramp_last = motor.count
        _climb(motor, direction)
    if direction * motor.count >= direction * motor.limit_count:
        motor.target_speed = motor.set_speed
        motor.run_state = RunState.IDLE
    if direction * motor.target_speed > direction * motor.set_speed:
        motor.target_speed = motor.set_speed
    if motor.regulation == RegulationMode.IDLE:
        motor.actual_speed = motor.target_speed


def _climb(motor: MotorControl, direction: int) -> None:
    if direction * (motor.count - motor.ramp_last) > motor.ramp_step:
        motor.target_speed = s8(motor.target_speed + direction)
        motor.ramp_last = motor.count
        motor.ramp_stall = 0
    elif not motor.regulation & _SPEED:
        motor.ramp_stall += 1
        if motor.ramp_stall > _STALL_TICKS:
            motor.ramp_stall = 0
            motor.target_speed = s8(motor.target_speed + direction)


def ramp_down(motors: Sequence[MotorControl], motor: MotorControl) -> None:
    """One tick of a ramp down: 1 % less for each equal share of the way, more power where it stalls."""
    direction = sign_of(motor.target_speed)
    if motor.ramp_step == 0:
        steps = motor.target_speed - motor.set_speed
        if motor.set_speed == 0 and direction * motor.target_speed > SPEED_MIN:
            steps -= direction * SPEED_MIN
        motor.ramp_step = s16(quotient(motor.limit_count - motor.count, steps))
        motor.ramp_last = motor.count
    _descend(motors, motor, direction)
    if motor.regulation & _SYNC and motor.turn:
        end_pair_at_limit(motors, motor)
        if motor.run_state == RunState.IDLE:
            _end_ramp_down(motors, motor)
    else:
        direction = sign_of(motor.target_speed)
        if direction * motor.count >= direction * motor.limit_count:
            _end_ramp_down(motors, motor)
    if motor.regulation == RegulationMode.IDLE:
        motor.actual_speed = motor.target_speed


def _descend(motors: Sequence[MotorControl], motor: MotorControl, direction: int) -> None:
    if direction * (motor.count - motor.ramp_last) > motor.ramp_step:
        slower = direction * motor.target_speed - 1
        motor.target_speed = direction * max(slower, SPEED_MIN)
        motor.ramp_last = motor.count
        motor.ramp_stall = 0
        _slow_partner(motors, motor)
    elif not motor.regulation & _SPEED:
        motor.ramp_stall = (motor.ramp_stall + 1) & 0xFFFF
        if motor.ramp_stall > (30 * motor.ramp_step & 0xFFFF):
            motor.ramp_stall = 20 * motor.ramp_step & 0xFFFF
            motor.target_speed = s8(motor.target_speed + direction)


def _slow_partner(motors: Sequence[MotorControl], motor: MotorControl) -> None:
    other = partner(motors, motor)
    if other is None or motor.turn == 0:
        return
    direction = 1 if motor.target_speed >= 0 else -1
    if direction * other.actual_speed < 0:
        other.target_speed = s8(other.target_speed - direction)


def _end_ramp_down(motors: Sequence[MotorControl], motor: MotorControl) -> None:
    pair = [motor]
    if motor.regulation & _SYNC:
        other = partner(motors, motor)
        pair += [other] if other else []
        motor.set_speed = 0
    for each in pair:
        if motor.set_speed == 0:
            each.set_speed = each.target_speed = each.actual_speed = 0
        each.stop()


def run(motors: Sequence[MotorControl], motor: MotorControl) -> None:
    """One tick of running: an end at the limit, or a limit that follows the count."""
    if motor.regulation & RegulationMode.POSITION:
        return
    if motor.run_forever:
        if motor.count > COUNT_MAX:
            motor.count = 0
        if motor.target_speed:
            motor.limit_count = motor.count
    elif motor.regulation & _SYNC:
        end_pair_at_limit(motors, motor)
    elif motor.set_speed:
        direction = sign_of(motor.set_speed)
        if direction * motor.count >= direction * motor.limit_count:
            motor.stop()
    if motor.regulation == RegulationMode.IDLE:
        motor.actual_speed = motor.target_speed


def partner(motors: Sequence[MotorControl], motor: MotorControl) -> MotorControl | None:
    """The first other motor that is synchronised."""
    for other in motors:
        if other is not motor and other.regulation & _SYNC:
            return other
    return None


def end_pair_at_limit(motors: Sequence[MotorControl], motor: MotorControl) -> None:
    """Stop a synchronised pair when its limit is reached: by either motor, or in a turn by the faster one."""
    other = partner(motors, motor)
    if other is None:
        return
    if motor.turn == 0:
        direction = sign_of(motor.set_speed)
        if motor.set_speed and any(direction * m.count >= direction * m.limit_count for m in (motor, other)):
            motor.run_state = other.run_state = RunState.IDLE
        return
    watched = other if motor.turn > 0 else motor
    direction = 1 if watched.target_speed >= 0 else -1
    leader = watched if direction > 0 else (motor if watched is other else other)
    if direction * leader.count >= direction * leader.limit_count:
        motor.run_state = other.run_state = RunState.IDLE
        follower = motor if leader is other else other
        follower.count = leader.count
        follower.limit_count = leader.limit_count
