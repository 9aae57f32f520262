"""Every numbered quirk of the firmware's fact sheet, by its number."""

from __future__ import annotations

import pytest
from mock_rig import BLUETOOTH, PROGRAM, USB, Rig

import firmware_protocol as fp
from firmware_protocol import Status
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.radio import RENAME_MS


def test_quirk_01_long_bluetooth_telegrams_are_taken_in_pieces_of_128_bytes(rig):
    battery = fp.encode_request(fp.GetBatteryLevel())
    first = fp.encode_request(fp.GetVersions()).ljust(128, b"\0")
    rig.firmware.receive(BLUETOOTH, fp.frame(first + battery))
    rig.run(5)
    replies = [reply[2:] for reply in rig.firmware.transmit(BLUETOOTH)]
    assert [reply[1] for reply in replies] == [fp.GetVersions.OPCODE, fp.GetBatteryLevel.OPCODE]


def test_quirk_01_a_long_write_goes_on_in_the_next_pieces(rig):
    data = bytes(range(200)) + bytes(100)
    handle = rig.get(fp.OpenWrite("long.dat", 300), BLUETOOTH).handle
    assert rig.get(fp.WriteFile(handle, data), BLUETOOTH).written == 300
    rig.get(fp.CloseFile(handle), BLUETOOTH)
    assert bytes(rig.firmware.loader.files[0].data) == data


def test_quirk_02_missing_bytes_are_those_of_the_telegram_before(rig):
    rig.drive(0, 77)
    rig.raw(bytes((0x00, 0x04, 1)))
    rig.run(2)
    assert rig.motor(1).power == 77


def test_quirk_03_a_single_zero_over_bluetooth_starts_the_program_named_in_the_buffer(rig):
    rig.upload("main.rxe", PROGRAM)
    rig.raw(bytes((0x80, 0x0B)) + b"main.rxe".ljust(20, b"\0"), BLUETOOTH)
    assert rig.raw(b"\0", BLUETOOTH) == bytes((0x02, 0x00, 0x00))
    rig.run(10)
    assert rig.get(fp.GetCurrentProgram()).name == "main.rxe"


@pytest.mark.parametrize("length", [2, 5, 40])
def test_quirk_04_unknown_system_opcodes_are_answered_with_the_requests_length_and_no_status(rig, length):
    reply = rig.raw(bytes((0x01, 0xFE)).ljust(length, b"\0"))
    assert len(reply) == length + 2
    assert reply[:2] == bytes((0x02, 0xFE))


def test_quirk_05_a_bluetooth_write_of_256_bytes_is_answered_after_125(rig):
    handle = rig.get(fp.OpenWrite("x.dat", 1000), BLUETOOTH).handle
    assert rig.get(fp.WriteFile(handle, bytes(253)), BLUETOOTH).written == 125


def test_quirk_06_empty_bluetooth_frames_are_swallowed(rig):
    telegram = fp.frame(fp.encode_request(fp.GetVersions()))
    assert rig.stream(b"\0\0\0\0" + telegram, BLUETOOTH)[:3] == bytes((0x02, 0x88, 0x00))


def test_quirk_07_read_repeats_the_requested_length_and_fills_with_zeros(rig):
    rig.upload("a.txt", b"abc")
    handle = rig.get(fp.OpenRead("a.txt")).handle
    answer = rig.ask(fp.ReadFile(handle, 10))
    assert answer.status is Status.END_OF_FILE
    assert answer.reply == fp.ReadFile.Reply(handle, 10, b"abc" + bytes(7))


def test_quirk_08_closing_a_handle_that_cannot_exist_succeeds(rig):
    assert rig.get(fp.CloseFile(16)).handle == 16
    assert rig.status(fp.CloseFile(3)) is Status.HANDLE_ALREADY_CLOSED


def test_quirk_09_incomplete_and_overrun_files_vanish_without_an_error(rig):
    for name, data in (("short.txt", b"abc"), ("over.txt", b"abcdefgh")):
        handle = rig.get(fp.OpenWrite(name, 5)).handle
        answer = rig.ask(fp.WriteFile(handle, data))
        assert answer.reply.written == min(5, len(data))
        assert answer.status is (Status.OK if len(data) < 5 else Status.END_OF_FILE_EXPECTED)
        assert rig.status(fp.CloseFile(handle)) is Status.OK
        assert rig.status(fp.OpenRead(name)) is Status.FILE_NOT_FOUND


def test_quirk_10_reading_an_empty_file_closes_handle_0_and_leaks_its_own(rig):
    handle = rig.get(fp.OpenWrite("empty.txt", 0)).handle
    rig.get(fp.CloseFile(handle))
    rig.upload("full.txt", b"abc")
    assert rig.get(fp.OpenRead("full.txt")).handle == 0
    assert rig.status(fp.OpenRead("empty.txt")) is Status.FILE_NOT_FOUND
    assert rig.status(fp.ReadFile(0, 3)) is Status.ILLEGAL_HANDLE
    assert rig.get(fp.OpenRead("full.txt")).handle == 0
    assert rig.get(fp.OpenRead("full.txt")).handle == 2


def test_quirk_11_free_flash_stays_wrong_after_a_dropped_download(rig):
    before = rig.free_flash()
    handle = rig.get(fp.OpenWrite("big.txt", 5000)).handle
    during = rig.free_flash()
    assert during < before
    rig.get(fp.CloseFile(handle))
    assert rig.free_flash() == during
    rig.ask(fp.DeleteFile("none.txt"))
    assert rig.free_flash() == before


@pytest.mark.parametrize(("transport", "still_open"), [(USB, False), (BLUETOOTH, True)])
def test_quirk_12_only_unplugging_usb_closes_file_handles(rig, transport, still_open):
    rig.upload("a.txt", b"abc")
    handle = rig.get(fp.OpenRead("a.txt"), transport).handle
    rig.firmware.unplug_usb()
    rig.firmware.disconnect_bluetooth()
    assert (rig.status(fp.ReadFile(handle, 1)) is Status.OK) == still_open


def test_quirk_13_a_module_search_stays_taken_after_it_found_nothing(rig):
    assert rig.status(fp.FindFirstModule("nothing.mod")) is Status.MODULE_NOT_FOUND
    assert rig.status(fp.FindFirstModule("*.*")) is Status.NO_MORE_HANDLES
    rig.get(fp.CloseModule(0))
    assert rig.get(fp.FindFirstModule("*.*")).name == "Comm.mod"


def test_quirk_14_writing_checks_the_mailbox_first_and_reading_the_program(rig):
    assert rig.status(fp.MessageWrite.of(20, b"hi")) is Status.ILLEGAL_MAILBOX
    assert rig.status(fp.MessageWrite.of(0, b"hi")) is Status.NO_ACTIVE_PROGRAM
    assert rig.status(fp.MessageRead(20, 0, remove=True)) is Status.NO_ACTIVE_PROGRAM
    rig.start_program()
    assert rig.status(fp.MessageRead(20, 0, remove=True)) is Status.ILLEGAL_MAILBOX


def test_quirk_15_starting_any_file_succeeds_at_first(rig):
    rig.upload("song.txt", b"la la la")
    assert rig.status(fp.StartProgram("song.txt")) is Status.OK
    rig.run(10)
    assert rig.status(fp.GetCurrentProgram()) is Status.NO_ACTIVE_PROGRAM
    assert rig.status(fp.StartProgram("none.rxe")) is Status.VALUE_OUT_OF_RANGE


def test_quirk_16_a_port_in_error_takes_a_write_whatever_its_type(rig):
    rig.set_sensor(0, fp.SensorType.LOW_SPEED)
    rig.run(30)
    request = fp.LowSpeedWrite.of(0, b"\x02\x42", 1)
    assert rig.status(request) is Status.OK
    rig.run(20)
    assert rig.status(fp.LowSpeedGetStatus(0)) is Status.BUS_ERROR
    rig.set_sensor(0, fp.SensorType.SWITCH)
    rig.run(30)
    assert rig.status(request) is Status.OK


def _read_ultrasonic(rig: Rig, register: int, length: int) -> None:
    assert rig.status(fp.ultrasonic.read_register(3, register, length)) is Status.OK
    rig.run(40)


def _wake_ultrasonic(rig: Rig) -> None:
    rig.set_sensor(3, fp.SensorType.LOW_SPEED_9V)
    rig.run(30)


def test_quirk_17_sixteen_received_bytes_look_like_none(rig):
    _wake_ultrasonic(rig)
    _read_ultrasonic(rig, 0x00, 8)
    assert rig.get(fp.LowSpeedGetStatus(3)).bytes_ready == 8
    _read_ultrasonic(rig, 0x08, 8)
    assert rig.get(fp.LowSpeedGetStatus(3)).bytes_ready == 0
    assert rig.get(fp.LowSpeedRead(3)).received == b""


def test_quirk_18_i2c_is_refused_for_20_ms_after_the_type_is_set(rig):
    rig.set_sensor(3, fp.SensorType.LOW_SPEED_9V)
    request = fp.ultrasonic.read_register(3, 0x42)
    assert rig.status(request) is Status.CHANNEL_NOT_READY
    rig.run(17)
    assert rig.status(request) is Status.CHANNEL_NOT_READY
    rig.run(2)
    assert rig.status(request) is Status.OK


def test_quirk_19_a_coasting_motor_is_driven_on_for_100_ms(rig):
    rig.drive(0, 100)
    rig.run(300)
    rig.coast(0)
    speeds = []
    for _ in range(101):
        speeds.append(rig.firmware.outputs.ports[0].actual_speed)
        rig.run(1)
    assert speeds == [*range(99, -1, -1), 0]


def test_quirk_20_a_reached_limit_coasts_even_with_the_brake_bit(rig):
    rig.drive(0, 80, mode=0x03, limit=180)
    rig.run(3000)
    state = rig.motor(0)
    assert state.run_state == fp.RunState.IDLE
    assert state.mode == 0x03
    assert not rig.firmware.outputs.motors[0].brake
    assert state.tacho_count > 190


def test_quirk_21_limits_chain_from_the_previous_target(rig):
    for turn in range(1, 4):
        rig.drive(0, 60, limit=600)
        rig.run(3500)
        assert rig.firmware.outputs.motors[0].limit_count == 600 * turn
        assert 600 * turn < rig.motor(0).tacho_count < 600 * turn + 300


def test_quirk_22_ramping_down_from_rest_is_running(rig):
    rig.drive(0, 60, state=fp.RunState.RAMP_DOWN, limit=500)
    rig.run(2)
    assert rig.motor(0).run_state == fp.RunState.RUNNING


def test_quirk_23_a_regulated_start_waits_101_ms(rig):
    rig.drive(0, 60, mode=0x07, regulation=fp.RegulationMode.SPEED)
    rig.run(98)
    assert rig.motor(0).tacho_count == 0
    assert rig.firmware.outputs.ports[0].actual_speed == 0
    rig.run(5)
    assert rig.firmware.outputs.ports[0].actual_speed > 0


def test_quirk_24_a_lone_synchronised_motor_stands_still(rig):
    rig.drive(0, 60, mode=0x07, regulation=fp.RegulationMode.SYNC)
    rig.run(1000)
    assert rig.motor(0).tacho_count == 0


def test_quirk_24_a_pair_removes_an_existing_difference(rig):
    rig.drive(1, 60, limit=150)
    rig.run(2000)
    ahead = rig.motor(1).block_tacho_count
    assert ahead > 140
    for port in (1, 2):
        rig.drive(port, 50, mode=0x07, regulation=fp.RegulationMode.SYNC)
    rig.run(4000)
    assert abs(rig.motor(1).block_tacho_count - rig.motor(2).block_tacho_count) < 30


def test_quirk_25_power_is_stored_as_sent(rig):
    rig.drive(0, 127)
    rig.run(50)
    assert rig.motor(0).power == 127
    assert rig.firmware.outputs.ports[0].actual_speed == 127


@pytest.mark.parametrize(("raw", "truth"), [(460, 1), (461, 0), (500, 0), (561, 0)])
def test_quirk_26_the_boolean_threshold_has_no_hysteresis(rig, raw, truth):
    rig.body.sensors[0] = rig.body.sensors[2]
    for approach in (0, 1023, 0):
        rig.body.sensors[2].raw.set(approach)
        rig.set_sensor(2, fp.SensorType.SWITCH, fp.SensorMode.BOOLEAN)
        rig.run(40)
        rig.body.sensors[2].raw.set(raw)
        rig.run(5)
        assert rig.sensor(2).scaled == truth


def test_quirk_27_a_count_starts_from_the_old_scaled_value(rig):
    rig.set_sensor(0, fp.SensorType.SWITCH, fp.SensorMode.RAW)
    rig.run(30)
    assert rig.sensor(0).scaled == 1023
    rig.set_sensor(0, fp.SensorType.SWITCH, fp.SensorMode.TRANSITION_COUNT)
    rig.run(5)
    rig.body.sensors[0].pressed.set(1)
    rig.run(5)
    assert rig.sensor(0).scaled == 1024


def test_quirk_28_no_sensor_keeps_its_readings_and_calls_them_valid(rig):
    rig.set_sensor(2, fp.SensorType.LIGHT_INACTIVE)
    rig.run(40)
    before = rig.sensor(2)
    rig.set_sensor(2, fp.SensorType.NO_SENSOR)
    rig.run(40)
    rig.body.sensors[2].raw.set(100)
    rig.run(10)
    after = rig.sensor(2)
    assert after.valid
    assert (after.raw, after.normalised, after.scaled) == (before.raw, before.normalised, before.scaled)


def test_quirk_29_the_battery_comes_in_steps_of_13_848_mv(rig):
    seen = set()
    for voltage_v in (7.0, 7.31, 8.04, 8.8, 9.0):
        rig.body.battery.open_circuit_v = voltage_v
        rig.run(170)
        seen.add(rig.get(fp.GetBatteryLevel()).voltage_mv)
    steps = {step * 13_848 // 1000 for step in range(1024)}
    assert len(seen) == 5
    assert seen <= steps


def test_quirk_30_a_system_opcode_in_a_direct_telegram_is_unknown(rig):
    assert rig.raw(b"\x00\x88") == bytes((0x02, 0x88, Status.UNKNOWN_OPCODE))


def test_quirk_31_port_ff_is_all_motors_when_setting_only(rig):
    rig.drive(fp.OutputPort.ALL, 50)
    rig.run(2)
    assert [rig.motor(port).power for port in range(3)] == [50, 50, 50]
    answer = rig.ask(fp.GetOutputState(fp.OutputPort.ALL))
    assert answer.status is Status.VALUE_OUT_OF_RANGE
    assert answer.reply == fp.blank_reply(fp.GetOutputState)
    assert rig.status(fp.ResetMotorPosition(0xFF, relative=True)) is Status.VALUE_OUT_OF_RANGE


def test_quirk_32_a_search_for_an_ending_finds_four_letters_anywhere(rig):
    rig.upload("a.texas", b"1")
    rig.upload("b.txt.old", b"1")
    assert rig.get(fp.FindFirst("*.txt")).name == "b.txt.old"
    assert rig.get(fp.FindFirst("*.texts")).name == "a.texas"


def test_quirk_33_a_retry_sends_the_bytes_behind_the_message(rig):
    _wake_ultrasonic(rig)
    assert rig.status(fp.LowSpeedWrite.of(3, bytes((0x02, 0x41, 0x00, 0x02, 0x41, 0x00)), 0)) is Status.OK
    rig.run(20)
    sent: list[bytes] = []
    sonar = rig.body.sensors[3]
    listen = sonar.i2c_write
    sonar.acknowledging = False
    sonar.i2c_write = lambda data, time_s: (sent.append(data), listen(data, time_s))[1]
    rig.get(fp.LowSpeedWrite.of(3, bytes((0x10, 0x20)), 0))
    rig.run(20)
    assert sent == [b"\x10\x20", b"\x00\x02", b"\x41\x00", b"\x00\x00"]
    assert rig.status(fp.LowSpeedGetStatus(3)) is Status.BUS_ERROR


def test_quirk_34_a_reset_count_ends_running_for_ever(rig):
    rig.get(fp.ResetTachoCount(0))
    rig.run(3)
    port = ("ports", 0)
    for field, value in (("mode", 1), ("run_state", 0x20), ("speed", 60)):
        rig.get(fp.locate(fp.OutputMap, *port, field).write_request(value))
    rig.get(fp.locate(fp.OutputMap, *port, "flags").write_request(fp.OutputFlags.MODE | fp.OutputFlags.SPEED))
    rig.run(3)
    assert rig.motor(0).run_state == fp.RunState.IDLE


def test_quirk_35_writing_to_an_invalid_handle_is_refused_and_harmless(rig):
    for handle in (0, 5, 16, 200):
        answer = rig.ask(fp.WriteFile(handle, b"abc"))
        assert answer.status is Status.ILLEGAL_HANDLE
        assert answer.reply == fp.WriteFile.Reply(handle, 0)


def test_quirk_36_renaming_over_bluetooth_can_lose_telegrams_for_a_second():
    rig = Rig(World(rename_loses_telegrams=True))
    assert rig.status(fp.SetBrickName("Rover"), BLUETOOTH) is Status.OK
    assert rig.raw(fp.encode_request(fp.GetVersions()), BLUETOOTH) is None
    assert rig.status(fp.SetBrickName("Other")) is Status.BLUETOOTH_BUSY
    rig.run(RENAME_MS)
    assert rig.get(fp.GetDeviceInfo(), BLUETOOTH).name == "Rover"
