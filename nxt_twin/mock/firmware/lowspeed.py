"""The low-speed module: an I2C master on each sensor port, one step of its state machine a tick.

Source: LEGO NXT firmware 1.29, c_lowspeed.c, and c_cmd.c for what commands see of it.
"""

from __future__ import annotations

import math
from typing import Final, final

from firmware_protocol import (
    LowSpeedBuffer,
    LowSpeedFault,
    LowSpeedMap,
    LowSpeedMode,
    LowSpeedState,
    ModuleId,
    SensorType,
    Status,
    decode_io_map,
    encode_io_map,
    limits,
)
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.input import InputModule
from nxt_twin.mock.firmware.module import Module

BYTE_MS: Final = 0.8
"""A byte and its acknowledgement at 11.7 kHz."""
RETRY_COUNT: Final = 3
RECEIVE_TIMEOUT_TICKS: Final = 100

_SIZE: Final = limits.LOW_SPEED_BUFFER_SIZE
_BUFFER_STRIDE: Final = _SIZE + 3
_LOW_SPEED_TYPES: Final = frozenset({SensorType.LOW_SPEED, SensorType.LOW_SPEED_9V})


@final
class PortBus:
    """One port's buffers and the state of its transaction."""

    __slots__ = (
        "answer",
        "fault",
        "mode",
        "receive_in",
        "receive_length",
        "receive_out",
        "received",
        "retries",
        "send_in",
        "send_out",
        "send_spare",
        "state",
        "to_send",
        "wait_ms",
        "waited",
    )

    def __init__(self) -> None:
        self.received = bytearray(_SIZE)
        self.receive_in = self.receive_out = self.receive_length = 0
        self.to_send = bytes(_SIZE)
        self.send_in = self.send_out = self.send_spare = 0
        self.mode = int(LowSpeedMode.IDLE)
        self.state = int(LowSpeedState.IDLE)
        self.fault = int(LowSpeedFault.NO_ERROR)
        self.retries = 0
        self.wait_ms = 0.0
        self.waited = 0
        self.answer: bytes | None = None

    @property
    def bytes_ready(self) -> int:
        """How many received bytes wait, as far as two indices of a 16-byte ring can tell."""
        return (self.receive_in - self.receive_out) % _SIZE

    def take_received(self) -> bytes:
        """Take all received bytes out of the ring."""
        count = self.bytes_ready
        data = bytes(self.received[(self.receive_out + k) % _SIZE] for k in range(count))
        self.receive_out = (self.receive_out + count) % _SIZE
        return data

    def put_received(self, data: bytes) -> None:
        """Put received bytes into the ring, over unread ones where it is full."""
        for byte in data:
            self.received[self.receive_in % _SIZE] = byte
            self.receive_in = (self.receive_in + 1) % _SIZE

    def fail(self, fault: LowSpeedFault) -> None:
        """End the transaction in the error state, which only a new write leaves."""
        self.state = LowSpeedState.ERROR
        self.fault = fault


@final
class LowSpeedModule(Module):
    """Four digital sensor channels."""

    module_id = ModuleId.LOW_SPEED
    name = "Low Speed.mod"

    def __init__(self, hardware: Hardware, inputs: InputModule) -> None:
        self.channels = tuple(PortBus() for _ in range(limits.INPUT_PORT_COUNT))
        self.active = 0
        self._speed = 0
        self._spare = 0
        self._hardware = hardware
        self._inputs = inputs

    def status(self, port: int) -> Status:
        """The state of a channel in a reply's words."""
        settings = self._inputs.ports[port]
        if settings.sensor_type not in _LOW_SPEED_TYPES or settings.invalid_data:
            return Status.CHANNEL_NOT_READY
        match self.channels[port].state:
            case LowSpeedState.IDLE:
                return Status.OK
            case LowSpeedState.ERROR:
                return Status.BUS_ERROR
            case _:
                return Status.PENDING

    def write(self, port: int, data: bytes, receive_length: int) -> Status:
        """Start a transaction.

        A channel in the error state takes one whatever the sensor type: the firmware's condition reads
        "low speed and valid and idle, or in error".
        """
        if len(data) > _SIZE or receive_length > _SIZE:
            return Status.ILLEGAL_SIZE
        channel = self.channels[port]
        if self.status(port) != Status.OK and channel.state != LowSpeedState.ERROR:
            return Status.CHANNEL_NOT_READY
        channel.to_send = data + channel.to_send[len(data) :]
        channel.send_in = len(data)
        channel.send_out = 0
        channel.receive_length = receive_length
        channel.state = LowSpeedState.INIT
        self.active |= 1 << port
        return Status.OK

    def reset(self) -> None:
        """Do what the start and the stop of a program do: drop received bytes, and end a running transaction."""
        for port, channel in enumerate(self.channels):
            channel.receive_in = channel.receive_out = channel.receive_length = 0
            channel.send_in = channel.send_out = 0
            if channel.state != LowSpeedState.IDLE:
                channel.state = LowSpeedState.DONE
                self.active |= 1 << port

    def tick(self) -> None:
        """One pass."""
        if not self.active:
            return
        for port, channel in enumerate(self.channels):
            if channel.state != LowSpeedState.IDLE:
                self._step(port, channel)

    def _step(self, port: int, channel: PortBus) -> None:
        if channel.state in (LowSpeedState.ERROR, LowSpeedState.DONE):
            self.active &= ~(1 << port)
            if channel.state == LowSpeedState.DONE:
                channel.state = LowSpeedState.IDLE
            return
        if self._inputs.ports[port].sensor_type not in _LOW_SPEED_TYPES:
            channel.fail(LowSpeedFault.CHANNEL_NOT_READY)
        elif channel.state == LowSpeedState.INIT:
            channel.state = LowSpeedState.LOAD_BUFFER
            channel.fault = LowSpeedFault.NO_ERROR
            channel.retries = 0
        elif channel.state == LowSpeedState.LOAD_BUFFER:
            self._start(port, channel)
        elif channel.state == LowSpeedState.COMMUNICATING:
            self._communicate(port, channel)

    def _start(self, port: int, channel: PortBus) -> None:
        """Send from where the last attempt stopped reading: a retry sends what lies behind the message."""
        first = 4 * _BUFFER_STRIDE + port * _BUFFER_STRIDE + channel.send_out
        message = self.export()[first : first + channel.send_in]
        channel.send_out = (channel.send_out + channel.send_in) & 0xFF
        acknowledged = self._hardware.i2c_write(port, message)
        channel.state = LowSpeedState.COMMUNICATING
        channel.mode = LowSpeedMode.TRANSMITTING
        channel.waited = 0
        channel.wait_ms = BYTE_MS * (len(message) if acknowledged else 1)
        channel.answer = message if acknowledged else None

    def _communicate(self, port: int, channel: PortBus) -> None:
        channel.wait_ms -= 1.0
        if channel.mode == LowSpeedMode.TRANSMITTING:
            if channel.wait_ms <= 0.0:
                self._end_sending(port, channel)
        elif channel.mode == LowSpeedMode.RECEIVING:
            channel.waited += 1
            if channel.answer is None:
                if channel.waited > RECEIVE_TIMEOUT_TICKS:
                    channel.fail(LowSpeedFault.RECEIVE_ERROR)
            elif channel.wait_ms <= 0.0:
                channel.put_received(channel.answer)
                channel.mode = LowSpeedMode.DATA_RECEIVED
                channel.state = LowSpeedState.DONE

    def _end_sending(self, port: int, channel: PortBus) -> None:
        if channel.answer is None:
            channel.retries += 1
            if channel.retries > RETRY_COUNT:
                channel.fail(LowSpeedFault.TRANSMIT_ERROR)
            else:
                channel.state = LowSpeedState.LOAD_BUFFER
        elif channel.receive_length == 0:
            channel.mode = LowSpeedMode.DATA_RECEIVED
            channel.state = LowSpeedState.DONE
        else:
            channel.mode = LowSpeedMode.RECEIVING
            channel.answer = self._hardware.i2c_read(port, channel.receive_length)
            channel.wait_ms += math.ceil(BYTE_MS * (1 + channel.receive_length))

    def export(self) -> bytes:
        """The IO map."""
        received = tuple(
            LowSpeedBuffer(bytes(c.received), c.receive_in, c.receive_out, c.receive_length)
            for c in self.channels
        )
        to_send = tuple(LowSpeedBuffer(c.to_send, c.send_in, c.send_out, c.send_spare) for c in self.channels)
        states = (
            tuple(c.mode for c in self.channels),
            tuple(c.state for c in self.channels),
            tuple(c.fault for c in self.channels),
        )
        return encode_io_map(LowSpeedMap(received, to_send, *states, self.active, self._speed, self._spare))

    def adopt(self, data: bytes) -> None:
        """Take over the IO map."""
        given = decode_io_map(LowSpeedMap, data)
        for port, channel in enumerate(self.channels):
            ring, message = given.received[port], given.to_send[port]
            channel.received = bytearray(ring.data)
            channel.receive_in, channel.receive_out = ring.in_index, ring.out_index
            channel.receive_length = ring.bytes_to_receive
            channel.to_send = message.data
            channel.send_in, channel.send_out = message.in_index, message.out_index
            channel.send_spare = message.bytes_to_receive
            channel.mode = int(given.modes[port])
            channel.state = int(given.channel_states[port])
            channel.fault = int(given.error_types[port])
        self.active, self._speed, self._spare = given.state, given.speed, given.spare
