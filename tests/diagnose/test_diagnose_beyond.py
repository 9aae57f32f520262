"""A free function beside the effects that were found: its sizes, and what it does to a simulation."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.where.beyond import with_shapes
from nxt_twin.diagnose.where.marginal import likeliest
from nxt_twin.diagnose.where.response import free_response

READINGS = 400
STEP_S = 0.01


def linear(innovations, slopes):
    """A fitted structure of which only a regression is known."""
    nothing = SimpleNamespace()
    return Linear(
        structure=nothing,
        jobs=(),
        counted=(),
        innovations=innovations,
        slopes=slopes,
        tightness=np.full(len(slopes), 1e-6),
        run=np.zeros(READINGS, dtype=np.int64),
        time_s=np.arange(READINGS) * STEP_S,
        checks=np.zeros(READINGS, dtype=np.bool_),
        gain=(),
        predicted=(),
    )


def drawn():
    rng = np.random.default_rng(5)
    return rng.normal(size=READINGS), rng.normal(size=(2, READINGS)), rng.normal(size=(3, READINGS))


def test_the_sizes_of_missing_rows_are_found_beside_the_variables_of_a_refit():
    noise, slopes, rows = drawn()
    innovations = noise + np.array([3.0, 0.0, -2.0]) @ rows + np.array([0.5, -1.0]) @ slopes
    missing = likeliest(linear(innovations, slopes), [rows[:, :150], rows[:, 150:]])
    np.testing.assert_allclose(missing.sizes, [3.0, 0.0, -2.0], atol=0.2)
    np.testing.assert_allclose(missing.moves, [0.5, -1.0], atol=0.2)
    assert missing.nats > 500.0


def test_noise_alone_asks_for_no_rows():
    noise, slopes, rows = drawn()
    assert likeliest(linear(noise, slopes), [rows]).nats < 3.0


def test_a_missing_torque_adds_up_from_each_start_of_a_simulation():
    time_s = np.arange(100) * STEP_S
    anew = np.isin(np.arange(100), [10, 50])
    standing = np.zeros(100, dtype=np.bool_)
    found = free_response(
        SimpleNamespace(time_s=time_s, is_speed=False),
        anew,
        SimpleNamespace(standing=standing),
        SimpleNamespace(damping_per_s=0.0, disturbance_time_s=1.0),
        np.full((1, 100), 8.0),
        "torque",
    )[0]
    assert not found[:11].any()
    assert found[49] == pytest.approx(4.0 * 0.39**2)
    assert found[50] == 0.0
    assert found[99] == pytest.approx(4.0 * 0.49**2)


@pytest.mark.parametrize("changes", [{"found": False}, {"by_windows": True}, {"remaining": 1.9}])
def test_shapes_are_asked_only_where_found_effects_leave_an_error_that_matters(changes):
    record = SimpleNamespace(**({"found": True, "by_windows": False, "remaining": 5.0} | changes))
    evidence = SimpleNamespace(record=record)
    assert with_shapes(SimpleNamespace(), evidence) is evidence
