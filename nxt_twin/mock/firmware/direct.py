"""The command interpreter for direct commands: motors, sensors, sounds, programs, settings.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, final

import firmware_protocol as fp
from firmware_protocol import OpcodeError, ReplyData, Status, limits
from nxt_twin.mock.firmware.channel import Channel
from nxt_twin.mock.firmware.input import InputModule, InputPortState
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
from nxt_twin.mock.firmware.lowspeed import LowSpeedModule
from nxt_twin.mock.firmware.output import OutputModule, OutputPortState
from nxt_twin.mock.firmware.program import ProgramModule
from nxt_twin.mock.firmware.radio import Contact, RadioModule
from nxt_twin.mock.firmware.refusal import RefusedReply
from nxt_twin.mock.firmware.sound import SoundModule
from nxt_twin.mock.firmware.ui import FLAG_EXECUTE_FILE, MINUTE_MS, UiModule

_MESSAGE_OFFSET: Final = 5
"""Where the message stands in a MESSAGE_READ reply that the brick receives."""

_NEGATIVE: Final = 0x80
"""In a status: an error, as the firmware sees it; pending and empty are none."""

_READERS: Final = frozenset(
    {
        fp.GetOutputState,
        fp.GetInputValues,
        fp.GetBatteryLevel,
        fp.LowSpeedGetStatus,
        fp.LowSpeedRead,
        fp.GetCurrentProgram,
        fp.MessageRead,
        fp.DatalogRead,
        fp.BluetoothContactCount,
        fp.BluetoothContactName,
        fp.BluetoothConnectionCount,
        fp.BluetoothConnectionName,
        fp.GetProperty,
    }
)
"""Commands that are not even looked at when no reply is wanted."""


_NAME_OFFSET: Final = 4
_NAME_SIZE: Final = 17
"""Where the name stands in the reply to BT_GET_CONNECTION_NAME."""


@final
class _NoConnection(Exception):  # noqa: N818 - a refusal is what it is
    """There is no such connection: the reply says OK and repeats what an earlier one left in the name's place."""


@final
class DirectCommands:
    """Executes direct commands on the firmware's modules."""

    def __init__(
        self,
        outputs: OutputModule,
        inputs: InputModule,
        low_speed: LowSpeedModule,
        loader: Loader,
        program: ProgramModule,
        sound: SoundModule,
        ui: UiModule,
        radio: RadioModule,
    ) -> None:
        self._outputs = outputs
        self._inputs = inputs
        self._low_speed = low_speed
        self._loader = loader
        self._program = program
        self._sound = sound
        self._ui = ui
        self._radio = radio
        self._handlers: dict[type[fp.Command[Any]], Callable[[Any], ReplyData | None]] = {
            fp.StartProgram: self._start_program,
            fp.StopProgram: self._stop_program,
            fp.PlaySoundFile: self._play_sound_file,
            fp.PlayTone: lambda request: sound.play_tone(request.frequency_hz, request.duration_ms),
            fp.SetOutputState: self._set_output_state,
            fp.SetInputMode: self._set_input_mode,
            fp.GetOutputState: self._get_output_state,
            fp.GetInputValues: self._get_input_values,
            fp.ResetInputScaledValue: self._reset_input_value,
            fp.MessageWrite: self._write_message,
            fp.ResetMotorPosition: self._reset_position,
            fp.GetBatteryLevel: lambda _: fp.GetBatteryLevel.Reply(ui.battery_mv),
            fp.StopSound: lambda _: sound.stop(),
            fp.KeepAlive: self._keep_alive,
            fp.LowSpeedGetStatus: self._low_speed_status,
            fp.LowSpeedWrite: self._low_speed_write,
            fp.LowSpeedRead: self._low_speed_read,
            fp.GetCurrentProgram: self._current_program,
            fp.MessageRead: self._read_message,
            fp.DatalogRead: self._read_datalog,
            fp.DatalogSetTimes: self._set_datalog_time,
            fp.BluetoothContactCount: self._contact_count,
            fp.BluetoothContactName: self._contact_name,
            fp.BluetoothConnectionCount: self._connection_count,
            fp.BluetoothConnectionName: self._connection_name,
            fp.SetProperty: self._set_property,
            fp.GetProperty: self._get_property,
            fp.ResetTachoCount: self._reset_count,
        }

    def execute(self, channel: Channel, length: int, *, reply_wanted: bool) -> bytes | None:
        """Execute the telegram in the channel's buffer and give its reply, if one is wanted."""
        buffer = bytes(channel.buffer)
        opcode = buffer[1]
        try:
            request, _ = fp.decode_request_from_buffer(buffer, length)
        except OpcodeError:
            return fp.encode_status(opcode, Status.UNKNOWN_OPCODE)
        if not reply_wanted and type(request) in _READERS:
            return None
        try:
            data = self._handlers[type(request)](request)
            return fp.encode_reply(type(request), data)
        except RefusedReply as refusal:
            return fp.encode_reply(type(request), refusal.data, status=refusal.status)[: -refusal.cut or None]
        except _NoConnection:
            stale = bytes(channel.stale[_NAME_OFFSET : _NAME_OFFSET + _NAME_SIZE])
            return fp.encode_status(opcode, Status.OK) + b"\0" + stale

    def take_reply(self, buffer: bytes, length: int) -> None:
        """Act on a reply that another brick sent: the message in it goes to a mailbox."""
        del length
        kind, opcode, status, mailbox, size = buffer[:_MESSAGE_OFFSET]
        del kind
        if opcode != fp.MessageRead.OPCODE or status & _NEGATIVE:
            return
        data = buffer[_MESSAGE_OFFSET : _MESSAGE_OFFSET + size]
        self._store(mailbox, data.ljust(size, b"\0"))

    def _start_program(self, request: fp.StartProgram) -> None:
        self._check_there(request.name)
        self._ui.file_name = request.name
        self._ui.flags |= FLAG_EXECUTE_FILE

    def _check_there(self, name: str) -> None:
        """Refuse a file that is not there; else handle 0 is closed in place of the one that the search took.

        The firmware's LOADER_ERR, which is a macro, takes the handle off the word that it is to be closed by.
        """
        try:
            self._loader.find_first(name)
        except LoaderRefusal:
            raise RefusedReply(Status.VALUE_OUT_OF_RANGE) from None
        self._loader.close(0)

    def _stop_program(self, request: fp.StopProgram) -> None:
        del request
        if self._program.running is None:
            raise RefusedReply(Status.NO_ACTIVE_PROGRAM)
        self._program.stop()

    def _play_sound_file(self, request: fp.PlaySoundFile) -> None:
        self._check_there(request.name)
        self._sound.play_file(request.name, loop=request.loop)

    def _set_output_state(self, request: fp.SetOutputState) -> None:
        every = request.port == fp.OutputPort.ALL
        ports = range(limits.OUTPUT_PORT_COUNT) if every else [int(request.port)]
        if ports[-1] >= limits.OUTPUT_PORT_COUNT:
            raise RefusedReply(Status.VALUE_OUT_OF_RANGE)
        for port in ports:
            self._outputs.set_state(
                port,
                request.power,
                int(request.mode),
                int(request.regulation),
                request.turn_ratio,
                int(request.run_state),
                request.tacho_limit,
            )

    def _set_input_mode(self, request: fp.SetInputMode) -> None:
        self._input(request.port).set_mode(int(request.sensor_type), int(request.sensor_mode))

    def _get_output_state(self, request: fp.GetOutputState) -> ReplyData:
        port = self._output(request.port, fp.blank_reply(fp.GetOutputState))
        return fp.GetOutputState.Reply(
            port=request.port,
            power=port.speed,
            mode=port.mode,
            regulation=port.regulation,
            turn_ratio=port.sync_turn,
            run_state=port.run_state,
            tacho_limit=port.tacho_limit,
            tacho_count=port.tacho_count,
            block_tacho_count=port.block_tacho_count,
            rotation_count=port.rotation_count,
        )

    def _get_input_values(self, request: fp.GetInputValues) -> ReplyData:
        port = self._input(request.port, fp.blank_reply(fp.GetInputValues))
        return fp.GetInputValues.Reply(
            port=request.port,
            valid=not port.invalid_data,
            calibrated=False,
            sensor_type=port.sensor_type,
            sensor_mode=port.sensor_mode,
            raw=port.ad_raw,
            normalised=port.sensor_raw,
            scaled=port.sensor_value,
            calibrated_value=port.sensor_raw,
        )

    def _reset_input_value(self, request: fp.ResetInputScaledValue) -> None:
        self._input(request.port).reset_value()

    def _reset_position(self, request: fp.ResetMotorPosition) -> None:
        block, rotation = fp.OutputFlags.RESET_BLOCK_COUNT, fp.OutputFlags.RESET_ROTATION_COUNT
        self._output(request.port).flags |= int(block if request.relative else rotation)

    def _reset_count(self, request: fp.ResetTachoCount) -> None:
        self._output(request.port).flags |= int(fp.OutputFlags.RESET_COUNT)

    def _keep_alive(self, request: fp.KeepAlive) -> ReplyData:
        del request
        self._ui.stay_awake()
        return fp.KeepAlive.Reply(self._ui.sleep_timeout_min * MINUTE_MS)

    def _low_speed_status(self, request: fp.LowSpeedGetStatus) -> ReplyData:
        port = self._digital_port(request.port)
        reply = fp.LowSpeedGetStatus.Reply(self._low_speed.channels[port].bytes_ready)
        return _with_status(reply, self._low_speed.status(port))

    def _low_speed_write(self, request: fp.LowSpeedWrite) -> None:
        port = self._digital_port(request.port)
        if request.send_length > limits.LOW_SPEED_BUFFER_SIZE:
            raise RefusedReply(Status.ILLEGAL_SIZE)
        status = self._low_speed.write(port, request.data, request.receive_length)
        if status != Status.OK:
            raise RefusedReply(status)

    def _low_speed_read(self, request: fp.LowSpeedRead) -> ReplyData:
        port = self._digital_port(request.port)
        status = self._low_speed.status(port)
        channel = self._low_speed.channels[port]
        waiting = channel.bytes_ready
        if status & _NEGATIVE:
            nothing = fp.LowSpeedRead.Reply(waiting, bytes(limits.LOW_SPEED_BUFFER_SIZE))
            raise RefusedReply(status, nothing, cut=waiting)
        return _with_status(
            fp.LowSpeedRead.Reply.of(channel.take_received()), Status.OK if waiting else status
        )

    def _current_program(self, request: fp.GetCurrentProgram) -> ReplyData:
        del request
        if self._program.running is None:
            raise RefusedReply(Status.NO_ACTIVE_PROGRAM, fp.blank_reply(fp.GetCurrentProgram))
        return fp.GetCurrentProgram.Reply(self._program.running)

    def _write_message(self, request: fp.MessageWrite) -> None:
        status = self._store(request.mailbox, request.data)
        if status != Status.OK:
            raise RefusedReply(status)

    def _store(self, mailbox: int, message: bytes) -> Status:
        if not 0 < len(message) <= limits.MESSAGE_SIZE or message[-1]:
            return Status.VALUE_OUT_OF_RANGE
        if mailbox >= limits.MAILBOX_COUNT:
            return Status.ILLEGAL_MAILBOX
        return self._program.store(mailbox, message)

    def _read_message(self, request: fp.MessageRead) -> ReplyData:
        nothing = fp.MessageRead.Reply(request.local_mailbox, 0, bytes(limits.MESSAGE_SIZE))
        if self._program.running is None:
            raise RefusedReply(Status.NO_ACTIVE_PROGRAM, nothing)
        if request.remote_mailbox >= limits.MAILBOX_COUNT:
            raise RefusedReply(Status.ILLEGAL_MAILBOX, nothing)
        message = self._program.mailboxes.oldest(request.remote_mailbox)
        if message is None:
            raise RefusedReply(Status.MAILBOX_EMPTY, nothing)
        if request.remove:
            self._program.mailboxes.remove(request.remote_mailbox)
        padded = message.ljust(limits.MESSAGE_SIZE, b"\0")
        return fp.MessageRead.Reply(request.local_mailbox, len(message), padded)

    def _read_datalog(self, request: fp.DatalogRead) -> ReplyData:
        if self._program.running is None:
            raise RefusedReply(Status.NO_ACTIVE_PROGRAM, fp.blank_reply(fp.DatalogRead))
        if not self._program.datalog:
            raise RefusedReply(Status.MAILBOX_EMPTY, fp.blank_reply(fp.DatalogRead))
        entry = self._program.datalog[0]
        if request.remove:
            self._program.datalog.popleft()
        return fp.DatalogRead.Reply(len(entry), entry.ljust(limits.DATALOG_SIZE, b"\0"))

    def _set_datalog_time(self, request: fp.DatalogSetTimes) -> None:
        self._program.sync_time = request.sync_time

    def _contact_count(self, request: fp.BluetoothContactCount) -> ReplyData:
        del request
        return fp.BluetoothContactCount.Reply(len(self._radio.contacts))

    def _connection_count(self, request: fp.BluetoothConnectionCount) -> ReplyData:
        del request
        return fp.BluetoothConnectionCount.Reply(len(self._radio.connections))

    def _contact_name(self, request: fp.BluetoothContactName) -> ReplyData:
        contacts = self._radio.contacts
        contact = contacts[request.index] if request.index < len(contacts) else Contact()
        return fp.BluetoothContactName.Reply(contact.device_type, contact.name)

    def _connection_name(self, request: fp.BluetoothConnectionName) -> ReplyData:
        if request.index >= len(self._radio.connections):
            raise _NoConnection
        connection = self._radio.connections[request.index]
        return fp.BluetoothConnectionName.Reply(connection.device_type, connection.name)

    def _set_property(self, request: fp.SetProperty) -> None:
        match request.property_id:
            case fp.PropertyId.BLUETOOTH_ON:
                self._ui.bluetooth_on = bool(request.value)
            case fp.PropertyId.VOLUME:
                self._ui.volume = self._sound.volume = min(request.value, limits.VOLUME_MAX)
            case fp.PropertyId.SLEEP_TIMEOUT:
                self._ui.sleep_timeout_min = request.value // MINUTE_MS & 0xFF
            case _:
                raise RefusedReply(Status.UNKNOWN_OPCODE)

    def _get_property(self, request: fp.GetProperty) -> ReplyData:
        values = {
            fp.PropertyId.BLUETOOTH_ON: int(self._ui.bluetooth_on),
            fp.PropertyId.VOLUME: self._sound.volume,
            fp.PropertyId.SLEEP_TIMEOUT: self._ui.sleep_timeout_min * MINUTE_MS,
        }
        if request.property_id not in values:
            raise RefusedReply(Status.UNKNOWN_OPCODE)
        wanted = fp.PropertyId(request.property_id)
        return fp.GetProperty.Reply.of(wanted, values[wanted])

    def _output(self, port: int, blank: ReplyData | None = None) -> OutputPortState:
        if port >= limits.OUTPUT_PORT_COUNT:
            raise RefusedReply(Status.VALUE_OUT_OF_RANGE, blank)
        return self._outputs.ports[port]

    def _input(self, port: int, blank: ReplyData | None = None) -> InputPortState:
        return self._inputs.look(self._digital_port(port, blank))

    def _digital_port(self, port: int, blank: ReplyData | None = None) -> int:
        if port >= limits.INPUT_PORT_COUNT:
            raise RefusedReply(Status.VALUE_OUT_OF_RANGE, blank)
        return int(port)


def _with_status(reply: ReplyData, status: Status) -> ReplyData:
    if status != Status.OK:
        raise RefusedReply(status, reply)
    return reply
