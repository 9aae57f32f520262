"""A plain fit of windows goes where they lead, however far from the given numbers, unless they tell next to nothing."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting import free_windows
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.free_windows import fitted_freely
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.diagnose.judging.floors import synthetic
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.recording import Recording, SignalKinds

pytestmark = pytest.mark.usefixtures("one_by_one")

VISCOUS, GIVEN = 5e-2, 1.5
TRUTH = {"kind": "rigid_body", "inertia": 1e-2, "viscous_friction": VISCOUS, "coulomb_friction": 2e-2}
KINDS = SignalKinds("torque_nm", "position_rad")
TIME_S = np.arange(0.0, 6.0, 0.02)
TORQUE = np.random.default_rng(2).uniform(-0.3, 0.3, 60)[(TIME_S / 0.4).astype(int)]


def problem(plant, output):
    columns = {"time_s": TIME_S, "input": TORQUE, "output": output}
    return problem_of("case", plant, [Recording("r", columns, KINDS)], [], None)


@pytest.fixture(scope="module")
def recorded():
    """Readings of the truth, nearly without noise."""
    own = problem(TRUTH, np.cumsum(TORQUE))
    with Simulator(own.plant.layout) as simulator:
        noise = replace(first_noise(own.plant, own.signals, 0.1), reading_std=1e-3, disturbance_std=0.0)
        return synthetic(simulator, own.plant, own.signals[0], noise, np.random.default_rng(1)).measured


def viscous(recorded, error):
    """The viscous friction that a plain fit finds from thirty times its value."""
    own = problem({**TRUTH, "viscous_friction": GIVEN}, recorded)
    with Simulator(own.plant.layout) as simulator:
        fitted = fitted_freely(Fitter(simulator, own), own.plant, error)
    return fitted.values[Slot("viscous_friction", "viscous")]


@pytest.mark.parametrize(("times", "near"), [(1.0, True), (0.5, False)])
def test_windows_lead_a_plain_fit_far_away_from_given_numbers(recorded, monkeypatch, times, near):
    monkeypatch.setattr(free_windows, "_WIDER", times * free_windows._WIDER)
    assert (viscous(recorded, 3.0) == pytest.approx(VISCOUS, rel=0.1)) is near


@pytest.mark.parametrize(("times", "stays"), [(1.0, True), (2.0, False)])
def test_given_numbers_stay_where_windows_tell_next_to_nothing(recorded, monkeypatch, times, stays):
    monkeypatch.setattr(free_windows, "_WIDER", times * free_windows._WIDER)
    assert (viscous(recorded, 10.0) == pytest.approx(GIVEN, rel=0.1)) is stays
