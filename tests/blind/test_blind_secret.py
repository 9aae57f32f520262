"""A mock brick with a motor that is another than it seems."""

from __future__ import annotations

import math

import pytest

from firmware_protocol import OutputPort
from nxt_twin.blind.body import TrueMotor, hiding
from nxt_twin.blind.secret import ONLY_IN_RECORDINGS, concealed, drawable, read_secret, secret_of
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.brick.brick import Brick
from nxt_twin.errors import CaseError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link

NOTHING = concealed(0, effects=())


def brick_with(secret) -> tuple[Brick, VirtualClock]:
    clock = VirtualClock()
    return Brick(open_mock_link(clock, change=hiding(secret)), clock), clock


def turned(secret, power_pct: int = 60, seconds: float = 1.0) -> tuple[int, int]:
    """How far A, where the secret is, and B turn, degrees."""
    brick, clock = brick_with(secret)
    with brick:
        for port in (OutputPort.A, OutputPort.B):
            brick.motors.drive(port, power_pct)
        clock.sleep(seconds)
        return tuple(brick.motors.tacho_deg(port).value for port in (OutputPort.A, OutputPort.B))


def test_a_seed_always_conceals_the_same_and_seeds_differ():
    assert concealed(3) == concealed(3)
    assert len({secret.effects[0]["id"] for secret in map(concealed, range(30))}) > 10


def test_a_motor_with_nothing_concealed_turns_as_the_plain_model_does():
    own, plain = turned(NOTHING)
    assert own == pytest.approx(plain, abs=2)


def test_what_drags_is_seen_at_the_motor_that_has_it_and_no_other():
    own, plain = turned(concealed(1, effects=("constant_load",), size="large"))
    other, _ = turned(NOTHING)
    assert abs(own - plain) > 5
    assert plain == pytest.approx(other, abs=1)


@pytest.mark.parametrize("effect", drawable())
def test_every_effect_that_a_seed_may_draw_runs_in_a_mock(effect):
    secret = concealed(5, effects=(effect,), size="large")
    motor = TrueMotor(secret.motor, secret.sensing)
    for tick in range(300):
        motor.step(0.5 if tick < 200 else -0.5, 0, 8.0, 1e-3)
    assert math.isfinite(motor.shown_rad)
    assert motor.shown_rad > 0.3
    assert secret.effects[0]["id"] == effect


def test_a_late_command_acts_late():
    motor = TrueMotor(Motor(), Sensing(delay_s=0.02))
    for _ in range(20):
        motor.step(1.0, 0, 8.0, 1e-3)
    assert motor.shown_rad == pytest.approx(0.0, abs=1e-6)
    for _ in range(50):
        motor.step(1.0, 0, 8.0, 1e-3)
    assert motor.shown_rad > 0.02


@pytest.mark.slow
def test_a_tired_battery_is_the_bricks_own():
    drained, plain = (
        brick_with(secret) for secret in (concealed(2, effects=("battery_drain",), size="large"), NOTHING)
    )
    readings = []
    for brick, clock in (drained, plain):
        with brick:
            clock.sleep(20.0)
            readings.append(brick.device.battery_v().value)
    assert readings[0] < readings[1] - 0.05


@pytest.mark.parametrize("effect", ONLY_IN_RECORDINGS)
def test_what_only_a_recording_can_have_is_refused(effect):
    assert effect not in drawable()
    with pytest.raises(CaseError, match="blind make"):
        concealed(0, effects=(effect,))


def test_a_file_says_what_to_conceal(tmp_path):
    file = tmp_path / "secret.yaml"
    file.write_text("port: b\neffects: [stiction, backlash]\nsize: medium\nmotor: {drop_v: 0.4}\n")
    secret = secret_of(str(file))
    assert secret.port == "b"
    assert {effect["id"] for effect in secret.effects} == {"stiction", "backlash"}
    assert secret.revealed()["motor"]["drop_v"] == 0.4
    file.write_text("motor: {inertia_kg_m2: 0.002}\n")
    assert read_secret(file).effects == ()
    assert read_secret(file).revealed()["motor"] == {"inertia_kg_m2": 0.002}


@pytest.mark.parametrize(
    "text", ["effects: [no_such]", "motor: {no_such: 1.0}", "port: d", "colour: red", "effects: [clock_skew]"]
)
def test_a_file_that_says_nonsense_is_refused(tmp_path, text):
    file = tmp_path / "secret.yaml"
    file.write_text(text + "\n")
    with pytest.raises(CaseError):
        read_secret(file)
