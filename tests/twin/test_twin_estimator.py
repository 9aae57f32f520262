"""The filters against closed forms."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from twin_feed import nxt_motor

from nxt_twin.physics.layout import Slot
from nxt_twin.twin.batch import Batch
from nxt_twin.twin.bridge import Hold
from nxt_twin.twin.candidates import Candidate
from nxt_twin.twin.estimator import Drift, Estimator, Weigher
from nxt_twin.twin.strand import Strand, place_matters


class ClosedForm:
    """A linear Kalman filter, written out from the textbook's five equations."""

    def __init__(self, mean, covariance):
        self.mean, self.covariance = np.array(mean, float), np.array(covariance, float)

    def predict(self, transition, process):
        self.mean = transition @ self.mean
        self.covariance = transition @ self.covariance @ transition.T + process

    def update(self, reading, variance):
        total = self.covariance[0, 0] + variance
        gain = self.covariance[:, 0] / total
        innovation = reading - self.mean[0]
        self.mean = self.mean + gain * innovation
        self.covariance = self.covariance - np.outer(gain, self.covariance[0])
        return innovation**2 / total, total


def test_the_estimator_is_the_closed_form_where_all_is_linear():
    rng = np.random.default_rng(5)
    transition = np.array([[1.0, 0.1, 0.005], [0.0, 0.95, 0.1], [0.0, 0.0, 0.8]])
    process = np.diag([1e-4, 1e-3, 1e-2])
    ours, oracle = Estimator(np.zeros(3), np.ones(3)), ClosedForm(np.zeros(3), np.eye(3))
    for _ in range(200):
        ours.predict(transition @ ours.mean, transition, process)
        oracle.predict(transition, process)
        reading = float(rng.normal())
        compared = ours.update(reading, 0.3)
        square, total = oracle.update(reading, 0.3)
        assert compared.normalised_square == pytest.approx(square, rel=1e-9)
        assert compared.variance == pytest.approx(total, rel=1e-9)
        density = -0.5 * (square + math.log(2.0 * math.pi * total))
        assert compared.log_likelihood == pytest.approx(density, rel=1e-9, abs=1e-9)
    np.testing.assert_allclose(ours.mean, oracle.mean, atol=1e-9)
    np.testing.assert_allclose(ours.covariance, oracle.covariance, atol=1e-9)


def test_a_motor_without_dry_friction_is_filtered_as_in_closed_form():
    """The rows round the estimate, stepped by the kernel, give the exact linear transition and its filter."""
    plain = nxt_motor().without({"coulomb_friction", "inductance"})
    inertia = plain.values[Slot("base", "inertia")]
    constant = plain.values[Slot("base", "torque_constant")]
    back_emf = plain.values[Slot("base", "back_emf")]
    resistance = plain.values[Slot("base", "resistance")]
    damping = (constant * back_emf / resistance + plain.values[Slot("viscous_friction", "viscous")]) / inertia
    torque_std, torque_s, gap_s, variance = 4e-3, 0.15, 0.01, 1e-5
    strand = Strand(Candidate("nothing", plain), 0, torque_std, torque_s)
    rows = strand.rows.stop
    batch = Batch([plain] * rows, ["a"] * rows, [0.0] * rows, torque_s)
    batch.command("a", 0.0, (Hold(0.0, 0.0, 3),))  # brake: linear, no supply in it
    strand.place(batch, 0.2, 3.0, (1e-4, 0.01))
    oracle = ClosedForm([0.2, 3.0, 0.0], np.diag([1e-4, 0.01, torque_std**2]))
    rng = np.random.default_rng(1)
    for n in range(1, 60):
        batch.advance(n * gap_s, 8.0)
        strand.reap(batch, gap_s)
        oracle.predict(*_exact(damping, inertia, torque_s, torque_std, gap_s))
        np.testing.assert_allclose(strand.mean[:2], oracle.mean[:2], atol=2e-3)
        scale = np.sqrt(np.diag(oracle.covariance))
        error = (strand.estimator.covariance - oracle.covariance) / np.outer(scale, scale)
        assert np.abs(error).max() < 0.05
        reading = float(oracle.mean[0] + rng.normal() * 0.005)
        strand.update(reading, variance)
        oracle.update(reading, variance)
        strand.sow(batch)


def _exact(damping, inertia, torque_s, torque_std, gap_s):
    """Transition by the series of the matrix exponential, process noise by its integral (sums over fine steps)."""
    rates = np.array([[0.0, 1.0, 0.0], [0.0, -damping, 1.0 / inertia], [0.0, 0.0, -1.0 / torque_s]])
    steps = 200
    fine = np.eye(3) + rates * gap_s / steps + (rates * gap_s / steps) @ (rates * gap_s / steps) / 2.0
    density = 2.0 * torque_std**2 / torque_s
    floors = np.diag([0.01**2, 0.02**2, density])
    transition, process = np.eye(3), np.zeros((3, 3))
    for _ in range(steps):
        process = fine @ process @ fine.T + floors * gap_s / steps
        transition = fine @ transition
    return transition, process


def test_the_weigher_believes_the_estimator_that_foretells_best():
    estimators = {name: Estimator(np.zeros(3), np.ones(3)) for name in ("nothing", "drag", "load")}
    weigher = Weigher(estimators, 3, (0.6, 0.2, 0.2), memory_s=30.0)
    assert sum(weigher.probabilities.values()) == pytest.approx(1.0)
    for _ in range(40):
        weigher.update([-1.0, -0.5, -3.0], 0.03)
    found = weigher.probabilities
    assert found["drag"] > 0.9
    assert sum(found.values()) == pytest.approx(1.0)
    for _ in range(80):
        weigher.update([-1.0, -2.0, -3.0], 0.03)
    assert weigher.probabilities["nothing"] > 0.9


def test_a_drifting_number_is_followed():
    drift = Drift(100.0, 1.0, jerk=10.0, rate_std=5.0)
    for n in range(1, 40):
        drift.predict(0.1)
        drift.update(100.0 + 2.0 * 0.1 * n, 1.0)
    drift.predict(0.5)
    assert drift.value == pytest.approx(100.0 + 2.0 * 4.4, abs=1.0)


@pytest.mark.parametrize("effect", [effect for effect in nxt_motor().layout.effects if not effect.fault])
def test_neighbours_at_another_angle_are_left_out_only_where_they_would_move_alike(effect):
    middle = {parameter.symbol: parameter.starts[0] * parameter.si for parameter in effect.parameters}
    plant = nxt_motor().with_effect(effect.id, middle)
    batch = Batch([plant, plant], ["a", "a"], [0.0, 0.0], 0.15)
    batch.command("a", 0.0, (Hold(0.0, 0.5, 0),))
    batch.state[:, 0] = 0.0, 0.6
    batch.advance(0.3, 8.0)
    moved = batch.state[:, 0] - (0.0, 0.6)
    assert moved[0] > 0.05
    alike = moved[0] == pytest.approx(moved[1], rel=1e-9)
    assert alike or place_matters(plant)
    strand = Strand(Candidate("nothing", plant), 0, 4e-3, 0.15)
    assert strand.rows.stop == (7 if place_matters(plant) else 5)


def test_an_angle_that_matters_is_in_the_transition():
    """A spring of 0.05 N·m/rad: at another angle another torque; by the matrix exponential."""
    slots = {"stiffness": 0.05, "rest": 0.0}
    sprung = nxt_motor().without({"coulomb_friction"}).with_effect("spring_load", slots)
    strand = Strand(Candidate("nothing", sprung), 0, 1e-6, 0.15)
    batch = Batch([sprung] * 7, ["a"] * 7, [0.0] * 7, 0.15)
    batch.command("a", 0.0, (Hold(0.0, 0.0, 2),))  # coasting
    strand.place(batch, 0.2, 0.0, (1e-4, 1e-4))
    batch.advance(0.05, 8.0)
    strand.reap(batch, 0.05)
    inertia = sprung.values[Slot("base", "inertia")]
    viscous = sprung.values[Slot("viscous_friction", "viscous")]
    transition = expm(0.05 * np.array([[0.0, 1.0], [-0.05 / inertia, -viscous / inertia]]))
    floors = 0.05 * np.diag([0.01**2, 0.02**2])
    exact = 1e-4 * transition @ transition.T + floors
    np.testing.assert_allclose(strand.estimator.covariance[:2, :2], exact, rtol=2e-2, atol=1e-6)


def test_the_weigher_changes_its_mind_however_long_it_was_sure():
    """Without switching between models, 500 nats for one would outweigh what comes later for minutes."""
    estimators = {name: Estimator(np.zeros(3), np.ones(3)) for name in ("nothing", "drag")}
    weigher = Weigher(estimators, 3, (0.6, 0.4), memory_s=30.0)
    for _ in range(1000):
        weigher.update([-1.0, -0.5], 0.03)
    assert weigher.probabilities["drag"] > 0.9
    for _ in range(50):
        weigher.update([-1.0, -2.0], 0.03)
    assert weigher.probabilities["nothing"] > 0.9
