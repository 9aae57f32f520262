from __future__ import annotations

import pytest
from firmware_protocol_strategies import structures
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol import (
    CommandMap,
    FieldPathError,
    FieldValueError,
    InputMap,
    IoMapRead,
    LoaderMap,
    LowSpeedMap,
    LowSpeedState,
    ModuleId,
    MotorMode,
    OutputMap,
    RunState,
    SensorType,
    SoundMap,
    TelegramTooShortError,
    TrailingBytesError,
    UiMap,
    decode_io_map,
    encode_io_map,
    encode_request,
    limits,
    locate,
)

MAPS = [OutputMap, InputMap, LowSpeedMap, LoaderMap, SoundMap, UiMap, CommandMap]

OFFSETS = [
    (OutputMap, ("ports", 0, "tacho_count"), 0, 4),
    (OutputMap, ("ports", 0, "block_tacho_count"), 4, 4),
    (OutputMap, ("ports", 0, "rotation_count"), 8, 4),
    (OutputMap, ("ports", 0, "tacho_limit"), 12, 4),
    (OutputMap, ("ports", 0, "motor_rpm"), 16, 2),
    (OutputMap, ("ports", 0, "flags"), 18, 1),
    (OutputMap, ("ports", 0, "mode"), 19, 1),
    (OutputMap, ("ports", 0, "speed"), 20, 1),
    (OutputMap, ("ports", 0, "actual_speed"), 21, 1),
    (OutputMap, ("ports", 0, "regulation_p"), 22, 1),
    (OutputMap, ("ports", 0, "regulation_d"), 24, 1),
    (OutputMap, ("ports", 0, "run_state"), 25, 1),
    (OutputMap, ("ports", 0, "regulation"), 26, 1),
    (OutputMap, ("ports", 0, "overloaded"), 27, 1),
    (OutputMap, ("ports", 0, "sync_turn"), 28, 1),
    (OutputMap, ("ports", 0, "options"), 29, 1),
    (OutputMap, ("ports", 0, "max_acceleration"), 31, 1),
    (OutputMap, ("ports", 1, "tacho_count"), 32, 4),
    (OutputMap, ("ports", 2), 64, 32),
    (OutputMap, ("regulation_time_ms",), 96, 1),
    (OutputMap, ("regulation_options",), 97, 1),
    (InputMap, ("ports", 0, "sensor_value"), 6, 2),
    (InputMap, ("ports", 0, "sensor_type"), 8, 1),
    (InputMap, ("ports", 0, "boolean"), 10, 1),
    (InputMap, ("ports", 0, "invalid_data"), 16, 1),
    (InputMap, ("ports", 3), 60, 20),
    (InputMap, ("color_blocks",), 80, 336),
    (LowSpeedMap, ("received", 1, "in_index"), 35, 1),
    (LowSpeedMap, ("to_send", 0, "data"), 76, 16),
    (LowSpeedMap, ("modes", 0), 152, 1),
    (LowSpeedMap, ("channel_states", 2), 158, 1),
    (LowSpeedMap, ("error_types",), 160, 4),
    (LowSpeedMap, ("speed",), 165, 1),
    (LoaderMap, ("free_user_flash",), 4, 4),
    (SoundMap, ("file_name",), 6, 20),
    (SoundMap, ("volume",), 29, 1),
    (UiMap, ("battery_voltage_mv",), 4, 2),
    (UiMap, ("file_name",), 6, 20),
    (UiMap, ("flags",), 26, 1),
    (UiMap, ("volume",), 36, 1),
    (UiMap, ("force_off",), 39, 1),
    (CommandMap, ("format_string",), 0, 16),
    (CommandMap, ("file_name",), 32, 20),
]


@pytest.mark.parametrize(("io_map", "path", "offset", "length"), OFFSETS)
def test_a_field_is_where_the_firmware_has_it(io_map, path, offset, length):
    field = locate(io_map, *path)
    assert (field.module_id, field.offset, field.length) == (io_map.MODULE_ID, offset, length)


@pytest.mark.parametrize("io_map", [m for m in MAPS if m is not CommandMap])
def test_whole_maps_have_the_size_that_the_brick_reports(io_map):
    assert locate(io_map).length == limits.IO_MAP_SIZES[io_map.MODULE_ID]


def test_one_field_is_read_with_one_request():
    field = locate(OutputMap, "ports", 1, "tacho_count")
    assert field.read_request() == IoMapRead(ModuleId.OUTPUT, offset=32, length=4)
    assert field.decode(bytes.fromhex("FE FF FF FF")) == -2


def test_one_field_is_written_with_one_request():
    request = locate(OutputMap, "ports", 0, "mode").write_request(MotorMode.ON | MotorMode.BRAKE)
    assert encode_request(request) == bytes.fromhex("01 95 01 00 02 00 13 00 01 00 03")
    with pytest.raises(FieldValueError):
        locate(OutputMap, "ports", 0, "mode").write_request(256)


def test_a_block_is_read_as_a_whole():
    raw = bytearray(32)
    raw[0:4] = (1000).to_bytes(4, "little")
    raw[19], raw[20], raw[25] = 0x07, 0x9C, 0x20
    block = locate(OutputMap, "ports", 2).decode(bytes(raw))
    assert (block.tacho_count, block.mode, block.speed) == (1000, 7, -100)
    assert block.run_state is RunState.RUNNING


def test_named_values_keep_their_names_in_a_map():
    raw = bytearray(416)
    raw[28] = 0x0B
    assert decode_io_map(InputMap, bytes(raw)).ports[1].sensor_type is SensorType.LOW_SPEED_9V
    raw = bytearray(167)
    raw[156:160] = bytes((0, 3, 4, 9))
    states = decode_io_map(LowSpeedMap, bytes(raw)).channel_states
    assert states == (LowSpeedState.IDLE, LowSpeedState.COMMUNICATING, LowSpeedState.ERROR, 9)


@given(st.sampled_from(MAPS).flatmap(structures))
def test_a_map_survives_its_bytes(io_map):
    assert decode_io_map(type(io_map), encode_io_map(io_map)) == io_map


@pytest.mark.parametrize("io_map", MAPS)
def test_a_map_of_the_wrong_length_is_refused(io_map):
    size = locate(io_map).length
    with pytest.raises(TelegramTooShortError):
        decode_io_map(io_map, bytes(size - 1))
    with pytest.raises(TrailingBytesError):
        decode_io_map(io_map, bytes(size + 1))


@pytest.mark.parametrize(
    "path", [("nonsense",), ("ports", 3), ("ports", -1), ("ports", "mode"), (0,), ("ports", 0, "mode", "x")]
)
def test_a_path_that_leads_nowhere_is_refused(path):
    with pytest.raises(FieldPathError):
        locate(OutputMap, *path)


def test_a_wrong_name_is_answered_with_the_right_ones():
    with pytest.raises(FieldPathError, match="tacho_count, block_tacho_count"):
        locate(OutputMap, "ports", 0, "tacho")


def test_a_field_is_not_decoded_from_the_wrong_number_of_bytes():
    with pytest.raises(FieldPathError, match="has 4 bytes, 3 were given"):
        locate(OutputMap, "ports", 0, "tacho_count").decode(bytes(3))


def test_a_map_with_the_wrong_number_of_ports_is_refused():
    whole = decode_io_map(OutputMap, bytes(100))
    with pytest.raises(FieldValueError, match="ports"):
        encode_io_map(OutputMap(whole.ports[:2], 100, 0, bytes(2)))
    with pytest.raises(FieldValueError, match="ports"):
        encode_io_map(OutputMap(("a", "b", "c"), 100, 0, bytes(2)))
