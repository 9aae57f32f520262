"""Random and mutated telegrams: none may kill the mock, or draw a reply that the firmware could not give."""

from __future__ import annotations

from collections import Counter
from random import Random
from typing import Any, Final

import firmware_protocol as fp
from firmware_protocol import Status, TelegramType
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware, Power

TELEGRAM_COUNT: Final = 200_000
_NO_REPLY: Final = 0x80
_REPLY_TICKS: Final = 2
_HEAD_SIZE: Final = 3
_FRESH_EVERY: Final = 2_000
"""A brick that was told to boot or sleep, or whose motors run wild, is replaced now and then."""

_ERASING: Final = (b"\x01\xa0", b"\x81\xa0")
"""Stalls the brick for seconds; tested elsewhere."""
_NAMES: Final = (b"main.rxe", b"a.txt", b"*.*", b"*.txt", b"Comm.mod", b"", b"x" * 20)


def fuzz(count: int, seed: int) -> Counter[str]:
    """Send that many telegrams, half over each transport; what came back, by kind.

    Raises:
        AssertionError: a reply that the firmware could not give.
    """
    random = Random(seed)
    seen: Counter[str] = Counter()
    firmware = _fresh()
    for number in range(count):
        if number % _FRESH_EVERY == 0 or firmware.power is not Power.ON:
            firmware = _fresh()
        transport = random.choice((Transport.USB, Transport.BLUETOOTH))
        telegram = random_telegram(random)[: 64 if transport is Transport.USB else 128]
        firmware.receive(transport, telegram if transport is Transport.USB else fp.frame(telegram))
        for _ in range(_REPLY_TICKS):
            firmware.tick()
        reading = firmware.radio.reading
        while firmware.radio.reading:
            firmware.tick()
        reply = _reply(firmware, transport)
        if reading or (reply is None and transport is Transport.BLUETOOTH and firmware.radio.busy):
            seen[_judge_long_read(telegram, reply)] += 1
        else:
            seen[_judge(telegram, reply, transport)] += 1
    return seen


def report() -> list[str]:
    """The proof, as lines to print."""
    seen = fuzz(TELEGRAM_COUNT, seed=1)
    kinds = ", ".join(f"{kind} {number}" for kind, number in seen.most_common(6))
    return [f"mock fuzz: {sum(seen.values())} telegrams, no crash, no impossible reply; {kinds}"]


def _fresh() -> Firmware:
    world = World(sleep_timeout_min=0)
    firmware = Firmware(world.body(), world.identity())
    for name, data in (("main.rxe", b"MindstormsNXT\0" + bytes(40)), ("a.txt", b"hello")):
        handle = firmware.loader.open_write(name, len(data), linear=name.endswith("rxe"))
        firmware.loader.write(handle, data)
        firmware.loader.close(handle)
    return firmware


def random_telegram(random: Random) -> bytes:
    """A telegram of random bytes, or a command with random fields; neither erases the flash."""
    if random.random() < 0.2:
        return random.randbytes(random.randint(1, 128))
    command = random.choice(fp.all_commands())
    head = bytes((command.KIND | (_NO_REPLY if random.random() < 0.15 else 0), command.OPCODE))
    body = bytearray(
        random.choices((0, 1, 2, 3, 5, 0x20, 0xFF, random.randrange(256)), k=random.randint(0, 60))
    )
    if random.random() < 0.4:
        body[:20] = random.choice(_NAMES).ljust(20, b"\0")
    if random.random() < 0.2:
        body[:4] = random.choice(list(fp.ModuleId)).to_bytes(4, "little")
    telegram = bytearray(head + body)
    while random.random() < 0.3:
        telegram[random.randrange(len(telegram))] = random.randrange(256)
    if telegram[:2] in _ERASING:
        return random_telegram(random)
    return bytes(telegram)


def _reply(firmware: Firmware, transport: Transport) -> bytes | None:
    replies = firmware.transmit(transport)
    if not replies:
        return None
    whole = b"".join(replies)
    return whole if transport is Transport.USB else whole[2:]


def _judge_long_read(telegram: bytes, reply: bytes | None) -> str:
    """A READ that the radio carries: answered unasked, in as many bytes as there are; forgotten while it is busy."""
    kind = telegram[0] & ~_NO_REPLY
    if reply is None and (telegram[0] & _NO_REPLY or kind not in (TelegramType.DIRECT, TelegramType.SYSTEM)):
        return "silence"
    assert kind == TelegramType.SYSTEM, (telegram, reply)
    if len(telegram) > 1:
        assert telegram[1] == fp.ReadFile.OPCODE, (telegram, reply)
    if reply is None:
        return "busy radio"
    assert reply[:2] == bytes((TelegramType.REPLY, fp.ReadFile.OPCODE)), (telegram, reply)
    return "long read"


def _judge(telegram: bytes, reply: bytes | None, transport: Transport) -> str:
    """The kind of the reply; raises where there is none of its kind."""
    kind = telegram[0] & ~_NO_REPLY
    wanted = kind in (TelegramType.DIRECT, TelegramType.SYSTEM) and not telegram[0] & _NO_REPLY
    if not wanted:
        assert reply is None, (telegram, reply)
        return "silence"
    assert reply is not None, telegram
    assert reply[0] == TelegramType.REPLY, (telegram, reply)
    if len(telegram) > 1:
        assert reply[1] == telegram[1], (telegram, reply)
    try:
        command = fp.find_command(kind, reply[1])
    except fp.OpcodeError:
        return _judge_unknown(telegram, reply, kind)
    longest = 64 if transport is Transport.USB else 0xFFFF + 6
    assert 3 <= len(reply) <= longest, (telegram, reply)
    answer = fp.decode_answer(command, reply)
    assert not answer.status.name.startswith("UNKNOWN_") or answer.status is Status.UNKNOWN_OPCODE, reply
    assert answer.status is not Status.INSANE_PACKET, reply
    whole = len(reply) == _HEAD_SIZE or answer.reply is not None
    assert whole or _is_short_i2c_read(command, reply), (telegram, reply)
    return answer.status.name


def _is_short_i2c_read(command: type[fp.Command[Any]], reply: bytes) -> bool:
    """An LS_READ with an error is shorter by the bytes that wait."""
    full = _HEAD_SIZE + 1 + fp.limits.LOW_SPEED_BUFFER_SIZE
    return command is fp.LowSpeedRead and len(reply) == full - reply[_HEAD_SIZE]


def _judge_unknown(telegram: bytes, reply: bytes, kind: int) -> str:
    if kind == TelegramType.SYSTEM:
        assert len(reply) == len(telegram) + 2, (telegram, reply)
        return "stale bytes"
    assert reply[2:] == bytes((Status.UNKNOWN_OPCODE,)), (telegram, reply)
    return Status.UNKNOWN_OPCODE.name


if __name__ == "__main__":
    print("\n".join(report()))
