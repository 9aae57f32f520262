"""A few of the repetitions behind `python -m benchmarks identify`: nothing is far off."""

import pytest

from benchmarks.identify_studies import STUDIES

SLOW = ("motor, resistance as the anchor", "motor, disc as the anchor", "motor over Bluetooth's delays")
OURS = [name for name in STUDIES if not name.startswith("NOT")]


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in OURS]
)
def test_no_interval_is_far_from_the_truth(name: str) -> None:
    identified, truth = STUDIES[name](7001)
    assert truth
    for parameter, true in truth.items():
        value = identified.value(parameter)
        assert value.low < value.value < value.high
        assert abs(value.value - true) < 5.0 * value.std, parameter


@pytest.mark.slow
def test_a_battery_that_sags_is_taken_for_resistance() -> None:
    name = next(name for name in STUDIES if "battery" in name)
    identified, truth = STUDIES[name](7002)
    assert identified.value("resistance_ohm").value > truth["resistance_ohm"]
