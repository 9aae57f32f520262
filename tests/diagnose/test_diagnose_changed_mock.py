"""A mock brick recorded before and after somebody touched it."""

import pytest
import yaml

import nxt_twin as nt

BAND = {"spring_load": {"stiffness_nm_per_rad": 0.01, "rest_angle_deg": 0.0}}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Records motor A of a mock with this battery and these effects."""
    folder = tmp_path_factory.mktemp("touched")

    def record(name, voltage_v=8.2, effects=None, **changes):
        motor = {**nt.load_plant("nxt_motor").to_config(), **changes, "effects": effects or {}}
        battery = {"voltage_v": voltage_v, "internal_resistance_ohm": 0.0, "drain_v_per_c": 0.0}
        world = folder / f"{name}.yaml"
        world.write_text(yaml.safe_dump({"battery": battery, "motors": {"a": motor}}))
        return nt.record(f"mock:?world={world}", folder / f"{name}.csv", program="excitation", seconds=10.0)

    return record


@pytest.fixture(scope="module")
def before(recorded):
    return recorded("before")


def test_a_rubber_band_that_was_put_on_is_named(recorded, before):
    found = nt.find_changes(before, recorded("band", effects=BAND))
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "spring_load")
    assert change.after == pytest.approx(0.01, rel=0.1)


def test_a_battery_that_was_swapped_changes_no_motor_and_is_told(recorded, before):
    found = nt.find_changes(before, recorded("battery", voltage_v=7.0))
    assert (found.verdict, found.changes) == ("unchanged", ())
    assert "8.20 V before and 6.99 V after" in " ".join(found.notes)


@pytest.mark.slow
def test_a_worn_gear_is_named_as_friction(recorded, before):
    found = nt.find_changes(before, recorded("worn", coulomb_friction_nm=0.025))
    assert (found.verdict, [change.of for change in found.changes]) == ("changed", ["coulomb_friction_nm"])
