"""Sessions with a mock brick, in virtual time."""

import re

import pytest
from twin_feed import nxt_motor
from twin_rig import EVERY_SENSOR, Rig, mean_square, run, steady, world_with

from nxt_twin.brick.errors import LinkTimeoutError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.program import MotorProgram
from nxt_twin.twin.sinks import Memory


def test_a_model_that_is_right_holds_with_three_motors_and_four_sensors():
    outcome = run(Rig(), 14.0, ports=("a", "b", "c"), sensors=EVERY_SENSOR)
    assert outcome.kinds() == ["started", "stopped"]
    for port in "abc":
        innovations = outcome.innovations(f"{port}_tacho_deg")
        assert len(innovations) > 1000
        assert 0.05 < mean_square(innovations) < 1.3
        assert sum(not i.accepted for i in innovations) < 0.01 * len(innovations)
    assert {i.channel for tick in outcome.memory.ticks for i in tick.innovations} >= {
        "s1_touch",
        "s2_sound_raw",
        "s3_light_raw",
        "s4_ultrasonic_cm",
    }
    ultrasonic = outcome.innovations("s4_ultrasonic_cm")
    assert len(ultrasonic) > 100
    assert all(i.measured == 60.0 for i in ultrasonic)
    assert sum("battery_v" in row for row in outcome.rows) == pytest.approx(7, abs=1)


def test_it_holds_over_bluetooth():
    outcome = run(Rig(profile="bluetooth"), 20.0)
    assert outcome.kinds() == ["started", "stopped"]
    assert mean_square(outcome.innovations("a_tacho_deg")) < 1.3


def test_the_same_session_gives_the_same_numbers_with_and_without_a_viewer():
    def numbers(*sinks):
        outcome = run(Rig(), 4.0, sensors=EVERY_SENSOR, candidates=("constant_load",), sinks=list(sinks))
        return [(t.received_s, t.motors, t.innovations) for t in outcome.memory.ticks], outcome.rows

    assert numbers() == numbers(Memory())


def test_recorded_rows_have_the_documented_columns_in_order_of_time():
    outcome = run(Rig(), 2.0, sensors=EVERY_SENSOR)
    times = [row["time_s"] for row in outcome.rows]
    assert times == sorted(times)
    assert {"a_power_pct", "a_mode", "a_tacho_deg"} <= outcome.rows[0].keys()


def test_a_command_acts_after_the_counts_of_its_row():
    """The count is read before this row's command acts."""
    rows = run(Rig(), 2.0).rows
    first = next(n for n, row in enumerate(rows) if row["a_power_pct"] != 0.0)
    assert rows[first]["a_tacho_deg"] == rows[0]["a_tacho_deg"]
    assert rows[first]["time_s"] >= 0.5  # the program rests for so long
    assert rows[-1]["a_tacho_deg"] != rows[0]["a_tacho_deg"]


def test_a_session_may_end_before_its_time():
    memory = Memory()
    outcome = run(Rig(), 5.0, sinks=[memory], enough=lambda: memory.count >= 100)
    assert outcome.session.polls == 100
    assert outcome.kinds()[-1] == "stopped"


def test_more_friction_is_called_and_told_in_words(tmp_path):
    rig = Rig(world_with(tmp_path, coulomb_friction_nm=0.05))
    outcome = run(rig, 6.0)
    event = outcome.first("divergence")
    assert event is not None
    assert event.port == "a"
    assert event.channel == "a_tacho_deg"
    assert re.match(r"port A: from \d+\.\d s on, the motor turns slower than its model predicts", event.words)
    assert event.onset_s <= event.time_s
    assert outcome.session.monitors["a"].diverging


def test_the_weighed_effect_is_named(tmp_path):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.04}}))
    outcome = run(rig, 8.0, candidates=("constant_load", "viscous_friction", "coulomb_friction"))
    event = outcome.first("effect_named")
    assert event is not None
    assert "constant load" in event.words
    states = outcome.memory.ticks[-1].motors[0]
    assert states.effects["constant_load"] > 0.9
    assert sum(states.effects.values()) == pytest.approx(1.0)


def test_a_blocked_motor_is_no_missing_physics(tmp_path):
    rig = Rig(world_with(tmp_path, coulomb_friction_nm=1.0))
    outcome = run(rig, 3.0, program=steady(50))
    assert outcome.first("divergence") is None
    assert {"stall", "disconnected"} & set(outcome.kinds())


@pytest.mark.parametrize("known", [False, True])
def test_a_motor_that_turns_back_from_a_stop_is_off_a_model_that_has_none(tmp_path, known):
    stop = {"end_stop": {"limit_deg": 300.0, "restitution": 0.2}}
    segments = [{"duration_s": 2.0, "power_pct": power} for power in (40, -40, 40)]
    program = {
        "name": "against",
        "ports": ("a",),
        "runs": [{"name": "r", "segments": segments}],
        "rest_s": 0.0,
    }
    plant = plant_from_config(nxt_motor().to_config() | ({"effects": stop} if known else {}), "power_pct")
    rig = Rig(world_with(tmp_path, effects=stop))
    outcome = run(rig, 5.9, program=MotorProgram.model_validate(program), plant=plant)
    told = [event for event in outcome.memory.events if event.kind == "divergence"]
    assert ("stall" in outcome.kinds()) is not known
    assert ["turned back freely" in event.words for event in told] == [True] * (not known)


def test_a_low_battery_is_said_once(tmp_path):
    rig = Rig(world_with(tmp_path, battery={"voltage_v": 6.2}))
    outcome = run(rig, 8.0)
    assert outcome.kinds().count("low_battery") == 1
    assert outcome.first("divergence") is None


def test_the_model_goes_on_alone_while_the_link_is_lost_and_finds_the_motor_again():
    rig = Rig(cuts=((2.0, 3.2),))
    outcome = run(rig, 6.0, program=steady(40, 60.0))
    kinds = outcome.kinds()
    assert kinds == ["started", "link_lost", "link_back", "stopped"]
    alone = [tick for tick in outcome.memory.ticks if not tick.link_up]
    assert len(alone) >= 5
    assert alone[-1].motors[0].angle_deg > alone[0].motors[0].angle_deg + 50.0
    assert rig.opened == 2
    assert 1.2 <= outcome.session.unseen_s <= 2.0
    assert outcome.session.lasted_s == pytest.approx(6.0, abs=0.1)
    after = [i for i in outcome.innovations("a_tacho_deg") if i.time_s > 4.5]
    assert mean_square(after) < 1.5


def test_one_lost_reply_is_no_lost_link():
    rig = Rig()
    taken = {"count": 0}
    real = rig.open

    def flaky():
        brick = real()
        read = brick.motors.read

        def sometimes(port):
            taken["count"] += 1
            if taken["count"] % 50 == 0:
                raise LinkTimeoutError("late")
            return read(port)

        brick.motors.read = sometimes
        return brick

    rig.open = flaky
    outcome = run(rig, 3.0)
    assert outcome.kinds() == ["started", "stopped"]


@pytest.mark.parametrize("taken_up", [True, False])
def test_a_command_without_an_answer_is_no_divergence_and_its_row_is_kept(taken_up):
    rig = Rig()
    real = rig.open
    commands = {"count": 0}

    def flaky():
        brick = real()
        drive = brick.motors.drive

        def sometimes(*args, **options):
            commands["count"] += 1
            if commands["count"] % 3:
                return drive(*args, **options)
            if taken_up:
                drive(*args, **options)
            rig.clock.sleep(1.0)
            raise LinkTimeoutError("late")

        brick.motors.drive = sometimes
        return brick

    rig.open = flaky
    outcome = run(rig, 12.0, candidates=("coulomb_friction", "stiction"))
    assert outcome.kinds() == ["started", "stopped"]
    assert commands["count"] >= 9
    assert len(outcome.rows) == outcome.session.polls + commands["count"] // 3


def test_without_a_driver_the_bricks_word_is_taken_for_what_it_does():
    rig = Rig()
    real = rig.open

    def already_driven():
        brick = real()
        brick.motors.drive(0, 60)
        return brick

    rig.open = already_driven
    outcome = run(rig, 3.0, program="none")
    assert outcome.kinds() == ["started", "stopped"]
    last = outcome.memory.ticks[-1].motors[0]
    assert (last.power_pct, last.mode) == (60, "drive")
    assert last.speed_deg_per_s > 300.0


def test_leaving_lets_the_motors_coast():
    rig = Rig()
    run(rig, 1.0, program=steady(80))
    for _ in range(300):
        rig.host.tick()
    state = rig.host.firmware
    assert state is not None
    from nxt_twin.twin.polling import reported

    with rig.open() as brick:
        assert reported(brick.motors.read(0).value) == (0, "coast")
