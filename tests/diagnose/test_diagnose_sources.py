"""Which equation fails, by the variance that it asks for: no effect of the library takes part."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed
from diagnose_motors import clean_case, settled

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.linear import linearise
from nxt_twin.diagnose.sources import sources
from nxt_twin.physics.simulate import Simulator

CLEAN_TORQUE = 1e-3


def located(case, *, calm=True):
    """The hypotheses on the re-fitted baseline, under its own noise or one such as a complete model leaves."""
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        problem, _, baseline = settled(simulator, case)
        inertia = baseline.plant.values[("base", "inertia")]
        least = CLEAN_TORQUE * problem.scale.torque / inertia if calm else np.inf
        noise = replace(baseline.noise, disturbance_std=min(baseline.noise.disturbance_std, least))
        linear = linearise(simulator, problem, replace(baseline, noise=noise))
        return sources(simulator, linear, problem.scale.torque)


@pytest.mark.parametrize(
    ("effect", "size", "seed", "source"),
    [
        ("gravity_load", "medium", 11, "actuator"),
        ("quadratic_drag", "medium", 17, "actuator"),
        ("battery_sag", "medium", 18, "battery"),
        ("stale_samples", "medium", 15, "clock_or_link"),
        ("swapped_sense", "medium", 31, "battery"),
    ],
)
def test_the_equation_that_lacks_something_asks_for_noise_the_loudest(effect, size, seed, source):
    found = located(concealed((effect,), seed=seed, size=size))
    assert found[0].source == source
    assert found[0].p_value < 1e-6
    assert {finding.source for finding in found} == {
        "actuator", "battery", "transmission", "encoder", "clock_or_link",
    }  # fmt: skip
    assert list(found) == sorted(found, key=lambda finding: -finding.strength)


def test_a_clean_recording_asks_for_hardly_any_noise():
    found = located(clean_case(41), calm=False)
    assert max(finding.strength for finding in found) < 12.0  # real friction is not quite the model's
    assert np.median([finding.p_value for finding in found]) > 0.05
