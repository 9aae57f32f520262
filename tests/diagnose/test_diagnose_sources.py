"""Which equation fails, by what it asks for: no effect of the library takes part."""

import pytest
from diagnose_cases import concealed
from diagnose_motors import clean_case, settled

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.where.sources import sources
from nxt_twin.physics.simulate import Simulator


def located(case):
    """All hypotheses on the re-fitted baseline."""
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, baseline = settled(simulator, case)
        return sources(simulator, problem, baseline)


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("effect", "size", "seed", "source"),
    [
        ("gravity_load", "medium", 11, "actuator"),
        ("battery_sag", "medium", 18, "battery"),
        ("stale_samples", "medium", 15, "clock_or_link"),
        ("command_delay", "small", 13, "clock_or_link"),
        ("encoder_eccentricity", "medium", 14, "encoder"),
        ("belt_slip", "large", 16, "transmission"),
    ],
)
def test_the_equation_that_lacks_something_asks_for_it_the_loudest(effect, size, seed, source):
    found = located(concealed((effect,), seed=seed, size=size))
    assert found[0].source == source
    assert found[0].p_value < 1e-6
    assert {finding.source for finding in found} == {
        "actuator", "battery", "transmission", "encoder", "clock_or_link",
    }  # fmt: skip
    assert list(found) == sorted(found, key=lambda finding: -finding.strength)


def test_a_clean_recording_asks_for_nothing():
    assert min(finding.p_value for finding in located(clean_case(41))) > 0.01
