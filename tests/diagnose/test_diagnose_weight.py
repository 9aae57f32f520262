"""What speaks for a structure over a simpler one, and the units in which errors are told."""

import math
from types import SimpleNamespace

import pytest

from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.diagnose.units import units_of
from nxt_twin.physics.effects.friction import LOAD_DEPENDENT_FRICTION
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config

MOTOR = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
READINGS = 1000


def structure(*, cost, variables=7, plant=MOTOR, check_cost=100.0):
    """A fitted structure as `weigh` reads one."""
    fitted = SimpleNamespace(variables=[None] * variables, readings=READINGS)
    return SimpleNamespace(
        fitted=fitted,
        fitted_cost=cost,
        check_cost=check_cost,
        free_run_rms=(1.0, 1.0),
        believed=READINGS,
        plant=plant,
    )


@pytest.mark.parametrize("further", [0, 1, 3])
def test_each_further_parameter_costs_half_a_logarithm_of_the_readings(further):
    gain = weigh(structure(cost=200.0), structure(cost=150.0, variables=7 + further)).gain
    assert gain == pytest.approx(50.0 - 0.5 * further * math.log(READINGS))


def test_a_share_of_faulty_readings_costs_as_much_as_a_parameter():
    stale = MOTOR.adding("stale_samples", stale_fraction=0.05)
    gain = weigh(structure(cost=200.0), structure(cost=150.0, plant=stale)).gain
    assert gain == pytest.approx(50.0 - 0.5 * math.log(READINGS))


def test_what_a_parameter_gains_by_chance_does_not_pay_for_it():
    """Noise gives half a nat for each parameter; the penalty is seven times that for a thousand readings."""
    assert weigh(structure(cost=200.0), structure(cost=199.5, variables=8)).gain < -2.5


@pytest.mark.parametrize(
    ("frame", "kind", "is_speed", "unit", "factor"),
    [
        ("linear", "force_n", False, "mm", 1000.0),
        ("linear", "force_n", True, "mm/s", 1000.0),
        ("motor", "power_pct", False, "deg", 180.0 / math.pi),
        ("rotary", "torque_nm", True, "deg/s", 180.0 / math.pi),
    ],
)
def test_errors_are_told_in_millimetres_or_degrees(frame, kind, is_speed, unit, factor):
    units = units_of(frame, SimpleNamespace(input_kind=kind, is_speed=is_speed))
    assert (units.reading, units.reading_factor) == (unit, pytest.approx(factor))


@pytest.mark.parametrize(("drive", "load"), [(0.3, 0.1), (0.1, -0.3), (-0.3, 0.3)])
def test_friction_grows_with_the_larger_of_drive_and_load_and_not_with_their_sum(drive, load):
    friction = LOAD_DEPENDENT_FRICTION.terms["friction"]
    assert friction(0.02, drive, load, 0.2) == pytest.approx(0.02 + 0.2 * 0.3)
