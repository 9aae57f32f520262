"""What a session says of a motor that somebody touched since its plant was identified."""

import pytest
import yaml
from twin_feed import nxt_motor
from twin_rig import Rig, run

from nxt_twin.errors import DiagnosisError
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.since import Since

PLANT = nxt_motor()
AS_RUN = BrickTwin({"a": PLANT}).as_run("a", PLANT)


@pytest.fixture
def since(tmp_path):
    """What differs on motor A of a mock with these changes, after so many seconds."""

    def compared(voltage_v=8.2, effects=None, seconds=14.0, **changes):
        motor = {**PLANT.to_config(), **changes, "effects": effects or {}}
        battery = {"voltage_v": voltage_v, "internal_resistance_ohm": 0.35, "drain_v_per_c": 0.0}
        world = tmp_path / "world.yaml"
        world.write_text(yaml.safe_dump({"battery": battery, "motors": {"a": motor}}))
        session = run(Rig(world), seconds, plant=PLANT, period_s=0.01).session
        return Since("plant.yaml", "a", AS_RUN, session.seen("a")).changes()

    return compared


def test_a_motor_that_nobody_touched_is_unchanged(since):
    found = since()
    assert (found.verdict, found.changes, found.before, found.name) == (
        "unchanged",
        (),
        "plant.yaml",
        "port A",
    )


def test_a_rubber_band_is_named_with_its_stiffness(since):
    found = since(effects={"spring_load": {"stiffness_nm_per_rad": 0.01, "rest_angle_deg": 0.0}})
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "spring_load")
    assert change.after == pytest.approx(0.01, rel=0.15)


def test_another_battery_changes_no_motor_and_is_told(since):
    found = since(voltage_v=7.0)
    assert (found.verdict, found.changes) == ("unchanged", ())
    assert "the supply was 8.00 V before and 6.9" in " ".join(found.notes)


@pytest.mark.slow
def test_a_worn_gear_is_named_as_friction(since):
    found = since(coulomb_friction_nm=0.025)
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "coulomb_friction_nm")
    assert change.after == pytest.approx(0.025, rel=0.1)


def test_a_session_that_saw_too_little_is_refused(since):
    with pytest.raises(DiagnosisError, match="too little to compare"):
        since(seconds=2.0)
