"""The floor: what a correct model would reach on recordings like these."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.consistency import home
from benchmarks.consistency import problem_of as problem_of_made
from nxt_twin.diagnose.fitting.fit import Fitted, Variable
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging import floors
from nxt_twin.diagnose.judging.doubt import drawn, straying
from nxt_twin.diagnose.judging.floors import _at_the_floor, refitted_floors, synthetic
from nxt_twin.diagnose.judging.horizons import Errors, errors_of
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.recording import Recording, SignalKinds

pytestmark = pytest.mark.usefixtures("one_by_one")

PLANT = {"kind": "rigid_body", "inertia": 1e-2, "viscous_friction": 5e-2, "coulomb_friction": 2e-2}
KINDS = SignalKinds("torque_nm", "position_rad")
SURE = np.zeros((0, 0))  # of the variables of a plant that has none


def bench(seconds=12.0, rate_hz=50.0):
    """A case that is only there for its inputs and stamps."""
    time_s = np.arange(0.0, seconds, 1.0 / rate_hz)
    torque = np.random.default_rng(2).uniform(-0.3, 0.3, 60)[(time_s / 0.4).astype(int)]
    columns = {"time_s": time_s, "input": torque, "output": np.cumsum(torque)}
    return problem_of("case", PLANT, [Recording("r", columns, KINDS)], [], None)


@pytest.fixture(scope="module")
def made():
    """A problem whose plant is the truth, its noise, and a simulator."""
    problem = bench()
    noise = replace(first_noise(problem.plant, problem.signals, 0.1), reading_std=5e-3, disturbance_std=1.0)
    with Simulator(problem.plant.layout) as simulator:
        yield simulator, problem, noise


def test_without_an_unknown_torque_a_synthetic_recording_is_what_the_plant_does(made):
    simulator, problem, noise = made
    quiet = replace(noise, disturbance_std=0.0, reading_std=0.0)
    rng = np.random.default_rng(0)
    twice = [synthetic(simulator, problem.plant, problem.signals[0], quiet, rng).measured for _ in range(2)]
    assert np.array_equal(*twice)
    pushed = synthetic(simulator, problem.plant, problem.signals[0], noise, rng).measured
    assert np.std(pushed - twice[0]) > 10.0 * noise.reading_std


def test_the_floor_is_near_the_error_of_the_true_plant_on_recordings_of_its_own(made):
    simulator, problem, noise = made
    final = Structure(Fitted(problem.plant, (), np.zeros((0, 0)), 0.0, 0.0, 0), noise, 0.0, ((), ()), 0)
    seconds = (0.5, 2.0, 10.0, np.inf)
    far = Errors(seconds, (1e9,) * 4)
    floors = refitted_floors(simulator, problem, final, SURE, [far], np.random.default_rng(0), complete=False)
    true = []
    for seed in range(1, 7):
        real = synthetic(simulator, problem.plant, problem.signals[0], noise, np.random.default_rng(seed))
        part = replace(problem.held_out[0], signals=real)
        true.append(
            errors_of(simulator, replace(problem, held_out=(part,)), problem.plant, problem.plant, noise).rms
        )
    usual = np.sqrt(np.mean(np.square(true), axis=0))
    assert np.all(np.array(floors[:2]) > 0.8 * usual[:2])
    assert np.all(np.array(floors) < 3.0 * usual)


def test_no_floor_lies_above_what_was_reached(made):
    simulator, problem, noise = made
    final = Structure(Fitted(problem.plant, (), np.zeros((0, 0)), 0.0, 0.0, 0), noise, 0.0, ((), ()), 0)
    reached = Errors((0.5, 2.0, 10.0, np.inf), (1e-9,) * 4)
    assert (
        refitted_floors(simulator, problem, final, SURE, [reached], np.random.default_rng(0), complete=True)
        == (1e-9,) * 4
    )


def test_floors_grow_where_a_complete_model_simulates_what_was_fitted_worse_than_its_noise_tells(made):
    simulator, problem, noise = made
    final = Structure(Fitted(problem.plant, (), np.zeros((0, 0)), 0.0, 0.0, 0), noise, 0.0, ((), ()), 0)
    far = Errors((0.5, 2.0, 10.0, np.inf), (1e9,) * 4)
    low, high = (
        refitted_floors(simulator, problem, final, SURE, [far], np.random.default_rng(0), complete=complete)
        for complete in (False, True)
    )  # the readings of the bench are no plant's, so that the model is far off on them
    assert np.all(np.array(high) > 2.0 * np.array(low))


@pytest.mark.slow_variants
@pytest.mark.parametrize(("off", "grows"), [(0.0, 1.3), (0.1, 6.2)])
def test_the_dry_friction_of_a_complete_model_may_be_off_by_a_tenth(made, monkeypatch, off, grows):
    simulator, problem, noise = made
    noise = replace(noise, disturbance_std=0.0)
    own = synthetic(simulator, problem.plant, problem.signals[0], noise, np.random.default_rng(1))
    truth = replace(problem, signals=(own,), held_out=(replace(problem.held_out[0], signals=own),))
    final = Structure(Fitted(problem.plant, (), np.zeros((0, 0)), 0.0, 0.0, 0), noise, 0.0, ((), ()), 0)
    far = Errors((0.5, 2.0, 10.0, np.inf), (1e9,) * 4)
    assert floors.DRY_FRICTION_OFF == 0.1
    monkeypatch.setattr(floors, "DRY_FRICTION_OFF", off)
    low, high = (
        refitted_floors(simulator, truth, final, SURE, [far], np.random.default_rng(0), complete=complete)[1]
        for complete in (False, True)
    )
    assert high / low == pytest.approx(grows, rel=0.3)


@pytest.mark.parametrize(
    ("rms", "at"), [((1.5, 3.0, 99.0), True), ((1.6, 3.0, 99.0), False), ((1.5, 3.1, 99.0), False)]
)
def test_windows_are_at_their_floors_up_to_the_tolerance_however_long_runs_err(rms, at):
    errors = Errors((0.5, 2.0, np.inf), rms)
    assert _at_the_floor(errors, np.array([1.0, 2.5, 5.0]), 0.5) is at


@pytest.mark.parametrize(
    ("window", "complete", "met"), [(1e-9, True, True), (1e-9, False, False), (1e6, True, False)]
)
def test_longer_floors_of_a_complete_model_are_the_errors_reached_where_windows_are_at_theirs(
    made, window, complete, met
):
    simulator, problem, noise = made
    final = Structure(Fitted(problem.plant, (), np.zeros((0, 0)), 0.0, 0.0, 0), noise, 0.0, ((), ()), 0)
    reached = Errors((0.5, 2.0, 10.0, np.inf), (window, window, 1e6, 1e6))
    found = refitted_floors(
        simulator, problem, final, SURE, [reached], np.random.default_rng(0), complete=complete
    )
    assert (found[2:] == (1e6, 1e6)) is met


def open_in(problem, symbol, std):
    """The plant with one variable whose standard deviation is `std`, and its covariance."""
    slot = next(slot for slot in problem.plant.values if slot.symbol == symbol)
    own = problem.plant.values[slot]
    variable = Variable((slot,), (1.0,), own, 0.0, np.inf, own, own, 0.0)
    fitted = Fitted(problem.plant, (variable,), np.zeros((1, 1)), 0.0, 0.0, 0)
    return fitted, np.array([[std**2]])


def test_plants_are_drawn_as_far_off_as_readings_leave_open_and_within_bounds(made):
    _, problem, noise = made
    fitted, covariance = open_in(problem, "viscous", 1e-2)
    final = Structure(fitted, noise, 0.0, ((), ()), 0)
    slot = fitted.variables[0].slots[0]
    values = [plant.values[slot] for plant in drawn(final, covariance, 8, np.random.default_rng(0))]
    assert np.mean(values) == pytest.approx(5e-2)
    assert np.std(values) == pytest.approx(1e-2, rel=0.1)
    far = [plant.values[slot] for plant in drawn(final, 100.0 * covariance, 8, np.random.default_rng(0))]
    assert min(far) == 0.0


def test_floors_grow_by_what_readings_leave_open_and_what_was_held_out_shows(made, monkeypatch):
    simulator, problem, noise = made
    still = SimpleNamespace(simulating=lambda plant, noise, **_: (SimpleNamespace(plant=plant), noise))
    monkeypatch.setattr(floors, "Fitter", lambda *_: still)  # as if no reading showed the friction
    fitted, covariance = open_in(problem, "viscous", 1e-2)
    final = Structure(fitted, replace(noise, disturbance_std=0.0), 0.0, ((), ()), 0)
    far = Errors((0.5, 2.0, 10.0, np.inf), (1e9,) * 4)
    sure, unsure = (
        refitted_floors(simulator, problem, final, spread, [far], np.random.default_rng(0), complete=False)
        for spread in (np.zeros((1, 1)), covariance)
    )
    assert np.all(np.array(unsure) > 3.0 * np.array(sure))


def test_synthetic_readings_that_are_held_stray_as_their_effect_says():
    problem = problem_of_made(home(21, duration_s=6.0))
    with Simulator(problem.plant.layout) as simulator:
        signals = problem.signals[0]
        noise = replace(first_noise(problem.plant, [signals], problem.scale.torque), disturbance_std=0.0)
        held = problem.plant.with_effect("sample_hold", {"refresh_period": 0.1})
        spread = straying(simulator, held, signals)
        strays = [
            synthetic(simulator, held, signals, noise, np.random.default_rng(seed)).measured
            for seed in (1, 2)
        ]
    usual = np.sqrt(np.mean((strays[0] - strays[1]) ** 2) / 2.0)
    assert usual == pytest.approx(np.sqrt(np.nanmean(spread)), rel=0.1)
    assert usual > 5.0 * noise.reading_std
