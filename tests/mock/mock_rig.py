"""A mock brick in virtual time, and short words for talking to it."""

from __future__ import annotations

from typing import Any

import firmware_protocol as fp
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware

USB, BLUETOOTH = Transport.USB, Transport.BLUETOOTH
REPLY_TICKS = 50

PROGRAM = b"MindstormsNXT\0" + bytes(50)


class Rig:
    def __init__(self, world: World | None = None, seed: int = 0) -> None:
        world = world or World()
        self.body = world.body(seed)
        self.firmware = Firmware(self.body, world.identity())

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.firmware.tick()

    def raw(self, telegram: bytes, transport: Transport = USB) -> bytes | None:
        """The reply's bytes, without the length prefix; None if nothing comes."""
        framed = telegram if transport is USB else fp.frame(telegram)
        return self.stream(framed, transport)

    def stream(self, data: bytes, transport: Transport) -> bytes | None:
        """The first reply that comes, over Bluetooth as much of it as comes."""
        self.firmware.receive(transport, data)
        got = b""
        for _ in range(REPLY_TICKS):
            self.firmware.tick()
            got += b"".join(self.firmware.transmit(transport))
            if got and transport is USB:
                return got
            if got and len(got) >= 2 + int.from_bytes(got[:2], "little"):
                return got[2 : 2 + int.from_bytes(got[:2], "little")]
        return got[2:] or None

    def ask(self, request: fp.Command[Any], transport: Transport = USB) -> fp.Answer[Any]:
        reply = self.raw(fp.encode_request(request), transport)
        assert reply is not None
        return fp.decode_answer(request, reply)

    def get(self, request: fp.Command[Any], transport: Transport = USB) -> Any:
        """The data of a successful reply."""
        answer = self.ask(request, transport)
        assert answer.status is fp.Status.OK
        return answer.reply

    def status(self, request: fp.Command[Any], transport: Transport = USB) -> fp.Status:
        return self.ask(request, transport).status

    def drive(
        self,
        port: int,
        power: int,
        *,
        mode: int = 0x03,
        regulation: int = 0,
        turn: int = 0,
        state: int = 0x20,
        limit: int = 0,
    ) -> None:
        request = fp.SetOutputState(port, power, mode, regulation, turn, state, limit)
        assert self.status(request) is fp.Status.OK

    def coast(self, port: int) -> None:
        self.drive(port, 0, mode=0, state=0)

    def motor(self, port: int) -> Any:
        return self.get(fp.GetOutputState(port))

    def sensor(self, port: int) -> Any:
        return self.get(fp.GetInputValues(port))

    def set_sensor(self, port: int, sensor_type: int, mode: int = 0) -> None:
        assert self.status(fp.SetInputMode(port, sensor_type, mode)) is fp.Status.OK

    def upload(self, name: str, data: bytes) -> None:
        handle = self.get(fp.OpenWrite(name, len(data))).handle
        for at in range(0, len(data), 60):
            self.get(fp.WriteFile(handle, data[at : at + 60]))
        self.get(fp.CloseFile(handle))

    def start_program(self, name: str = "main.rxe") -> None:
        self.upload(name, PROGRAM)
        self.get(fp.StartProgram(name))
        self.run(15)

    def free_flash(self) -> int:
        free: int = self.get(fp.GetDeviceInfo()).free_flash
        return free
