"""A true motor on a bench, driven by hand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from nxt_twin.blind.truth import integrator
from nxt_twin.blind.truth.motor import Motor, as_record

States = NDArray[np.float64]
Drive = Callable[..., States]


@pytest.fixture
def drive() -> Drive:
    """Run a motor: `drive(motor, duty, seconds, …)` gives the states at each millisecond."""

    def run(
        motor: Motor, duty: float | NDArray[np.float64], seconds: float, *, mode=0, start_deg=0.0, speed=0.0
    ) -> States:
        time_s = np.arange(0.0, seconds + 5e-4, 1e-3)
        start = np.zeros(integrator.STATES)
        start[[integrator.THETA, integrator.THETA_LOAD]] = np.deg2rad(start_deg)
        start[[integrator.OMEGA, integrator.OMEGA_LOAD]] = speed
        states = np.zeros((time_s.size, integrator.STATES))
        integrator.integrate(
            as_record(motor),
            start,
            time_s,
            np.broadcast_to(np.asarray(duty, dtype=np.float64), time_s.shape).copy(),
            np.full(time_s.size, mode, dtype=np.int64),
            np.zeros(time_s.size),
            states,
            np.zeros(time_s.size),
        )
        return states

    return run
