"""Elementary functions that compile to plain arithmetic, for the terms of a kernel's step.

They are no faster than those of the mathematics library. But a call of the library, even one that is not reached, keeps
all quantities of the step out of the processor's registers. Each docstring states the error, which is far below that
of a step. Code outside the step uses the library.
"""

from __future__ import annotations

import math

import numpy as np

_ROUNDING = 1.5 * 2.0**52
"""Added to a number, it leaves the nearest whole one in the lowest bits; taken off again, that number."""

_PI_LOW = 1.2246467991473532e-16  # what the double nearest to π lacks
_LN2_HIGH = math.ldexp(
    round(math.ldexp(math.log(2.0), 32)), -32
)  # so short that its products with exponents are exact
_LN2_LOW = math.log(2.0) - _LN2_HIGH
_MOST = 700.0
_LEAST = 1e-300
_MANTISSA_BITS = 52
_BIAS = 1023
_SIGN_BIT = 63
_ROOT_HALF_BITS = 0x3FE6A09E667F3BCD  # of √½, from which to √2 mantissas are taken


def sine(x: float) -> float:
    """sin(x) for x in rad, to 1e-11 for |x| below 1e4: Taylor's series around the nearest zero."""
    shifted = x * (1.0 / math.pi) + _ROUNDING
    turns = shifted - _ROUNDING
    r = (x - turns * math.pi) - turns * _PI_LOW
    s = r * r
    q = s * s
    low = (1.0 - s * (1.0 / 6.0)) + q * (1.0 / 120.0 - s * (1.0 / 5040.0))
    high = (1.0 / 362880.0 - s * (1.0 / 39916800.0)) + q * (1.0 / 6227020800.0 - s * (1.0 / 1307674368000.0))
    unsigned = np.float64(r * (low + q * q * high)).view(np.int64)
    odd = np.int64(np.float64(shifted).view(np.int64) << _SIGN_BIT)
    return float(np.int64(unsigned ^ odd).view(np.float64))


def cosine(x: float) -> float:
    """cos(x) for x in rad, to 1e-11 for |x| below 1e4."""
    return sine(x + 0.5 * math.pi)


def exponential(x: float) -> float:
    """exp(x), to a relative 1e-10; x is taken into ±700, beyond which it is next to nothing or too much to use."""
    held = min(max(x, -_MOST), _MOST)
    shifted = held * (1.0 / math.log(2.0)) + _ROUNDING
    doublings = shifted - _ROUNDING
    r = (held - doublings * _LN2_HIGH) - doublings * _LN2_LOW
    s = r * r
    q = s * s
    low = (1.0 + r) + s * (0.5 + r * (1.0 / 6.0))
    middle = (1.0 / 24.0 + r * (1.0 / 120.0)) + s * (1.0 / 720.0 + r * (1.0 / 5040.0))
    high = 1.0 / 40320.0 + r * (1.0 / 362880.0)
    scale = np.int64((np.float64(shifted).view(np.int64) + _BIAS) << _MANTISSA_BITS).view(np.float64)
    return float(scale * (low + q * (middle + q * high)))


def logarithm(x: float) -> float:
    """ln(x) for x from 1e-300 to 1e300, to 1e-10: the series in (m - 1)/(m + 1) of its mantissa m."""
    bits = np.float64(x).view(np.int64)
    exponent = (bits - _ROOT_HALF_BITS) >> _MANTISSA_BITS
    mantissa = np.int64(bits - (exponent << _MANTISSA_BITS)).view(np.float64)
    s = (mantissa - 1.0) / (mantissa + 1.0)
    q = s * s
    w = q * q
    low = (1.0 + q * (1.0 / 3.0)) + w * (1.0 / 5.0 + q * (1.0 / 7.0))
    series = low + w * w * (1.0 / 9.0 + q * (1.0 / 11.0))
    return float(exponent * _LN2_HIGH + (2.0 * s * series + exponent * _LN2_LOW))


def power(x: float, exponent: float) -> float:
    """The power of x ≥ 0 with a positive exponent, to a relative 1e-9 where the result is from 1e-3 to 1e3.

    The logarithm is taken whether or not x is zero: a branch around it keeps lanes from going abreast.
    """
    some = 1.0 if x > 0.0 else 0.0
    return some * exponential(exponent * logarithm(max(x, _LEAST)))
