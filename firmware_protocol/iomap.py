"""IO maps: the memory that each firmware module shares, and where its fields are.

Source: LEGO NXT firmware 1.29, the modules' IO map declarations. For the later fields of the user interface
and the command module: the IO map offsets published with the NXC language.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, TypeVar, final

from firmware_protocol.commands.modules import IoMapRead, IoMapWrite
from firmware_protocol.enums import ModuleId
from firmware_protocol.errors import FieldPathError
from firmware_protocol.fields import (
    S8,
    S16,
    S32,
    U8,
    U16,
    U32,
    Bool8,
    Bytes16,
    LowSpeedFaults,
    LowSpeedModes,
    LowSpeedStates,
    MotorMode8,
    Name20,
    OutputFlags8,
    RegulationMode8,
    RunState8,
    SensorMode8,
    SensorType8,
)
from firmware_protocol.layout import Block, Repeat, WireStructure, field_named, pack, unpack
from firmware_protocol.limits import INPUT_PORT_COUNT, OUTPUT_PORT_COUNT
from firmware_protocol.wire import FixedBytes, FixedWire


class IoMap(WireStructure):
    """Abstract: a module's IO map, or the head of one.

    Attributes:
        MODULE_ID: the module it belongs to.
    """

    MODULE_ID: ClassVar[ModuleId]

    def __init_subclass__(cls, *, module_id: ModuleId) -> None:
        super().__init_subclass__()
        cls.MODULE_ID = module_id


IoMapT = TypeVar("IoMapT", bound=IoMap)


@final
@dataclass(frozen=True)
class OutputPortBlock(WireStructure):
    """One motor in the output module.

    The stock LEGO firmware has three spare bytes in the places of ``options``, ``max_speed`` and
    ``max_acceleration``.
    """

    tacho_count: S32
    block_tacho_count: S32
    rotation_count: S32
    tacho_limit: U32
    motor_rpm: S16
    flags: OutputFlags8
    mode: MotorMode8
    speed: S8
    actual_speed: S8
    regulation_p: U8
    regulation_i: U8
    regulation_d: U8
    run_state: RunState8
    regulation: RegulationMode8
    overloaded: Bool8
    sync_turn: S8
    options: U8
    max_speed: S8
    max_acceleration: S8


@final
@dataclass(frozen=True)
class OutputMap(IoMap, module_id=ModuleId.OUTPUT):
    """The output module: three motors and the regulation period (the stock firmware: the PWM frequency)."""

    ports: Annotated[tuple[OutputPortBlock, ...], Repeat(OUTPUT_PORT_COUNT, Block(OutputPortBlock))]
    regulation_time_ms: U8
    regulation_options: U8
    spare: Annotated[bytes, FixedBytes(2)]


@final
@dataclass(frozen=True)
class InputPortBlock(WireStructure):
    """One sensor in the input module."""

    custom_zero_offset: U16
    ad_raw: U16
    sensor_raw: U16
    sensor_value: S16
    sensor_type: SensorType8
    sensor_mode: SensorMode8
    boolean: Bool8
    digital_direction: U8
    digital_in: U8
    digital_out: U8
    custom_percent: U8
    custom_active: U8
    invalid_data: Bool8
    spare: Annotated[bytes, FixedBytes(3)]


@final
@dataclass(frozen=True)
class InputMap(IoMap, module_id=ModuleId.INPUT):
    """The input module: four sensors, and four colour sensor blocks as plain bytes."""

    ports: Annotated[tuple[InputPortBlock, ...], Repeat(INPUT_PORT_COUNT, Block(InputPortBlock))]
    color_blocks: Annotated[bytes, FixedBytes(336)]


@final
@dataclass(frozen=True)
class LowSpeedBuffer(WireStructure):
    """A ring of 16 bytes of a digital sensor's channel, and how many bytes are still to be received."""

    data: Bytes16
    in_index: U8
    out_index: U8
    bytes_to_receive: U8


@final
@dataclass(frozen=True)
class LowSpeedMap(IoMap, module_id=ModuleId.LOW_SPEED):
    """The low-speed module: four digital sensor channels."""

    received: Annotated[tuple[LowSpeedBuffer, ...], Repeat(INPUT_PORT_COUNT, Block(LowSpeedBuffer))]
    to_send: Annotated[tuple[LowSpeedBuffer, ...], Repeat(INPUT_PORT_COUNT, Block(LowSpeedBuffer))]
    modes: LowSpeedModes
    channel_states: LowSpeedStates
    error_types: LowSpeedFaults
    state: U8
    speed: U8
    spare: U8


@final
@dataclass(frozen=True)
class LoaderMap(IoMap, module_id=ModuleId.LOADER):
    """The loader: a pointer of no use outside, and the free flash memory."""

    function_pointer: U32
    free_user_flash: U32


@final
@dataclass(frozen=True)
class SoundMap(IoMap, module_id=ModuleId.SOUND):
    """The sound module: what plays."""

    frequency_hz: U16
    duration_ms: U16
    sample_rate_hz: U16
    file_name: Name20
    flags: U8
    state: U8
    mode: U8
    volume: U8


@final
@dataclass(frozen=True)
class UiMap(IoMap, module_id=ModuleId.UI):
    """The user interface module: battery, buttons, sleep, volume."""

    menu_pointer: U32
    battery_voltage_mv: U16
    file_name: Name20
    flags: U8
    state: U8
    button: U8
    run_state: U8
    battery_state: U8
    bluetooth_state: U8
    usb_state: U8
    sleep_timeout_min: U8
    sleep_timer_min: U8
    rechargeable: Bool8
    volume: U8
    error: U8
    on_brick_program_step: U8
    force_off: U8


@final
@dataclass(frozen=True)
class CommandMap(IoMap, module_id=ModuleId.COMMAND):
    """The head of the command module: which program runs, and how it does; its memory pool follows."""

    format_string: Bytes16
    handler_pointer: U32
    tick_ms: U32
    data_space_offset: U16
    dope_vector_offset: U16
    program_status: U8
    awake: Bool8
    activate_flag: U8
    deactivate_flag: U8
    file_name: Name20


@final
@dataclass(frozen=True)
class IoMapField:
    """Where a field, a block or a whole map is, and what its bytes mean.

    Args:
        module_id: the module to ask.
        offset: bytes from the start of the module's map.
        wire: how the field lies there.
    """

    module_id: ModuleId
    offset: int
    wire: FixedWire

    @property
    def length(self) -> int:
        """The field's number of bytes."""
        return self.wire.fixed_width

    def read_request(self) -> IoMapRead:
        """The request that reads the field; one reply holds at most 55 bytes over USB, 119 over Bluetooth."""
        return IoMapRead(self.module_id, self.offset, self.length)

    def write_request(self, value: Any) -> IoMapWrite:  # noqa: ANN401 - the type is the field's
        """The request that writes the field.

        Raises:
            FieldValueError: the value does not fit.
        """
        return IoMapWrite.of(self.module_id, self.offset, self.wire.pack(value, self.length))

    def decode(self, data: bytes) -> Any:  # noqa: ANN401
        """The field's value, from exactly its bytes.

        Raises:
            FieldPathError: the number of bytes is not the field's.
        """
        if len(data) != self.length:
            raise FieldPathError(f"the field has {self.length} bytes, {len(data)} were given")
        return self.wire.unpack(data)


def locate(io_map: type[IoMap], *path: str | int) -> IoMapField:
    """Find a field: ``locate(OutputMap, "ports", 1, "tacho_count")``.

    Args:
        io_map: the map.
        path: names of fields and indices of ports, from the map inwards; empty for the whole map.

    Raises:
        FieldPathError: there is no such field or port.
    """
    wire: FixedWire = Block(io_map)
    offset = 0
    for step in path:
        step_offset, wire = _step_into(wire, step)
        offset += step_offset
    return IoMapField(io_map.MODULE_ID, offset, wire)


def encode_io_map(io_map: IoMap) -> bytes:
    """The bytes of a whole map.

    Raises:
        FieldValueError: a value does not fit its field.
    """
    return pack(io_map)


def decode_io_map(io_map: type[IoMapT], data: bytes) -> IoMapT:
    """A whole map from its bytes.

    Raises:
        TelegramTooShortError: the bytes end before the last field does.
        TrailingBytesError: the bytes go on after the last field.
    """
    return unpack(io_map, data)


def _step_into(wire: FixedWire, step: str | int) -> tuple[int, FixedWire]:
    if isinstance(wire, Repeat) and isinstance(step, int):
        if not 0 <= step < wire.count:
            raise FieldPathError(f"there are {wire.count} of them, counted from 0; there is no number {step}")
        return step * wire.element.fixed_width, wire.element
    if isinstance(wire, Block) and isinstance(step, str):
        field = field_named(wire.structure, step)
        if field.offset is not None and isinstance(field.wire, FixedWire):
            return field.offset, field.wire
    raise FieldPathError(f"there is nothing called {step!r} inside {wire.label}")
