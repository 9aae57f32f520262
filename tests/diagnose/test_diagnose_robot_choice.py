"""Evidence for an effect of a robot has to speak for a size that matters."""

import numpy as np

from nxt_twin.diagnose.robot.choice import beyond, weigh

PLACES = {"centre_of_mass_offset": [0, 1]}
LEAST = np.array([3e-3, 3e-3])
COVARIANCE = np.diag([6e-3, 1e-4]) ** 2


def named(*off):
    return weigh(PLACES, beyond(np.array(off), LEAST), COVARIANCE, 24).best


def test_an_exact_and_tiny_place_lends_no_evidence_to_a_large_and_uncertain_one():
    off = np.array([-1.1e-2, -6e-4])
    assert weigh(PLACES, off, COVARIANCE, 24).best == {"centre_of_mass_offset"}
    assert named(*off) == set()


def test_a_place_that_is_large_and_certain_is_still_named():
    assert named(0.0, 4e-3) == {"centre_of_mass_offset"}
    assert named(-6e-2, 0.0) == {"centre_of_mass_offset"}
