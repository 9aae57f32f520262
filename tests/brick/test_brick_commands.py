"""Every command of the wire language has its method, and what is read fast is read right."""

from __future__ import annotations

import inspect

import pytest
from brick_fakes import ScriptedLink, VirtualClock
from hypothesis import given, settings
from hypothesis import strategies as st

import firmware_protocol as fp
from firmware_protocol import locate
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.commands.device import Versions
from nxt_twin.brick.commands.motors import MotorState
from nxt_twin.brick.commands.sensors import SensorReading
from nxt_twin.brick.errors import BrickError, CommandRefusedError, RequestError
from nxt_twin.brick.policy import Policy
from nxt_twin.brick.question import compiled_question, question

VALUES = {
    "port": 0, "power_pct": 10, "mode": 1, "relative": True, "sensor_type": 1, "data": b"\x02\x42",
    "name": "a.txt", "size": 9, "handle": 0, "length": 4, "pattern": "*.*", "mailbox": 0, "message": b"hi",
    "time": 5, "frequency_hz": 440, "duration_ms": 10, "timeout_s": 120.0, "volume": 2, "buffer": 0,
    "index": 0, "on": True, "module_id": fp.ModuleId.OUTPUT, "offset": 0, "content": b"x", "register": 0x42,
    "command": 1, "value": 1, "field": locate(fp.OutputMap, "regulation_time_ms"),
}  # fmt: skip


def blank(telegram: bytes) -> bytes:
    """The reply of which every byte is 0, with the repeated fields in place."""
    request = fp.decode_request(telegram).request
    reply = bytearray(fp.encode_reply(request, fp.blank_reply(request)))
    head = question(request).head
    reply[: len(head)] = head
    return bytes(reply)


def test_every_command_of_the_wire_language_is_sent_by_some_method():
    clock = VirtualClock()
    refused = {
        fp.FindNext.OPCODE: b"\x02\x87\x87" + bytes(25),
        fp.FindNextModule.OPCODE: b"\x02\x91\x90" + bytes(31),
    }
    link = ScriptedLink(clock, lambda telegram: [refused.get(telegram[1]) or blank(telegram)])
    brick = Brick(link, clock, Policy())
    for theme in vars(brick).values():
        for name, method in inspect.getmembers(theme, inspect.ismethod):
            needed = [
                parameter.name
                for parameter in inspect.signature(method).parameters.values()
                if parameter.default is parameter.empty
            ]
            if name.startswith("_") or not type(theme).__module__.startswith("nxt_twin.brick.commands"):
                continue
            try:
                method(**{each: VALUES[each] for each in needed})
            except BrickError:
                continue
    sent = {(telegram[0] & 0x7F, telegram[1]) for telegram in link.sent}
    assert {(command.KIND, command.OPCODE) for command in fp.all_commands()} <= sent


@settings(deadline=None)
@given(body=st.binary(min_size=22, max_size=22))
def test_a_motor_is_read_as_the_wire_language_reads_it(body: bytes):
    request = fp.GetOutputState(body[0])
    telegram = b"\x02\x06\x00" + body
    fast = compiled_question(request, MotorState).read(telegram)
    slow = fp.decode_reply(request, telegram)
    assert tuple(fast) == tuple(vars(slow).values())
    assert [type(value) for value in fast] == [type(value) for value in vars(slow).values()]


@settings(deadline=None)
@given(body=st.binary(min_size=13, max_size=13))
def test_a_sensor_is_read_as_the_wire_language_reads_it(body: bytes):
    request = fp.GetInputValues(body[0])
    telegram = b"\x02\x07\x00" + body
    fast = compiled_question(request, SensorReading).read(telegram)
    assert tuple(fast) == tuple(vars(fp.decode_reply(request, telegram)).values())


@settings(deadline=None)
@given(tail=st.binary(max_size=30))
def test_a_reply_of_any_bytes_is_read_or_refused_as_the_wire_language_does(tail: bytes):
    request = fp.GetOutputState(0)
    outcomes = []
    for ready in (compiled_question(request, MotorState), question(request)):
        try:
            ready.read(b"\x02\x06" + tail)
            outcomes.append("read")
        except fp.ProtocolError as error:
            outcomes.append(str(error))
    assert outcomes[0] == outcomes[1]


def brick_that_says(*replies: bytes) -> tuple[Brick, ScriptedLink]:
    clock = VirtualClock()
    left = list(replies)
    link = ScriptedLink(clock, lambda _: [left.pop(0)] if left else [])
    return Brick(link, clock, Policy(keep_alive_period_s=None)), link


def test_versions_are_read_as_people_write_them():
    brick, _ = brick_that_says(bytes.fromhex("0288007c010501"))
    assert brick.device.versions().value == Versions(protocol="1.124", firmware="1.05")


def test_drive_shorts_the_off_phase_unless_it_is_to_float():
    brick, link = brick_that_says(b"\x02\x04\x00", b"\x02\x04\x00")
    brick.motors.drive(fp.OutputPort.B, -60, tacho_limit_deg=720)
    brick.motors.drive(fp.OutputPort.B, 60, floating=True)
    assert link.sent[0].hex() == "000401c403000020d0020000"
    assert link.sent[1].hex() == "0004013c0100002000000000"


def test_a_digital_transaction_waits_until_it_is_over_and_drops_leftovers():
    brick, link = brick_that_says(
        b"\x02\x0e\x00\x03", b"\x02\x10\x00\x03abc" + bytes(13),
        b"\x02\x0f\xe0", b"\x02\x0f\x00",
        b"\x02\x0e\x20\x00", b"\x02\x0e\x20\x00", b"\x02\x0e\x00\x01",
        b"\x02\x10\x00\x01\x2a" + bytes(15),
    )  # fmt: skip
    reply = brick.ultrasonic.distance_cm(fp.InputPort.S4)
    assert reply.value == 42
    assert [sent[1] for sent in link.sent] == [0x0E, 0x10, 0x0F, 0x0F, 0x0E, 0x0E, 0x0E, 0x10]


def test_transactions_with_the_ultrasonic_sensor_leave_it_time_to_rest():
    clock = VirtualClock()
    replies = {0x0E: b"\x02\x0e\x00\x00", 0x0F: b"\x02\x0f\x00", 0x10: b"\x02\x10\x00\x01\x2a" + bytes(15)}
    brick = Brick(ScriptedLink(clock, lambda sent: [replies[sent[1]]]), clock)
    first = brick.ultrasonic.distance_cm(fp.InputPort.S1)
    second = brick.ultrasonic.distance_cm(fp.InputPort.S1)
    assert second.sent_s - first.received_s >= 0.0149


def test_a_sensor_that_does_not_answer_says_what_to_check():
    brick, _ = brick_that_says(b"\x02\x0e\x00\x00", b"\x02\x0f\x00", b"\x02\x0e\xdd\x00")
    with pytest.raises(CommandRefusedError, match="check the sensor's cable") as caught:
        brick.ultrasonic.distance_cm(fp.InputPort.S4)
    assert caught.value.status is fp.Status.BUS_ERROR


def test_a_transaction_that_never_ends_is_given_up():
    clock = VirtualClock()
    replies = {0x0E: b"\x02\x0e\x20\x00", 0x0F: b"\x02\x0f\x00"}
    brick = Brick(ScriptedLink(clock, lambda sent: [replies[sent[1]]]), clock)
    with pytest.raises(CommandRefusedError) as caught:
        brick.low_speed.transact(0, b"\x02\x42", receive_length=1)
    assert caught.value.status is fp.Status.PENDING


def test_sixteen_bytes_cannot_be_fetched_at_once():
    brick, link = brick_that_says()
    with pytest.raises(RequestError, match="at most 15"):
        brick.low_speed.transact(0, b"\x02\x00", receive_length=16)
    assert link.sent == []


def test_a_file_name_that_is_too_long_is_not_sent():
    brick, link = brick_that_says()
    with pytest.raises(RequestError, match="20 characters"):
        brick.files.open_read("a" * 16 + ".txt")
    assert link.sent == []


def test_a_whole_io_map_is_read_in_as_many_pieces_as_it_takes():
    clock = VirtualClock()

    def answer(sent: bytes) -> list[bytes]:
        offset, length = int.from_bytes(sent[6:8], "little"), int.from_bytes(sent[8:10], "little")
        return [b"\x02\x94\x00" + sent[2:6] + sent[8:10] + bytes(range(offset, offset + length))]

    link = ScriptedLink(clock, answer)
    output = Brick(link, clock).modules.read_field(locate(fp.OutputMap)).value
    assert len(link.sent) == 2
    assert output.regulation_time_ms == 96


def test_writing_motors_through_the_io_map_lets_them_coast_at_the_end():
    clock = VirtualClock()

    def answer(sent: bytes) -> list[bytes]:
        if sent[1] == 0x95:
            return [b"\x02\x95\x00" + sent[2:6] + sent[8:10]]
        return []

    link = ScriptedLink(clock, answer)
    with Brick(link, clock) as brick:
        brick.modules.write_field(locate(fp.OutputMap, "ports", 0, "speed"), 50)
    assert any(sent[:3] == b"\x80\x04\xff" for sent in link.sent)
