"""Laws with a shape of their own: second harmonics, and how a driver's curve bends."""

import numpy as np
import pytest
from scipy.optimize import brentq

from nxt_twin.physics.effects.electrical import POWER_CURVE
from nxt_twin.physics.effects.encoder import ENCODER_ECCENTRICITY
from nxt_twin.physics.effects.friction import FRICTION_CREEP
from nxt_twin.physics.effects.load import COGGING

TURNS = np.linspace(-3.0, 3.0, 41)


@pytest.mark.parametrize(("in_phase", "in_quadrature"), [(0.0, 0.0), (0.2, 0.0), (-0.1, 0.3)])
def test_cogging_is_a_sum_of_two_harmonics(in_phase, in_quadrature):
    torque = [COGGING.terms["torque"](a, 0.02, 3.0, 0.4, in_phase, in_quadrature) for a in TURNS]
    x = 3.0 * TURNS + 0.4
    wave = np.real((1.0 + 0.0j) * np.exp(1j * x) + (in_phase - 1j * in_quadrature) * np.exp(2j * x))
    assert torque == pytest.approx(0.02 * wave, abs=1e-10)


@pytest.mark.parametrize(("in_phase", "in_quadrature"), [(0.0, 0.0), (0.2, 0.0), (-0.1, 0.3)])
def test_an_eccentric_encoder_errs_by_two_harmonics_and_shows_the_slope_of_both(in_phase, in_quadrature):
    off = ENCODER_ECCENTRICITY.terms["reading"]
    shape = (0.05, 2.0, 0.4, in_phase, in_quadrature)
    x = 2.0 * TURNS + 0.4
    wave = np.imag(np.exp(1j * x) + (in_phase + 1j * in_quadrature) * np.exp(2j * x))
    assert [off(a, 0.0, *shape)[0] for a in TURNS] == pytest.approx(0.05 * wave, abs=1e-12)
    step, speed = 1e-6, 3.0
    for a in TURNS:
        ahead, behind = (off(a + way * step, 0.0, *shape)[0] for way in (1.0, -1.0))
        assert off(a, speed, *shape)[1] == pytest.approx(speed * (ahead - behind) / (2.0 * step), abs=1e-7)


@pytest.mark.parametrize("bend", [-0.4, 0.0, 0.6])
def test_a_power_curve_goes_through_nothing_and_all_whatever_its_bend(bend):
    curve = POWER_CURVE.terms["duty"]
    assert curve(0.0, 1.3, bend) == 0.0
    assert [curve(u, 1.3, bend) for u in (-1.0, 1.0)] == pytest.approx([-1.0, 1.0])
    assert curve(0.5, 1.3, bend) == pytest.approx(0.5**1.3)
    assert curve(-0.25, 1.3, bend) == pytest.approx(-(0.25 ** (1.3 - 0.25 * bend)))
    levels = np.array([curve(u, 1.3, bend) for u in np.linspace(0.0, 1.0, 101)])
    assert np.all(np.diff(levels) > 0.0)


@pytest.mark.parametrize("bite", [1e-6, 0.01, 0.3, 5.0])
@pytest.mark.parametrize("creep_speed", [1e-3, 0.05, 2.0])
def test_a_creeping_speed_solves_its_step_on_either_side_of_sliding(bite, creep_speed):
    for free in [*(bite * np.array([0.0, 0.01, 0.5, 0.95, 1.0, 1.05, 3.0])), 20.0]:
        right = brentq(
            lambda x, free=free: x + bite * np.tanh(x / creep_speed) - free, -1.0, 30.0, xtol=1e-14
        )
        for way in (1.0, -1.0):
            found = FRICTION_CREEP.terms["creep"](0.0, way * free, bite, creep_speed)
            assert found == pytest.approx(way * right, rel=0.02, abs=1e-6)
