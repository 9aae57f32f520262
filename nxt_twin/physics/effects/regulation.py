"""The regulator of the NXT's firmware in the place of a servo's loop."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.modes import MODE_BRAKE
from nxt_twin.physics.parameter import NUMBER, Parameter

_DEG = math.pi / 180.0
_TERM_MOST = 100.0
_SUM_MOST = 800.0
_OFF = float(MODE_BRAKE)


def _bounded(value: float, most: float) -> float:
    return min(max(value, -most), most)


def _summed(error_sum: float, error: float) -> float:
    """The sum of errors, of which a quarter is forgotten at each run."""
    return _bounded(0.25 * (3.0 * error_sum + error), _SUM_MOST)


def _output(
    error: float, error_then: float, error_sum: float, gain_p: float, gain_i: float, gain_d: float
) -> float:
    """The duty (-1…1) from errors in counts; the firmware clips proportion and sum each by itself."""
    own = _bounded(gain_p * error, _TERM_MOST) + _bounded(gain_i * error_sum, _TERM_MOST)
    return 0.01 * _bounded(0.5 * (own + gain_d * (error - error_then)), _TERM_MOST)


def _regulated(
    duty: float,
    held: float,
    angle: float,
    mode: float,
    setpoint: float,
    output: float,
    error_then: float,
    error_sum: float,
    runs: float,
    gain_p: float,
    gain_i: float,
    gain_d: float,
) -> float:
    """The duty in force: a new one where the setpoint has just moved, which is when the regulator runs.

    Where nobody knows what it did before, it is taken for settled at the present error.
    """
    if mode == _OFF:
        return 0.0 * duty
    error = (held - angle) / _DEG
    if runs == 0.0:
        return _output(error, error, error, gain_p, gain_i, gain_d)
    if held == setpoint:
        return output
    return _output(error, error_then, _summed(error_sum, error), gain_p, gain_i, gain_d)


def _remembered(
    held: float,
    angle: float,
    before: float,
    step_s: float,
    mode: float,
    duty: float,
    setpoint: float,
    output: float,
    error_then: float,
    error_sum: float,
    runs: float,
) -> tuple[float, float, float, float, float]:
    if mode == _OFF:
        return held, 0.0, 0.0, 0.0, 1.0
    if runs > 0.0 and held == setpoint:
        return setpoint, output, error_then, error_sum, runs
    error = (held - (angle - 0.5 * step_s * before)) / _DEG
    return held, duty, error, error if runs == 0.0 else _summed(error_sum, error), 1.0


def _gain(letter: str, firmware: float) -> Parameter:
    return Parameter(
        f"regulation_{letter}",
        f"gain_{letter}",
        "1/32",
        NUMBER,
        (firmware,),
        0.0,
        255.0,
        si=1.0 / 32.0,
        frozen=True,
        otherwise=firmware,
    )


FIRMWARE_REGULATION = Effect(
    id="firmware_regulation",
    name="firmware regulation",
    equation="u = ½·(P·e + I·s + D·Δe) once in 101 ms, s = ¾·s + ¼·e",
    source="LEGO NXT firmware 1.29, d_output.c; without its rounding to whole numbers",
    equation_of="timing",
    shows=("after_command",),
    parameters=(
        _gain("p", 96.0),
        _gain("i", 32.0),
        _gain("d", 32.0),
    ),
    terms={"duty": _regulated, "advance": _remembered},
    states=("setpoint", "output", "error_then", "error_sum", "runs"),
    confusable_with={
        "integral_action": "what drives the motor tells: a recording of `a_regulation` has this regulator",
    },
    frames=("motor",),
    kinds=("servo",),
    supersedes=("integral_action", "goal_rate_limit", "power_limit", "loop_dead_band"),
    inputs=("goal_position_rad",),  # no candidate: a recording says whether the firmware regulates
    plain=True,
)
