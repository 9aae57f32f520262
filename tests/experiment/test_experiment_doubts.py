import numpy as np
import pytest

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment import borders
from nxt_twin.experiment.borders import blind_border, near_offset
from nxt_twin.sensors.ultrasonic import NO_ECHO, UltrasonicParameters
from nxt_twin.sensors.walk import walked

PLACES = np.arange(20.0, 400.0, 8.0)


def walk_in_unit_square(log_likelihood: float) -> FloatArray:
    return walked(
        lambda values: np.full(len(values), log_likelihood),
        np.array([0.5, 0.5]),
        np.array([0.1, 0.1]),
        (np.zeros(2), np.ones(2)),
        np.random.default_rng(1),
    )


def test_a_walk_draws_from_a_ridge() -> None:
    covariance = np.array([[1.0, 0.95], [0.95, 1.0]])
    inverse = np.linalg.inv(covariance)
    wide = np.array([100.0, 100.0])
    draws = walked(
        lambda values: -0.5 * np.einsum("ni,ij,nj->n", values - 3.0, inverse, values - 3.0),
        np.array([2.0, 2.0]),
        np.array([0.1, 0.1]),
        (-wide, wide),
        np.random.default_rng(2),
    )
    assert draws.mean(axis=0) == pytest.approx([3.0, 3.0], abs=0.15)
    assert np.cov(draws.T) == pytest.approx(covariance, abs=0.2)


def test_a_walk_stays_within_its_bounds_and_fills_them() -> None:
    draws = walk_in_unit_square(0.0)
    assert draws.min() >= 0.0
    assert draws.max() <= 1.0
    assert np.quantile(draws[:, 0], [0.025, 0.5, 0.975]) == pytest.approx([0.025, 0.5, 0.975], abs=0.05)


def test_a_blind_zones_border_lies_anywhere_between_two_places() -> None:
    readings = np.where(PLACES < 45.0, NO_ECHO, np.rint(PLACES / 10.0))
    border = blind_border(UltrasonicParameters(), PLACES, readings)
    assert border.low == pytest.approx(44.0, abs=0.7)
    assert border.high == pytest.approx(52.0, abs=0.7)
    assert border.value == pytest.approx(48.0, abs=0.2)


def near_readings(share: float, below_mm: float, rng: np.random.Generator) -> FloatArray:
    early = (below_mm > PLACES) & (rng.random(PLACES.size) < share)
    return np.rint((PLACES + 24.0 * early + 2.0 * rng.standard_normal(PLACES.size)) / 10.0)


def test_a_near_offset_is_weighed_with_its_share_and_border() -> None:
    rng = np.random.default_rng(3)
    near = near_offset(UltrasonicParameters(noise_mm=2.0), PLACES, near_readings(0.8, 250.0, rng), 400.0)
    offset, share, border = near.values()
    assert offset.covers(24.0)
    assert share.covers(0.8)
    assert border.covers(250.0)
    assert near.gained.max() > 20.0
    likeliest = near.likeliest(UltrasonicParameters())
    assert likeliest.near_offset_mm == pytest.approx(24.0, abs=4.0)


def test_no_near_offset_gains_next_to_nothing() -> None:
    rng = np.random.default_rng(4)
    near = near_offset(UltrasonicParameters(noise_mm=2.0), PLACES, near_readings(0.0, 250.0, rng), 400.0)
    assert near.gained.max() < 6.0


def test_places_that_nearly_coincide_cost_nothing_more() -> None:
    places = np.sort(np.concatenate([PLACES, PLACES + 1e-3]))
    assert borders._between(places)[0].size < 3 * borders._between(PLACES)[0].size
    readings = np.where(places < 45.0, NO_ECHO, np.rint(places / 10.0))
    border = blind_border(UltrasonicParameters(), places, readings)
    assert border.low == pytest.approx(44.0, abs=0.7)
    assert border.high == pytest.approx(52.0, abs=0.7)
