"""What a client meets on a brick and met otherwise on an earlier mock; bytes in, bytes out."""

from __future__ import annotations

import pytest
from mock_rig import BLUETOOTH, PROGRAM, USB, Rig

import firmware_protocol as fp
from firmware_protocol import Status

STARTS_TICKS = 8
"""A program's devices are reset so many ticks behind the telegram, and one more shows it."""
SHOWS_END_TICKS = 751
"""So many ticks behind STOP_PROGRAM its end is still shown."""

START = fp.encode_request(fp.StartProgram("main.rxe"), reply_required=False)
STOP = fp.encode_request(fp.StopProgram(), reply_required=False)


def running(rig: Rig) -> str | None:
    answer = rig.ask(fp.GetCurrentProgram())
    return answer.reply.name if answer.status is Status.OK else None


def after(rig: Rig, telegram: bytes, ticks: int) -> None:
    """Run the telegram's own tick, and so many behind it."""
    rig.firmware.receive(USB, telegram)
    rig.run(ticks + 1)


@pytest.mark.parametrize(("ticks", "shown"), [(STARTS_TICKS, None), (STARTS_TICKS + 1, "main.rxe")])
def test_a_program_shows_nine_ticks_after_its_start(rig, ticks, shown):
    rig.upload("main.rxe", PROGRAM)
    after(rig, START, ticks - 1)
    assert running(rig) == shown


@pytest.mark.parametrize(("ticks", "mode"), [(STARTS_TICKS, 1), (STARTS_TICKS + 1, 0)])
def test_a_start_resets_the_motors_one_tick_sooner(rig, ticks, mode):
    rig.upload("main.rxe", PROGRAM)
    rig.drive(0, 50, mode=1)
    after(rig, START, ticks - 1)
    assert rig.motor(0).mode == mode


@pytest.mark.parametrize(("ticks", "shown"), [(1, "main.rxe"), (2, None)])
def test_a_stop_shows_after_two_ticks(rig, ticks, shown):
    rig.start_program()
    after(rig, STOP, ticks - 1)
    assert running(rig) == shown


@pytest.mark.parametrize(("ticks", "shown"), [(SHOWS_END_TICKS, None), (SHOWS_END_TICKS + 1, "main.rxe")])
def test_a_start_is_lost_while_the_end_of_the_last_is_shown(rig, ticks, shown):
    rig.start_program()
    after(rig, STOP, ticks - 1)
    assert rig.status(fp.StartProgram("main.rxe")) is Status.OK
    rig.run(2_000)
    assert running(rig) == shown


def test_a_start_while_a_program_runs_is_ignored(rig):
    rig.upload("other.rxe", PROGRAM)
    rig.start_program()
    assert rig.status(fp.StartProgram("other.rxe")) is Status.OK
    rig.run(50)
    assert running(rig) == "main.rxe"
    rig.get(fp.StopProgram())
    rig.run(1_000)
    assert running(rig) is None


def test_a_start_waits_until_a_tone_has_ended(rig):
    rig.upload("main.rxe", PROGRAM)
    rig.get(fp.PlayTone(440, 300))
    rig.get(fp.StartProgram("main.rxe"))
    rig.run(250)
    assert running(rig) is None
    rig.run(100)
    assert running(rig) == "main.rxe"


def test_a_file_of_no_known_kind_keeps_the_menus_busy_for_ever(rig):
    rig.upload("song.txt", b"la la la")
    rig.upload("main.rxe", PROGRAM)
    rig.get(fp.StartProgram("song.txt"))
    rig.run(2_000)
    assert rig.status(fp.StartProgram("main.rxe")) is Status.OK
    rig.run(2_000)
    assert running(rig) is None


def test_a_sound_file_that_is_started_plays(rig):
    rig.upload("beep.rso", bytes.fromhex("0100 0320 1F40 0000") + bytes(800))
    rig.get(fp.StartProgram("beep.rso"))
    state = fp.locate(fp.SoundMap, "state")
    rig.run(50)
    assert rig.get(state.read_request()).data == b"\x02"
    rig.run(100)
    assert rig.get(state.read_request()).data == b"\x00"


def test_a_running_program_holds_a_handle(rig):
    rig.start_program()
    assert rig.get(fp.FindFirst("*.*")).handle == 1
    assert rig.status(fp.DeleteFile("main.rxe")) is Status.FILE_IS_BUSY
    rig.get(fp.StopProgram())
    rig.run(5)
    assert rig.get(fp.OpenRead("main.rxe")).handle == 0
    rig.get(fp.CloseFile(0))
    rig.get(fp.DeleteFile("main.rxe"))


def test_a_fresh_flash_holds_the_settings(rig):
    assert rig.free_flash() == 120_868
    found = rig.get(fp.FindFirst("*.*"))
    assert (found.name, found.size) == ("NVConfig.sys", 6)
    rig.get(fp.CloseFile(found.handle))
    handle = rig.get(fp.OpenRead("NVConfig.sys")).handle
    assert rig.get(fp.ReadFile(handle, 6)).data == bytes((0x78, 1, 4, 3, 0, 0))


def long_read(rig: Rig, handle: int, length: int, *, reply_required: bool = True) -> list[bytes]:
    """What comes over Bluetooth, piece by piece, after a READ."""
    request = fp.encode_request(fp.ReadFile(handle, length), reply_required=reply_required)
    rig.firmware.receive(BLUETOOTH, fp.frame(request))
    pieces = []
    for _ in range(50):
        rig.firmware.tick()
        pieces += rig.firmware.transmit(BLUETOOTH)
    return pieces


@pytest.mark.parametrize("reply_required", [True, False])
def test_a_long_read_comes_in_chunks_asked_for_or_not(rig, reply_required):
    data = bytes(range(250)) * 2
    rig.upload("a.bin", data)
    handle = rig.get(fp.OpenRead("a.bin")).handle
    pieces = long_read(rig, handle, 400, reply_required=reply_required)
    assert [len(piece) for piece in pieces] == [128, 128, 128, 24]
    whole = b"".join(pieces)
    assert whole[:8] == bytes.fromhex("9601 02 82 00") + bytes((handle,)) + bytes.fromhex("9001")
    assert whole[8:] == data[:400]


def test_a_long_read_that_meets_the_end_sends_fewer_bytes_than_it_promised(rig):
    rig.upload("a.bin", bytes(200))
    handle = rig.get(fp.OpenRead("a.bin")).handle
    pieces = long_read(rig, handle, 600)
    assert int.from_bytes(pieces[0][:2], "little") == 606
    assert [len(piece) for piece in pieces] == [128, 80]
    assert pieces[0][4] == Status.OK


def test_a_long_read_keeps_the_radio_busy(rig):
    rig.upload("a.bin", bytes(600))
    handle = rig.get(fp.OpenRead("a.bin")).handle
    rig.firmware.receive(BLUETOOTH, fp.frame(fp.encode_request(fp.ReadFile(handle, 500))))
    rig.run(2)
    assert rig.status(fp.SetBrickName("Other")) is Status.BLUETOOTH_BUSY
    rig.run(50)
    assert rig.status(fp.SetBrickName("Other")) is Status.OK


def test_an_i2c_read_with_an_error_is_shorter_by_what_waits(rig):
    rig.set_sensor(3, fp.SensorType.LOW_SPEED_9V)
    rig.run(30)
    rig.get(fp.ultrasonic.read_register(3, 0x00, 5))
    rig.run(40)
    rig.set_sensor(3, fp.SensorType.SWITCH)
    reply = rig.raw(fp.encode_request(fp.LowSpeedRead(3)))
    assert reply == bytes((0x02, 0x10, Status.CHANNEL_NOT_READY, 5)) + bytes(11)


def test_an_i2c_read_that_finds_bytes_is_ok_while_the_next_is_pending(rig):
    rig.set_sensor(3, fp.SensorType.LOW_SPEED_9V)
    rig.run(30)
    rig.get(fp.ultrasonic.read_register(3, 0x08, 4))
    rig.run(40)
    rig.get(fp.ultrasonic.read_register(3, 0x08, 4))
    assert rig.status(fp.LowSpeedGetStatus(3)) is Status.PENDING
    assert rig.get(fp.LowSpeedRead(3)).received == b"LEGO"


def test_contacts_and_connections_beyond_the_table_are_answered(rig):
    assert rig.raw(bytes((0x00, 0x1C, 30))) == bytes((0x02, 0x1C, 0x00)) + bytes(18)
    rig.raw(bytes((0x01, 0x9B)))
    reply = rig.raw(bytes((0x00, 0x1E, 4)))
    # The name's place keeps what the reply before had there: the brick's name from its second letter.
    assert reply == bytes((0x02, 0x1E, 0x00, 0x00)) + b"XT".ljust(14, b"\0") + bytes.fromhex("001653")


@pytest.mark.parametrize(("length", "status"), [(59, Status.OK), (60, Status.UNDEFINED_ERROR)])
def test_a_poll_over_usb_takes_59_bytes(rig, length, status):
    reply = rig.raw(bytes((0x01, 0xA2, 0, length)))
    assert (reply[2], len(reply)) == (status, 5 + (length if status is Status.OK else 0))


@pytest.mark.parametrize(("name", "size"), [("Comm.mod", 1896), ("Ui.mod", 40)])
def test_io_maps_have_the_firmwares_size(rig, name, size):
    assert rig.get(fp.FindFirstModule(name)).io_map_size == size


def test_sounds_have_no_rate_of_their_own_and_the_volume_is_theirs(rig):
    assert rig.get(fp.locate(fp.SoundMap, "sample_rate_hz").read_request()).data == b"\0\0"
    rig.get(fp.locate(fp.UiMap, "volume").write_request(1))
    assert rig.get(fp.GetProperty(fp.PropertyId.VOLUME)).value == 4
    rig.get(fp.locate(fp.SoundMap, "volume").write_request(2))
    assert rig.get(fp.GetProperty(fp.PropertyId.VOLUME)).value == 2


@pytest.mark.parametrize("first", ["tone", "failed start"])
def test_the_first_sound_or_program_end_after_boot_closes_handle_0(rig, first):
    rig.upload("bad.rxe", b"no program")
    assert rig.get(fp.OpenRead("bad.rxe")).handle == 0
    rig.get(fp.PlayTone(440, 10) if first == "tone" else fp.StartProgram("bad.rxe"))
    rig.run(30)
    assert rig.status(fp.ReadFile(0, 1)) is Status.ILLEGAL_HANDLE
    assert rig.get(fp.OpenRead("bad.rxe")).handle == 0
    rig.get(fp.PlayTone(440, 10))
    rig.run(30)
    assert rig.status(fp.ReadFile(0, 1)) is Status.OK


@pytest.mark.parametrize("opcode", [0x00, 0x02], ids=["START_PROGRAM", "PLAY_SOUND_FILE"])
def test_a_start_closes_handle_0_and_keeps_its_own(rig, opcode):
    rig.upload("song.txt", b"la la la")
    opened = [rig.get(fp.OpenRead("song.txt")).handle for _ in range(2)]
    assert opened == [0, 1]
    body = b"song.txt".ljust(20, b"\0")
    assert rig.raw(bytes((0x00, opcode)) + (b"\0" + body if opcode else body)) == bytes((0x02, opcode, 0x00))
    assert rig.status(fp.ReadFile(0, 1)) is Status.ILLEGAL_HANDLE
    assert rig.status(fp.ReadFile(1, 1)) is Status.OK
    assert [rig.get(fp.OpenRead("song.txt")).handle for _ in range(2)] == [0, 3]


def test_a_system_command_that_wants_no_reply_leaves_one_in_the_buffer(rig):
    rig.raw(fp.encode_request(fp.GetDeviceInfo(), reply_required=False))
    assert rig.raw(bytes((0x01, 0xFE, 0, 0, 0, 0))) == bytes((0x02, 0xFE, 0x00)) + b"NXT\0\0"


def test_the_programs_memory_is_blank_until_one_uses_it(rig):
    reply = rig.get(fp.IoMapRead(fp.ModuleId.COMMAND, 50, 8))
    assert reply.data == b"\0\0" + bytes.fromhex("efbeadde efbe")


def test_a_search_that_is_cropped_crops_what_it_found(rig):
    handle = rig.get(fp.OpenWriteData("log.rdt", 1000)).handle
    rig.get(fp.WriteFile(handle, b"abc"))
    rig.get(fp.CloseFile(handle))
    rig.get(fp.CropDataFile(rig.get(fp.FindFirst("*.rdt")).handle))
    assert rig.get(fp.FindFirst("log.rdt")).size == 3


def test_a_data_file_tells_what_was_in_it_when_it_was_closed(rig):
    handle = rig.get(fp.OpenWriteData("log.rdt", 100)).handle
    rig.get(fp.WriteFile(handle, b"abc"))
    assert rig.get(fp.OpenRead("log.rdt")).size == 0
    rig.get(fp.CloseFile(handle))
    assert rig.get(fp.OpenRead("log.rdt")).size == 3


def test_a_download_keeps_others_files_from_being_deleted(rig):
    # Its handle stands before the first file, and moves on when one is listed that ends sooner.
    download = rig.get(fp.OpenWrite("long.txt", 10)).handle
    rig.upload("short.txt", b"abc")
    assert rig.status(fp.DeleteFile("short.txt")) is Status.FILE_IS_BUSY
    rig.get(fp.CloseFile(download))
    assert rig.status(fp.DeleteFile("short.txt")) is Status.OK


def test_a_download_under_a_wildcard_can_be_started_twice(rig):
    opened = [rig.get(fp.OpenWrite("*.abc", 5)).handle for _ in range(2)]
    assert opened == [0, 1]
    assert rig.status(fp.OpenWrite("plain.abc", 5)) is Status.OK
    assert rig.status(fp.OpenWrite("PLAIN.abc", 5)) is Status.FILE_EXISTS


def test_find_next_on_a_handle_that_never_was_used_finds_the_second_file(rig):
    rig.upload("a.txt", b"1")
    found = rig.get(fp.FindNext(5))
    assert (found.handle, found.name) == (5, "NVConfig.sys")
    assert rig.status(fp.FindNext(5)) is Status.FILE_NOT_FOUND


def test_find_next_module_without_a_search_lists_all(rig):
    assert rig.get(fp.FindNextModule(0)).name == "Comm.mod"
    assert rig.get(fp.FindNextModule(0)).name == "Input.mod"


@pytest.mark.parametrize(("status", "stored"), [(0x00, True), (0x20, True), (0x40, True), (0xBE, False)])
def test_a_message_of_another_brick_is_stored_unless_its_status_is_an_error(rig, status, stored):
    rig.start_program()
    reply = fp.encode_reply(fp.MessageRead, fp.MessageRead.Reply.of(4, b"hello"), status=Status(status))
    assert rig.raw(reply) is None
    assert (rig.status(fp.MessageRead(4, 0, remove=True)) is Status.OK) == stored


@pytest.mark.parametrize(
    ("raw", "celsius", "fahrenheit"),
    # Source: c_input.c cInputTempConv and cInputCalcSensorValue, in C with the brick's word sizes.
    [
        (100, 695, 1571),
        (300, 666, 1518),
        (389, 475, 1175),
        (517, 301, 861),
        (700, 103, 505),
        (795, -2, 23909),
        (837, -54, 23815),
        (928, 7677, 14138),
    ],
)
def test_the_temperature_sensor_follows_the_firmwares_curve(rig, raw, celsius, fahrenheit):
    rig.body.sensors[2].raw.set(raw)
    for mode, tenths in ((fp.SensorMode.CELSIUS, celsius), (fp.SensorMode.FAHRENHEIT, fahrenheit)):
        rig.set_sensor(2, fp.SensorType.TEMPERATURE, mode)
        rig.run(40)
        assert rig.sensor(2).scaled == tenths


def test_a_tacho_limit_over_2_to_the_31_lies_behind_the_motor(rig):
    rig.drive(0, 60, limit=0x80000001)
    rig.run(5)
    assert rig.motor(0).run_state == fp.RunState.IDLE
