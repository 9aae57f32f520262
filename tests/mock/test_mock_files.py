"""Files, modules, settings and messages as a client sees them."""

from __future__ import annotations

import pytest
from mock_rig import BLUETOOTH, USB, Rig

import firmware_protocol as fp
from firmware_protocol import Status
from nxt_twin.mock.firmware.firmware import Power
from nxt_twin.mock.firmware.flash import USER_SECTORS, free_bytes, sectors_needed
from nxt_twin.mock.firmware.system import ERASE_MS


def names(rig: Rig, pattern: str) -> list[str]:
    answer = rig.ask(fp.FindFirst(pattern))
    found = []
    handle = answer.reply.handle
    while answer.status is Status.OK:
        found.append(answer.reply.name)
        answer = rig.ask(fp.FindNext(handle))
    if found:
        rig.get(fp.CloseFile(handle))
    return found


def test_files_are_found_newest_first_whatever_their_case(rig):
    for name in ("one.txt", "Two.TXT", "three.rso"):
        rig.upload(name, b"data")
    assert names(rig, "*.*") == ["three.rso", "Two.TXT", "one.txt", "NVConfig.sys"]
    assert names(rig, "*.txt") == ["Two.TXT", "one.txt"]
    assert names(rig, "ONE.*") == ["one.txt"]
    assert names(rig, "two.txt") == ["Two.TXT"]
    assert names(rig, "*ne.txt") == []


def test_a_name_can_be_used_once_and_has_19_characters_at_most(rig):
    rig.upload("a.txt", b"data")
    assert rig.status(fp.OpenWrite("A.TXT", 3)) is Status.FILE_EXISTS
    rig.get(fp.OpenWrite("b.txt", 3))
    assert rig.status(fp.OpenWrite("b.txt", 3)) is Status.FILE_EXISTS
    assert rig.status(fp.OpenWrite("x" * 20, 3)) is Status.ILLEGAL_FILE_NAME


def test_handles_and_write_buffers_run_out(rig):
    for number in range(4):
        rig.get(fp.OpenWrite(f"{number}.txt", 3))
    assert rig.status(fp.OpenWrite("5.txt", 3)) is Status.NO_WRITE_BUFFERS
    rig.get(fp.CloseFile(0))
    rig.upload("a.txt", b"abc")
    opened = [rig.get(fp.OpenRead("a.txt")).handle for _ in range(13)]
    assert opened == [0, *range(4, 16)]
    assert rig.status(fp.OpenRead("a.txt")) is Status.NO_MORE_HANDLES


def test_the_table_holds_127_files(rig):
    for number in range(127 - len(names(rig, "*.*"))):
        rig.firmware.loader.close(rig.firmware.loader.open_write(f"{number}", 0))
    assert rig.status(fp.OpenWrite("more", 1)) is Status.NO_MORE_FILES


def test_free_flash_shrinks_by_sectors_and_comes_back(rig):
    before = rig.free_flash()
    rig.upload("a.txt", bytes(1000))
    sectors = len(USER_SECTORS) - 1
    assert before == free_bytes(sectors)
    assert rig.free_flash() == free_bytes(sectors - sectors_needed(1000))
    rig.get(fp.DeleteFile("a.txt"))
    assert rig.free_flash() == before
    assert rig.status(fp.OpenWrite("big.txt", before + 1)) is Status.NO_SPACE
    rig.get(fp.OpenWrite("big.txt", before))


def test_linear_files_need_room_in_one_piece(rig):
    loader = rig.firmware.loader
    size = free_bytes(100)
    for number in range(4):
        loader.close(loader.open_write(f"{number}", 0))
        handle = loader.open_write(f"file{number}", size)
        loader.write(handle, bytes(size))
        loader.close(handle)
    rig.get(fp.DeleteFile("file1"))
    rig.get(fp.DeleteFile("file3"))
    assert rig.status(fp.OpenWrite("big.rxe", free_bytes(150))) is Status.OK
    assert rig.status(fp.OpenWriteLinear("big2", free_bytes(101))) is Status.NO_LINEAR_SPACE
    assert rig.status(fp.OpenWrite("big2", free_bytes(20))) is Status.OK


def test_sizes_of_sectors_agree_with_each_other():
    for sectors in range(1, 478):
        # Where a header just spills into another sector the firmware itself is one off.
        assert 0 <= sectors_needed(free_bytes(sectors)) - sectors <= 1


def test_data_files_close_early_append_and_crop(rig):
    handle = rig.get(fp.OpenWriteData("log.rdt", 1000)).handle
    rig.get(fp.WriteFile(handle, b"abc"))
    rig.get(fp.CloseFile(handle))
    assert rig.get(fp.FindFirst("log.rdt")).size == 1000
    assert rig.get(fp.OpenRead("log.rdt")).size == 3
    opened = rig.get(fp.OpenAppendData("log.rdt"))
    assert opened.size == 997
    rig.get(fp.WriteFile(opened.handle, b"def"))
    rig.get(fp.CropDataFile(opened.handle))
    assert rig.get(fp.FindFirst("log.rdt")).size == 6
    assert rig.status(fp.OpenAppendData("log.rdt")) is Status.FILE_IS_FULL
    rig.upload("plain.txt", b"abc")
    assert rig.status(fp.OpenAppendData("plain.txt")) is Status.APPEND_NOT_POSSIBLE
    assert rig.status(fp.OpenWriteData("log.rxe", 10)) is Status.ILLEGAL_FILE_NAME


def test_a_file_that_is_read_cannot_be_deleted(rig):
    rig.upload("a.txt", b"abc")
    handle = rig.get(fp.OpenRead("a.txt")).handle
    answer = rig.ask(fp.DeleteFile("a.txt"))
    assert (answer.status, answer.reply.name) == (Status.FILE_IS_BUSY, "a.txt")
    rig.get(fp.CloseFile(handle))
    rig.get(fp.DeleteFile("a.txt"))


@pytest.mark.parametrize(
    ("transport", "length", "given"), [(USB, 100, 58), (BLUETOOTH, 100, 100), (BLUETOOTH, 600, 600)]
)
def test_a_read_is_as_long_as_the_transport_allows(rig, transport, length, given):
    data = bytes(range(250)) * 3
    rig.upload("a.bin", data)
    handle = rig.get(fp.OpenRead("a.bin")).handle
    reply = rig.get(fp.ReadFile(handle, length), transport)
    assert (reply.length, reply.data) == (length, data[:given])


def test_erasing_the_flash_takes_seconds_and_all_files(rig):
    rig.upload("a.txt", b"abc")
    rig.firmware.receive(USB, fp.encode_request(fp.DeleteUserFlash()))
    rig.run(ERASE_MS)
    assert rig.firmware.transmit(USB) == []
    rig.run(2)
    assert rig.firmware.transmit(USB) == [bytes((2, 0xA0, 0))]
    assert names(rig, "*.*") == []


def test_modules_are_listed_in_the_firmwares_order(rig):
    found = [rig.get(fp.FindFirstModule("*.*"))]
    while (answer := rig.ask(fp.FindNextModule(0))).status is Status.OK:
        found.append(answer.reply)
    assert [module.module_id for module in found] == list(fp.ModuleId)
    sizes = {module.module_id: module.io_map_size for module in found}
    assert {key: sizes[key] for key in fp.limits.IO_MAP_SIZES} == fp.limits.IO_MAP_SIZES


def test_io_maps_are_read_within_bounds_and_cut_to_the_transport(rig):
    reply = rig.get(fp.IoMapRead(fp.ModuleId.OUTPUT, 0, 100))
    assert (reply.length, len(reply.data)) == (55, 55)
    assert rig.status(fp.IoMapRead(fp.ModuleId.OUTPUT, 90, 20)) is Status.OUT_OF_BOUNDS
    answer = rig.ask(fp.IoMapRead(0x12345678, 0, 10))
    assert (answer.status, answer.reply.length, answer.reply.data) == (Status.MODULE_NOT_FOUND, 0, bytes(10))


@pytest.mark.parametrize("module_id", list(fp.ModuleId))
def test_writing_back_what_was_read_changes_nothing(rig, module_id):
    rig.run(50)
    before = rig.get(fp.IoMapRead(module_id, 0, 2)).data
    rig.get(fp.IoMapWrite.of(module_id, 0, before))
    assert rig.get(fp.IoMapRead(module_id, 0, 2)).data == before


def test_messages_wait_in_mailboxes_while_a_program_runs(rig):
    rig.start_program()
    for number in range(7):
        rig.get(fp.MessageWrite.of(3, b"%d" % number))
    look = fp.MessageRead(3, 5, remove=False)
    assert rig.get(look).message == rig.get(look).message == b"2"
    assert rig.get(fp.MessageRead(3, 5, remove=True)).mailbox == 5
    assert rig.get(look).message == b"3"
    rig.get(fp.StopProgram())
    rig.run(2)
    assert rig.status(look) is Status.NO_ACTIVE_PROGRAM
    assert rig.status(fp.StopProgram()) is Status.NO_ACTIVE_PROGRAM


@pytest.mark.parametrize(("size", "data"), [(0, b""), (60, bytes(60)), (3, b"abc")])
def test_messages_without_a_proper_end_are_refused(rig, size, data):
    rig.start_program()
    assert rig.status(fp.MessageWrite(0, size, data)) is Status.VALUE_OUT_OF_RANGE


def test_a_reply_of_another_brick_is_stored_and_not_answered(rig):
    rig.start_program()
    reply = fp.encode_reply(fp.MessageRead, fp.MessageRead.Reply.of(4, b"hello"))
    assert rig.raw(reply) is None
    assert rig.get(fp.MessageRead(4, 0, remove=True)).message == b"hello"


def test_starting_a_program_resets_motors_and_sensors(rig):
    rig.drive(0, 70)
    rig.set_sensor(0, fp.SensorType.SWITCH)
    rig.run(200)
    rig.start_program()
    rig.run(150)
    assert (rig.motor(0).power, rig.motor(0).mode) == (0, 0)
    assert rig.sensor(0).sensor_type == fp.SensorType.NO_SENSOR


def test_settings_are_kept_and_limited(rig):
    rig.get(fp.SetProperty(fp.PropertyId.VOLUME, 9))
    assert rig.get(fp.GetProperty(fp.PropertyId.VOLUME)).value == 4
    rig.get(fp.SetProperty(fp.PropertyId.SLEEP_TIMEOUT, 179_999))
    assert rig.get(fp.GetProperty(fp.PropertyId.SLEEP_TIMEOUT)).value == 120_000
    assert rig.get(fp.KeepAlive()).sleep_timeout_ms == 120_000
    assert rig.status(fp.GetProperty(7)) is Status.UNKNOWN_OPCODE


def test_a_brick_without_keep_alive_switches_itself_off(rig):
    rig.get(fp.SetProperty(fp.PropertyId.SLEEP_TIMEOUT, 60_000))
    rig.get(fp.KeepAlive())
    rig.run(59_000)
    rig.get(fp.KeepAlive())
    rig.run(59_000)
    assert rig.firmware.power is Power.ON
    rig.run(1_100)
    assert rig.firmware.power is Power.OFF
    assert rig.raw(fp.encode_request(fp.GetVersions())) is None


def test_booting_needs_usb_and_the_right_words(rig):
    assert rig.status(fp.Boot(), BLUETOOTH) is Status.UNDEFINED_ERROR
    assert rig.status(fp.Boot(bytes(19))) is Status.UNDEFINED_ERROR
    assert rig.get(fp.Boot()).answer == b"Yes\0"
    assert rig.firmware.power is Power.DOWNLOAD


def test_names_are_cut_to_15_characters(rig):
    rig.get(fp.SetBrickName("A very long name"))
    assert rig.get(fp.GetDeviceInfo()).name == "A very long nam"


def test_a_tone_plays_for_its_time(rig):
    rig.get(fp.PlayTone(440, 100))
    rig.run(90)
    assert rig.firmware.sound.state == 3
    rig.run(20)
    assert rig.firmware.sound.state == 0


def test_the_bluetooth_tables_have_their_sizes(rig):
    assert rig.get(fp.BluetoothContactCount()).count == 30
    assert rig.get(fp.BluetoothConnectionCount()).count == 4
    assert rig.get(fp.BluetoothContactName(29)).name == ""


def test_without_a_wish_for_a_reply_nothing_is_said_even_on_errors(rig):
    for request in (fp.SetOutputState(9, 0, 0, 0, 0, 0, 0), fp.GetBatteryLevel(), fp.OpenRead("none")):
        assert rig.raw(fp.encode_request(request, reply_required=False)) is None
