"""From a recording to what drives and what is read."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import NXT

from nxt_twin.errors import RecordingError
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_CURRENT, MODE_DRIVE, MODE_VOLTAGE
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.simulate import with_supply
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.recording import Recording, SignalKinds

ROWS = 200
TIME_S = np.arange(ROWS) * 0.01
NAN = np.nan


def brick(**columns):
    plain = {"time_s": TIME_S, "a_power_pct": np.zeros(ROWS), "a_tacho_deg": np.arange(ROWS, dtype=float)}
    return Recording("run.csv", {**plain, **columns})


def mapped(input_kind, output_kind, *, level=0.5, **more):
    columns = {"time_s": TIME_S, "input": np.full(ROWS, level), "output": 0.1 * np.arange(ROWS), **more}
    return Recording("bench.mat", columns, kinds=SignalKinds(input_kind, output_kind), output_quantum=1e-4)


def power(*changes):
    column = np.full(ROWS, NAN)
    for row, level in changes:
        column[row] = level
    return column


def test_a_command_holds_until_the_row_that_changes_it():
    signals = signals_of(brick(a_power_pct=power((10, 60.0), (50, -30.0), (60, -30.0))), "a")
    np.testing.assert_allclose(signals.command_time_s, [0.0, 0.1, 0.5])
    np.testing.assert_allclose(signals.command, [0.0, 0.6, -0.3])


def test_the_command_at_a_reading_is_the_one_in_force_before_it():
    held = signals_of(brick(a_power_pct=power((10, 60.0), (50, -30.0))), "a").command_at_samples()
    np.testing.assert_allclose(held[[0, 10, 11, 50, 51, 199]], [0.0, 0.0, 0.6, 0.6, -0.3, -0.3])


def test_readings_are_in_radians_and_a_row_without_one_has_none():
    tacho = np.where(np.arange(ROWS) % 2, 90.0, NAN)
    signals = signals_of(brick(a_tacho_deg=tacho), "a")
    np.testing.assert_allclose(signals.measured[1::2], np.pi / 2.0)
    assert np.isnan(signals.measured[::2]).all()
    assert signals.quantum == pytest.approx(np.pi / 180.0)
    assert signals.channel == "a_tacho_deg"


def test_a_change_of_mode_is_a_command_of_its_own():
    mode = np.where(TIME_S < 1.0, DRIVE_MODES.index("drive"), DRIVE_MODES.index("brake"))
    signals = signals_of(brick(a_mode=mode), "a")
    np.testing.assert_array_equal(signals.command_mode, [MODE_DRIVE, MODE_BRAKE])


def test_each_port_has_its_own_signals():
    recording = brick(c_power_pct=np.full(ROWS, 50.0), c_tacho_deg=np.zeros(ROWS))
    assert signals_of(recording, "c").command[0] == 0.5
    assert signals_of(recording, "a").command[0] == 0.0


def test_the_supply_is_a_line_that_readings_under_load_do_not_bend():
    at_rest_v = 8.2 - 0.03 * TIME_S
    read = np.full(ROWS, NAN)
    read[::5] = at_rest_v[::5]
    read[::15] -= 0.9
    signals = signals_of(brick(battery_v=read), "a")
    np.testing.assert_allclose(
        signals.command_supply_v, np.interp(signals.command_time_s, TIME_S, at_rest_v), atol=0.03
    )


def test_a_falling_supply_acts_though_the_command_stands():
    signals = signals_of(brick(a_power_pct=np.full(ROWS, 50.0), battery_v=8.0 - 0.5 * TIME_S), "a")
    assert signals.command_time_s.size > 20
    assert np.all(signals.command == 0.5)
    assert signals.command_supply_v[-1] == pytest.approx(7.0, abs=0.02)


def test_one_reading_of_the_battery_stands_for_the_whole_run():
    signals = signals_of(brick(battery_v=power((120, 7.7))), "a")
    np.testing.assert_allclose(signals.command_supply_v, 7.7)


def test_a_battery_of_no_volts_was_not_read():
    assert np.isnan(signals_of(brick(battery_v=power((0, 0.0), (90, 0.0))), "a").command_supply_v).all()
    signals = signals_of(brick(battery_v=power((0, 0.0), (120, 7.7))), "a")
    np.testing.assert_allclose(signals.command_supply_v, 7.7)


def test_a_supply_that_is_switched_on_late_is_used_as_measured():
    read = np.where(np.arange(ROWS) < 50, 0.0, 7.2)
    signals = signals_of(brick(battery_v=read), "a")
    np.testing.assert_allclose(signals.command_supply_v[[0, -1]], [0.0, 7.2])


def test_a_battery_that_was_never_read_is_taken_from_the_plant():
    signals = signals_of(brick(), "a")
    assert np.isnan(signals.command_supply_v).all()
    filled = with_supply(signals, plant_from_config({**NXT, "supply_v": 7.4}, "power_pct"))
    np.testing.assert_array_equal(filled.command_supply_v, 7.4)


@pytest.mark.parametrize(
    ("input_kind", "level", "command", "mode"),
    [
        ("power_pct", 50.0, 0.5, MODE_DRIVE),
        ("voltage_v", 6.0, 6.0, MODE_VOLTAGE),
        ("current_a", 0.3, 0.3, MODE_CURRENT),
        ("torque_nm", 0.05, 0.05, MODE_DRIVE),
    ],
)
def test_a_mapped_input_acts_as_its_kind_says(input_kind, level, command, mode):
    signals = signals_of(mapped(input_kind, "position_rad", level=level), None)
    assert signals.command[0] == command
    assert signals.command_mode[0] == mode
    assert signals.input_kind == input_kind
    assert not signals.is_speed


def test_a_voltage_beyond_a_battery_s_is_one_that_the_bench_gave_unless_its_supply_was_recorded():
    bench = signals_of(mapped("voltage_v", "position_rad", level=-24.0), None)
    assert np.abs(bench.command_supply_v).min() == 24.0
    fed = signals_of(mapped("voltage_v", "position_rad", level=-24.0, supply_v=np.full(ROWS, 7.2)), None)
    assert fed.command_supply_v.max() == pytest.approx(7.2)


def test_a_mapped_output_may_be_a_speed():
    signals = signals_of(mapped("torque_nm", "speed_rad_per_s"), None)
    assert signals.is_speed
    assert signals.quantum == 1e-4
    np.testing.assert_allclose(signals.measured, 0.1 * np.arange(ROWS))


def test_a_supply_that_nearly_every_row_has_is_used_as_measured():
    read = np.round(8.0 - 0.6 * (np.sin(9.0 * TIME_S) > 0.0), 1)
    read[::10] = np.nan
    for signals in (
        signals_of(brick(battery_v=read), "a"),
        signals_of(mapped("power_pct", "position_rad", supply_v=read), None),
    ):
        held = signals.command_supply_v[np.searchsorted(signals.command_time_s, TIME_S, side="right") - 1]
        seen = np.isfinite(read)
        np.testing.assert_allclose(held[seen], read[seen])


def test_a_mapped_motor_coasts_where_its_mode_says_so():
    mode = (TIME_S > 1.0) * float(MODE_COAST)
    for kind, driven in (("power_pct", MODE_DRIVE), ("voltage_v", MODE_VOLTAGE)):
        signals = signals_of(mapped(kind, "position_rad", mode=mode), None)
        at = np.searchsorted(signals.command_time_s, TIME_S, side="right") - 1
        np.testing.assert_array_equal(signals.command_mode[at], np.where(mode > 0.0, MODE_COAST, driven))
    torque = signals_of(mapped("torque_nm", "position_rad", mode=mode), None)
    assert torque.command[torque.command_mode == MODE_COAST].tolist() == [0.0]


def test_an_encoder_s_step_is_the_sidecar_s():
    stepped = replace(brick(), tacho_step_deg={"a": 0.088})
    assert signals_of(stepped, "a").quantum == pytest.approx(np.radians(0.088))


def test_a_mapped_supply_is_used():
    signals = signals_of(mapped("power_pct", "position_rad", supply_v=np.full(ROWS, 7.2)), None)
    np.testing.assert_allclose(signals.command_supply_v, 7.2)


def test_part_of_a_run_keeps_all_commands():
    whole = signals_of(brick(a_power_pct=power((10, 60.0), (50, -30.0))), "a")
    part = whole.part(np.array([0, 100, 150]))
    np.testing.assert_array_equal(part.command_time_s, whole.command_time_s)
    np.testing.assert_array_equal(part.time_s, TIME_S[[0, 100, 150]])
    np.testing.assert_array_equal(part.measured, whole.measured[[0, 100, 150]])


@pytest.mark.parametrize("port", ["b", "c"])
def test_a_port_that_was_not_recorded_is_refused_by_its_column(port):
    with pytest.raises(RecordingError, match=f"run.csv, column {port}_power_pct"):
        signals_of(brick(), port)


def test_too_few_readings_are_refused():
    tacho = np.full(ROWS, NAN)
    tacho[:9] = 0.0
    with pytest.raises(RecordingError, match="a_tacho_deg: fewer than 10 readings"):
        signals_of(brick(a_tacho_deg=tacho), "a")


def test_a_command_knows_by_how_much_longer_than_others_the_polls_beside_its_row_are():
    time_s = np.array([0.0, 0.01, 0.03, 0.04, 0.05])
    run = Recording(
        "run.csv",
        {
            "time_s": time_s,
            "a_power_pct": np.array([0.0, 50.0, 0.0, 0.0, 50.0]),
            "a_tacho_deg": np.arange(5.0),
        },
    )
    signals = signals_of(run, "a", fewest_readings=3)
    assert signals.command_time_s.tolist() == [0.0, 0.01, 0.03, 0.05]
    np.testing.assert_allclose(
        3.0 * signals.command_polls, [[-0.01, 0.0], [0.02, -0.01], [-0.01, 0.02], [0.0, -0.01]], atol=1e-12
    )
    between = replace(signals, command_time_s=signals.command_time_s + 1e-3, command_polls=np.zeros((0, 2)))
    assert not between.command_polls.any()
