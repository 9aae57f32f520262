"""How far simulated readings are off, over what noise makes of single ones."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting import noise
from nxt_twin.physics.observer import Noise


@pytest.fixture
def drift(monkeypatch):
    """The drift for some errors of simulated readings, in standard deviations of single ones."""

    def of(errors):
        target = SimpleNamespace(
            jobs=[None],
            simulating=lambda: None,
            seen=lambda: [np.ones(len(errors), dtype=bool)],
            errors=lambda _number, _result: np.array([errors]),
        )
        monkeypatch.setattr(noise, "with_noise", lambda _target, _noise: target)
        simulator = SimpleNamespace(run=lambda *_: [None])
        plant = SimpleNamespace(vectors=lambda: (np.zeros(1), np.ones(1)))
        return noise.drift_of(simulator, plant, target, Noise(0.01, 1.0, 0.15, 3.0))

    return of


def test_errors_twice_as_large_are_twice_the_drift(drift):
    single = np.random.default_rng(1).normal(0.0, 1.0, 4000)
    assert drift(2.0 * single) == pytest.approx(2.0 * drift(single), rel=1e-3)


@pytest.mark.parametrize(
    "errors", [np.zeros(50), np.full(50, np.inf), np.full(50, np.nan), np.array([0.0, 1e300, -np.inf])]
)
@pytest.mark.filterwarnings("error")
def test_a_motor_held_fast_and_a_simulation_that_ran_away_have_a_drift(drift, errors):
    assert np.isfinite(drift(errors))
    assert drift(errors) > 0.0
