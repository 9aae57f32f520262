"""Elementary functions of the step beside those of the mathematics library, as far as their docstrings promise."""

import functools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from numba.extending import register_jitable

from nxt_twin.physics import inline

OF_ONE = "float64(float64)"
OF_TWO = "float64(float64, float64)"
BOTH_WAYS = pytest.mark.parametrize("compiled", [False, True])


def functions(compiled, name):
    return compiled_function(name) if compiled else getattr(inline, name)


@functools.cache
def compiled_function(name):
    """Compiled at its first use: compiling while tests are collected would cost every worker half a minute."""
    for helper in (inline.sine, inline.exponential, inline.logarithm):
        register_jitable(helper)
    signature = OF_TWO if name == "power" else OF_ONE
    return njit(signature, error_model="numpy", fastmath={"contract", "arcp"})(getattr(inline, name))


@BOTH_WAYS
@given(x=st.floats(-1e4, 1e4))
def test_sine_and_cosine(compiled, x):
    assert functions(compiled, "sine")(x) == pytest.approx(math.sin(x), abs=1e-11)
    assert functions(compiled, "cosine")(x) == pytest.approx(math.cos(x), abs=1e-11)


@BOTH_WAYS
@given(x=st.floats(-700.0, 700.0))
def test_exponential(compiled, x):
    assert functions(compiled, "exponential")(x) == pytest.approx(math.exp(x), rel=1e-10)


@BOTH_WAYS
def test_an_exponential_beyond_use_is_next_to_nothing_or_finite(compiled):
    exponential = functions(compiled, "exponential")
    assert 0.0 <= exponential(-math.inf) < 1e-300
    assert exponential(-1e9) < 1e-300
    assert 1e300 < exponential(math.inf) < math.inf


@BOTH_WAYS
@given(x=st.floats(1e-300, 1e300))
def test_logarithm(compiled, x):
    assert functions(compiled, "logarithm")(x) == pytest.approx(math.log(x), rel=1e-10, abs=1e-10)


@BOTH_WAYS
@given(x=st.floats(1e-3, 1e3), exponent=st.floats(-1.0, 1.0))
def test_power(compiled, x, exponent):
    assert functions(compiled, "power")(x, exponent) == pytest.approx(x**exponent, rel=1e-9)


@BOTH_WAYS
def test_nothing_to_a_power_is_nothing_and_one_is_one(compiled):
    power = functions(compiled, "power")
    assert power(0.0, 1.3) == 0.0
    assert power(1.0, 40.0) == pytest.approx(1.0, abs=1e-12)
