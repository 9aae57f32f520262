"""What a tap records can be read and replayed."""

from __future__ import annotations

import io

import pytest
from brick_fakes import ScriptedLink, VirtualClock, marker_reply

from firmware_protocol import OutputPort
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import BrickError, LinkLostError, LinkTimeoutError
from nxt_twin.brick.policy import Policy
from nxt_twin.brick.tap import ReplayLink, TappedLink, Way, read_tap

BATTERY = b"\x02\x0b\x00\x10\x20"
POLICY = Policy(keep_alive_period_s=None)


def session(brick: Brick) -> tuple[float, float]:
    with brick:
        brick.motors.drive(OutputPort.A, 30, confirm=False)
        first = brick.device.battery_v().value
        with pytest.raises(LinkTimeoutError):
            brick.device.battery_v()
        return first, brick.device.battery_v().value


@pytest.fixture
def recorded() -> str:
    clock = VirtualClock()
    answers = [[BATTERY], [], [b"\x02\x0b\x00\x20\x20"]]

    def script(sent: bytes):
        if sent[0] >= 0x80:
            return []
        return [marker_reply(sent)] if sent[1] == 0x94 else answers.pop(0)

    sink = io.StringIO()
    brick = Brick(TappedLink(ScriptedLink(clock, script), clock, sink), clock, POLICY)
    assert session(brick) == (pytest.approx(8.208), pytest.approx(8.224))
    return sink.getvalue()


def test_a_tap_holds_every_telegram_with_its_stamp(recorded: str):
    tap = read_tap(recorded.splitlines(keepends=True))
    assert tap.link == "script"
    assert [event.way for event in tap.events[:4]] == [Way.OUT, Way.OUT, Way.IN, Way.OUT]
    assert tap.events[2].hex == BATTERY.hex()
    assert tap.events[4].error == "LinkTimeoutError"
    stamps = [event.at_s for event in tap.events]
    assert stamps == sorted(stamps)


def test_a_replay_gives_the_program_what_it_got(recorded: str):
    link = ReplayLink(read_tap(recorded.splitlines(keepends=True)))
    assert session(Brick(link, VirtualClock(), POLICY)) == (pytest.approx(8.208), pytest.approx(8.224))


def test_another_program_is_told_where_it_departs(recorded: str):
    link = ReplayLink(read_tap(recorded.splitlines(keepends=True)))
    with pytest.raises(BrickError, match="goes on with out 8004"):
        link.send(b"\x00\x0b")


def test_the_end_of_a_recording_is_a_lost_link(recorded: str):
    link = ReplayLink(read_tap(recorded.splitlines(keepends=True)[:1]))
    with pytest.raises(LinkLostError, match="at its end"):
        link.send(b"\x00\x0b")


def test_a_last_line_that_a_crash_cut_off_is_left_out(recorded: str):
    whole = read_tap(recorded.splitlines(keepends=True))
    cut = read_tap(recorded[:-20].splitlines(keepends=True))
    assert cut.events == whole.events[:-1]


@pytest.mark.parametrize(
    "text",
    ["", "x\n", "[]\n", "[" * 30_000, '{"schema": "other", "link": "x"}\n',
     '{"schema": "nxt-twin/tap/1", "link": "x"}\n{}\n',
     '{"schema": "nxt-twin/tap/1", "link": "x"}\n{"at_s": 1, "way": "in", "hex": "0g"}\n'],
)  # fmt: skip
def test_what_is_no_tap_is_refused(text: str):
    with pytest.raises(BrickError, match="not a tap's file"):
        read_tap(text.splitlines(keepends=True))
