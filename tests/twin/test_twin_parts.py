"""Bridges, batches, drivers, standstills, supplies, histories and sinks, each by itself."""

import numpy as np
import pytest
from twin_feed import nxt_motor
from twin_rig import steady

from nxt_twin.errors import PlantError
from nxt_twin.physics.late import effects_delay_s
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.program import MotorProgram
from nxt_twin.twin.batch import Batch
from nxt_twin.twin.blocked import TurnedBack
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import DRIVE, FLOAT, Hold, firmware_bridge, plain_bridge
from nxt_twin.twin.candidates import NOTHING, UNKNOWN, candidates
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.history import History
from nxt_twin.twin.records import Event, Tick
from nxt_twin.twin.sensor_twin import SensorTwin
from nxt_twin.twin.settings import BATTERY_AGE_S, Watch
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.standstill import Standstill
from nxt_twin.twin.supply import Drain, Draught, Lately, Supply
from nxt_twin.twin.tally import LOW_SPEED, Regimes, Tally


def test_a_batch_moves_as_a_mock_bricks_plant():
    plant = nxt_motor()
    batch = Batch([plant] * 2, ["a", "b"], [0.0, 0.0], 0.1)
    stepper = Stepper([plant])
    batch.command("a", 0.0, (Hold(0.0, 0.6, 0), Hold(0.3, -0.4, 0)))
    batch.advance(0.5, 8.0)
    for n in range(500):
        duty = 0.6 if n < 300 else -0.4
        stepper.step(np.array([duty]), np.array([0]), 8.0, 1e-3)
    np.testing.assert_allclose(batch.state[0, :3], [stepper.angle[0], stepper.speed[0], stepper.current[0]])
    assert batch.state[1, 0] == 0.0
    assert batch.in_force("a") == (-0.4, 0)


def test_a_delayed_plant_takes_its_commands_later():
    late = nxt_motor().with_effect("command_delay", {"command_delay": 0.05})
    assert effects_delay_s(late) == pytest.approx(0.05)
    batch = Batch([late, late], ["a", "a"], [0.05, 0.0], 0.1)
    batch.command("a", 0.0, (Hold(0.0, 1.0, 0),))
    batch.advance(0.05, 8.0)
    assert batch.state[0, 1] == 0.0
    assert batch.state[1, 1] > 1.0


def test_a_new_command_replaces_what_was_still_to_come():
    batch = Batch([nxt_motor()], ["a"], [0.0], 0.1)
    batch.command("a", 0.0, (Hold(0.0, 1.0, 0), Hold(0.2, -1.0, 0)))
    batch.command("a", 0.1, (Hold(0.0, 0.3, 0),))
    batch.advance(0.4, 8.0)
    assert batch.in_force("a") == (0.3, 0)


def test_what_is_due_is_done_by_whatever_replaces_a_batch():
    """A command that was sent, and did not reach the motor yet, is not lost when a model is adopted."""
    plant = nxt_motor()
    batch = Batch([plant, plant], ["a", "a"], [0.02, 0.0], 0.1)
    batch.command("a", 0.0, (Hold(0.0, 0.7, 0),))
    batch.advance(0.1, 8.0)
    batch.command("a", 0.11, (Hold(0.0, -0.7, 0), Hold(0.05, 0.0, 2)))
    other = Batch([plant, plant], ["a", "a"], [0.0, 0.03], 0.1, now_s=0.1)
    other.go_on_from(batch)
    assert other.in_force("a") == (0.7, 0)
    other.advance(0.12, 8.0)
    assert other.in_force("a") == (-0.7, 0)
    assert other.state[0, 1] < other.state[1, 1]  # the second takes it up later
    other.advance(0.17, 8.0)
    assert other.in_force("a") == (0.0, 2)


def test_a_drain_that_a_model_has_is_not_read_off_the_battery_once_more():
    supply = Supply(8.0, 0.0)
    for n in range(20):
        supply.read(8.0 - 0.02 * n, Draught(0.0), float(n))
    assert supply.at(10.0) == pytest.approx(7.8, abs=0.06)
    drained = supply.behind(0.0, Drain(0.02, 5.0))
    assert drained.open_v == pytest.approx(7.9)
    assert drained.at(10.0) == pytest.approx(7.8)


def test_a_bench_is_no_motor():
    from nxt_twin.physics.plant import plant_from_config

    bench = plant_from_config({"kind": "rigid_body", "inertia": 1.0, "viscous_friction": 1.0}, "force_n")
    with pytest.raises(PlantError):
        Batch([nxt_motor(), bench], ["a", "b"], [0.0, 0.0], 0.1)


def test_the_firmware_lets_go_bit_by_bit():
    holds = firmware_bridge(0, "coast", 0.5)
    assert [hold.mode for hold in holds[:-1]] == [FLOAT] * (len(holds) - 1)
    assert holds[-1].after_s == pytest.approx(0.05, abs=0.005)
    duties = [hold.duty for hold in holds]
    assert duties == sorted(duties, reverse=True)
    assert duties[-1] == 0.0


def test_the_firmware_drives_in_whole_steps():
    assert firmware_bridge(50, "drive", 0.0) == (Hold(0.0, 62 / 125, 0),)
    assert firmware_bridge(-100, "float", 0.0) == (Hold(0.0, -1.0, 1),)
    assert plain_bridge(-33, "drive", 0.0) == (Hold(0.0, -0.33, 0),)


def test_candidates_keep_to_what_the_plant_can_have():
    found = {candidate.name: candidate for candidate in candidates(nxt_motor())}
    assert {NOTHING, UNKNOWN, "viscous_friction", "payload_inertia", "stiction"} <= found.keys()
    assert found["viscous_friction"].value == found["viscous_friction"].absent == pytest.approx(1.92e-3)
    assert "stiction" in found["stiction"].plant.active
    none = candidates(nxt_motor(), ("no_such_effect", "stale_samples"))
    assert [candidate.name for candidate in none] == [NOTHING, UNKNOWN]


def test_a_program_is_repeated_and_ends_where_a_motor_has_turned_too_far():
    program = MotorProgram.model_validate(
        {
            "name": "far",
            "runs": [{"name": "r", "segments": [{"duration_s": 2.0, "power_pct": 40}]}],
            "rest_s": 1.0,
            "most_turn_deg": 90.0,
        }
    )
    driver = ProgramDriver(program)
    assert driver.duration_s == 3.0
    assert driver.at(0.5, {"a": 1000})["a"] == (40, "drive")
    assert driver.at(1.0, {"a": 1091})["a"] == (0, "coast")
    assert driver.at(1.1, {"a": 1050})["a"] == (0, "coast")
    assert driver.at(2.5, {"a": 1091})["a"] == (0, "coast")
    assert driver.at(3.1, {"a": 1091})["a"] == (40, "drive")


def test_the_built_in_program_goes_both_ways_and_ends_at_rest():
    driver = ProgramDriver(excitation(("a", "b")))
    told = [driver.at(time_s, {})["b"] for time_s in np.arange(0.0, driver.duration_s, 0.1)]
    powers = [power for power, _ in told]
    assert min(powers) <= -60
    assert max(powers) >= 60
    assert {mode for _, mode in told} == {"drive", "coast", "brake"}
    assert driver.duration_s < 31.0


def test_a_motor_that_turned_and_stops_is_blocked():
    still = Standstill(Watch())
    for n in range(20):
        assert not still.take(0.05 * n, 10 * n, 60)
    noticed = [n for n in range(20, 60) if still.take(0.05 * n, 191, 60)]
    assert len(noticed) == 1
    assert still.trouble == "stall"
    assert 0.05 * noticed[0] == pytest.approx(1.5, abs=0.06)
    still.take(4.0, 300, 60)
    assert still.trouble is None


def test_a_few_counts_alike_over_a_slow_link_are_no_stall():
    still = Standstill(Watch())
    assert not any(still.take(0.2 * n, 100, 60) for n in range(5))
    assert still.take(1.0, 100, 60)


def test_a_motor_without_a_count_either_way_is_not_there():
    still = Standstill(Watch())
    powers = [60] * 20 + [-60] * 20
    for n, power in enumerate(powers):
        still.take(0.05 * n, 0, power)
    assert still.trouble == "disconnected"


def test_a_motor_that_stands_as_its_model_does_is_in_no_trouble():
    still, blocked = Standstill(Watch()), Standstill(Watch())
    for n in range(40):
        count = 10 * min(n, 10)
        assert not still.take(0.05 * n, count, 60, 1.0)
        blocked.take(0.05 * n, count, 60, 25.0)
    assert still.trouble is None
    assert blocked.trouble == "stall"


@pytest.mark.parametrize(("counts", "since_s"), [((101, 95, 79, 60), 3.0), ((101, 119, 130, 60), None)])
def test_a_motor_that_was_blocked_and_turns_back_ran_against_something(counts, since_s):
    turned = TurnedBack()
    turned.blocked(3.0, 100, 1)
    assert [since for count in counts if (since := turned.take(count)) is not None] == [since_s] * bool(
        since_s
    )


def test_a_motor_that_is_not_driven_may_stand():
    still = Standstill(Watch())
    assert not any(still.take(0.1 * n, 5, 10) for n in range(100))


def test_the_supply_is_what_the_battery_gives_without_load():
    supply = Supply(8.0, 0.5)
    for _ in range(5):
        supply.read(7.5, Draught(1.0))
    assert supply.open_v == pytest.approx(8.0)
    supply.read(4.0, Draught(0.0))
    assert supply.open_v == pytest.approx(8.0)
    assert supply.under(2.0) == pytest.approx(7.0)


def test_a_softer_battery_than_is_assumed_is_read_while_little_is_drawn():
    supply = Supply(8.0, 0.5)
    for drawn_a in (0.0, 0.4, 0.8, 0.0, 0.8, 0.4):
        supply.read(8.0 - 2.5 * drawn_a, Draught(drawn_a))
    assert supply.open_v == pytest.approx(8.0)
    other = supply.behind(2.5)
    assert other.open_v == pytest.approx(8.0)
    assert other.under(0.4) == pytest.approx(7.0)


def test_a_voltage_that_was_taken_while_the_current_changed_is_not_believed():
    supply = Supply(8.0, 0.5)
    supply.read(8.2, Draught(0.1))
    supply.read(7.0, Draught(0.0, 3.0))
    supply.read(8.1, Draught(0.3))
    assert supply.open_v == pytest.approx(8.25)


def test_the_current_of_late_is_its_mean_and_its_span():
    lately = Lately()
    assert lately.since(0.0) == (0.0, 0.0)
    for n, drawn_a in enumerate((9.0, 1.0, 2.0, 3.0)):
        lately.add(0.1 * n, drawn_a)
    assert lately.since(0.05) == (2.0, 2.0)
    assert lately.since(5.0) == (3.0, 0.0)


def test_a_battery_that_was_measured_before_a_reversal_looks_no_weaker_than_it_is():
    """The firmware measures it every sixth of a second: all three motors' models would turn too slowly by this."""
    twin = BrickTwin({"a": nxt_motor()})
    twin.read_battery(8.2, 0.1, BATTERY_AGE_S)
    twin.command("a", 90, "drive", 1.0)
    twin.move(2.0)
    twin.read_battery(8.2 - 0.35 * 0.1, 2.0, BATTERY_AGE_S)
    twin.command("a", -90, "drive", 2.0)
    twin.read_battery(7.6, 2.1, BATTERY_AGE_S)
    assert twin.supply_v == pytest.approx(8.2, abs=0.03)


def test_evidence_adds_up_and_is_forgotten():
    tally = Tally()
    tally.add(-1.0, 1.0, 5.0, -0.01, LOW_SPEED)
    assert (tally.nats, tally.since_s) == (0.0, 1.0)
    for n in range(10):
        tally.add(2.0, 1.1 + 0.1 * n, 5.0, -0.01, LOW_SPEED)
    assert tally.nats == pytest.approx(20.0)
    assert tally.since_s == 1.0
    assert tally.push == pytest.approx(-0.01)
    assert tally.regime == LOW_SPEED


def test_regimes_are_told_apart():
    regimes = Regimes()
    assert regimes.of(1.0, 0.0, 0) == "at low speed"
    assert regimes.of(2.0, 1.0, 50) == "just after a command changes"
    assert regimes.of(3.0, 10.0, 50) == "at high speed"
    assert regimes.of(3.1, -2.5, 50) == "just after the direction changes"
    assert regimes.of(4.0, -5.0, 50) == "at steady speed"


def test_history_gives_a_recording_with_what_the_bridge_did():
    history = History("b", counts_most=100)
    history.command(0.0, (Hold(0.0, 0.5, 0),))
    history.command(1.0, (Hold(0.0, 0.25, 1), Hold(0.2, 0.0, 2)))
    history.command(1.1, (Hold(0.0, -0.3, 0),))
    for n in range(200):
        history.count(0.02 * n, n)
    recording = history.recording(0.0, lambda from_s: 8.0 - 0.1 * from_s)
    assert np.unique(recording.columns["battery_v"][np.isfinite(recording.columns["b_tacho_deg"])]) == 7.8
    assert recording.time_s[0] == pytest.approx(2.0)  # only the last hundred counts were kept
    assert recording.columns["b_power_pct"][0] == pytest.approx(-30.0)
    assert np.isfinite(recording.columns["b_tacho_deg"]).sum() == 100
    assert history.seconds_since(3.0) == pytest.approx(0.98)


def _tick(number):
    return Tick(number, 0.0, 0.0, (), ())


def test_a_sink_that_fails_is_left_out():
    class Broken:
        def tick(self, _):
            raise RuntimeError

        def event(self, _):
            raise RuntimeError

        def close(self):
            raise RuntimeError

    memory = Memory()
    several = Several([Broken(), memory])
    several.tick(_tick(0))
    several.tick(_tick(1))
    several.event(Event(0.0, "started", "begin"))
    several.close()
    assert memory.count == 2


def test_an_ultrasonic_reading_that_cannot_be_is_disbelieved_but_not_for_ever():
    sensor = SensorTwin(4, "ultrasonic")
    found = [sensor.read(0.1 * n, 60.0 + (n % 2)) for n in range(20)]
    assert found[0] is None
    assert all(innovation.accepted for innovation in found[1:])
    assert not sensor.read(2.0, 180.0).accepted
    assert sensor.read(2.1, 255.0) is None  # no echo
    assert sensor.read(2.11, 60.0).accepted
    assert sensor.read(2.12, 60.0) is None  # sooner than the next ping
    later = [sensor.read(3.0 + 0.1 * n, 180.0) for n in range(8)]
    assert later[-1].accepted


def test_a_switch_surprises_when_it_changes():
    sensor = SensorTwin(1, "touch")
    for n in range(10):
        calm = sensor.read(0.1 * n, 0.0)
    surprise = sensor.read(1.0, 1.0)
    assert calm.predicted < 0.1
    assert surprise.normalised_square > 5.0
    assert sensor.read(1.1, 1.0).predicted > 0.8


def test_steady_programs_are_of_one_command():
    assert ProgramDriver(steady(30)).at(1.0, {})["a"] == (30, "drive")


def test_motors_take_turns_in_weighing_effects():
    """Else every fourth poll over USB would last longer than the link itself."""
    twin = BrickTwin(dict.fromkeys("abc", nxt_motor()), TwinOptions(candidates=("constant_load",)))
    before = dict.fromkeys("abc", 0.0)
    turns = []
    for n in range(60):
        for port in "abc":
            twin.read_tacho(port, 0.01 + 0.008 * n, 0)
        now = {port: twin.motor(port)._weighed_s for port in "abc"}
        turns.append([port for port in "abc" if now[port] != before[port]])
        before = now
    assert max(map(len, turns[4:])) == 1
    assert {port for turn in turns[4:] for port in turn} == set("abc")


@pytest.mark.parametrize(("mode", "winding_v"), [(DRIVE, 4.0), (FLOAT, 8.0)])
def test_a_bridge_draws_what_its_winding_takes_while_it_is_connected(mode, winding_v):
    batch = Batch([nxt_motor()], ["a"], [0.0], torque_time_s=1.0)
    batch.command("a", 0.0, [Hold(0.0, -0.5, mode)])
    batch.advance(1.0, 8.0)
    current_a = (winding_v - 0.4908 * abs(batch.state[0, 1])) / 7.6
    assert batch.drawn_a(0) == pytest.approx(0.5 * current_a, rel=1e-3)
