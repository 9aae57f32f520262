"""Requests and replies when they do not come one after the other as they should."""

from __future__ import annotations

import pytest
from brick_fakes import ScriptedLink, VirtualClock, marker_reply

from firmware_protocol import GetBatteryLevel, OutputPort, SetBrickName, Status
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import (
    CommandRefusedError,
    GarbageError,
    HalfTelegramError,
    LinkLostError,
    LinkTimeoutError,
    RequestError,
)
from nxt_twin.brick.exchange import _MARKERS, Exchange
from nxt_twin.brick.policy import Policy

BATTERY = b"\x02\x0b\x00\x10\x20"
COAST_ALL = bytes.fromhex("8004ff00000000000000000000")[:12]
POLICY = Policy(reply_timeout_s=1.0, keep_alive_period_s=None)


def motor_reply(port: int, tacho_deg: int) -> bytes:
    return b"\x02\x06\x00" + bytes((port,)) + bytes(9) + tacho_deg.to_bytes(4, "little") + bytes(8)


class Talk:
    """A brick whose answers to the n-th telegram that is no marker are written down."""

    def __init__(self, *answers, policy: Policy = POLICY) -> None:
        self.clock = VirtualClock()
        self._answers = list(answers)
        self.link = ScriptedLink(self.clock, self._script)
        self.brick = Brick(self.link, self.clock, policy)

    def _script(self, telegram: bytes):
        if telegram[1] == 0x94:
            return [marker_reply(telegram)]
        return self._answers.pop(0) if self._answers else []


def test_a_reply_carries_when_it_was_asked_for_and_when_it_came():
    talk = Talk([0.25, BATTERY])
    before_s = talk.clock.time_s
    reply = talk.brick.device.battery_v()
    assert reply.value == pytest.approx(8.208)
    assert reply.sent_s == pytest.approx(before_s, abs=1e-3)
    assert reply.received_s - reply.sent_s == pytest.approx(0.25, abs=1e-3)


def test_silence_is_a_timeout_that_names_the_command():
    talk = Talk([])
    with pytest.raises(LinkTimeoutError, match="GET_BATT_LVL within 1 s"):
        talk.brick.device.battery_v()
    assert talk.brick.health.timeouts == 1


def test_a_late_reply_of_the_same_kind_is_not_taken_for_the_next():
    late, fresh = motor_reply(0, 111), motor_reply(0, 222)
    talk = Talk([1.5, late], [fresh])
    with pytest.raises(LinkTimeoutError):
        talk.brick.motors.read(OutputPort.A)
    assert talk.brick.motors.read(OutputPort.A).value.tacho_deg == 222
    assert talk.brick.health.late == 1
    assert talk.brick.health.resynchronised == 1


def test_a_reply_that_comes_while_another_is_waited_for_is_dropped():
    talk = Talk([motor_reply(1, 5), b"\x02\x0d\x00\x00\x00\x00\x00", motor_reply(0, 7)])
    assert talk.brick.motors.read(OutputPort.A).value.tacho_deg == 7
    assert talk.brick.health.late == 2


def test_ctrl_c_while_waiting_leaves_the_next_request_in_step():
    talk = Talk([KeyboardInterrupt(), motor_reply(0, 1)], [motor_reply(0, 2)])
    with pytest.raises(KeyboardInterrupt):
        talk.brick.motors.read(OutputPort.A)
    assert talk.brick.motors.read(OutputPort.A).value.tacho_deg == 2


def test_a_message_of_a_program_is_no_reply_and_does_no_harm():
    talk = Talk([b"\x80\x09\x00\x02A\0", BATTERY])
    assert talk.brick.device.battery_v().value > 8
    assert talk.brick.health.foreign == 1


def test_nothing_but_garbage_is_said_to_be_garbage():
    talk = Talk([b"\x55\xaa", b""], [BATTERY])
    with pytest.raises(GarbageError, match="no brick sends"):
        talk.brick.device.battery_v()
    assert talk.brick.device.battery_v().value > 8


@pytest.mark.parametrize("reply", [b"\x02\x0b", b"\x02\x0b\x00", BATTERY[:-1], BATTERY + b"\0"])
def test_a_broken_reply_is_garbage_and_survived(reply: bytes):
    talk = Talk([reply], [BATTERY])
    with pytest.raises(GarbageError, match="broken"):
        talk.brick.device.battery_v()
    assert talk.brick.device.battery_v().value > 8


def test_half_a_telegram_is_passed_on_as_such_and_survived():
    talk = Talk([HalfTelegramError("half")], [BATTERY])
    with pytest.raises(HalfTelegramError):
        talk.brick.device.battery_v()
    assert talk.brick.device.battery_v().value > 8


def test_a_lost_link_is_passed_on_as_such():
    talk = Talk([LinkLostError("unplugged")])
    with pytest.raises(LinkLostError, match="unplugged"):
        talk.brick.device.battery_v()


def test_a_refusal_tells_status_data_and_stamps_and_needs_no_resynchronisation():
    talk = Talk([b"\x02\x06\xc0" + bytes(22)], [BATTERY])
    with pytest.raises(CommandRefusedError) as caught:
        talk.brick.motors.read(OutputPort.B)
    assert caught.value.status is Status.VALUE_OUT_OF_RANGE
    assert caught.value.reply is not None
    assert caught.value.sent_s < caught.value.received_s
    talk.brick.device.battery_v()
    assert len(talk.link.sent) == 2


def test_a_brick_that_stays_dumb_gives_a_timeout_each_time():
    clock = VirtualClock()
    brick = Brick(ScriptedLink(clock, lambda _: []), clock, POLICY)
    for _ in range(3):
        with pytest.raises(LinkTimeoutError):
            brick.device.battery_v()


def test_a_telegram_longer_than_the_link_carries_is_not_sent():
    clock = VirtualClock()
    link = ScriptedLink(clock, lambda _: [])
    exchange = Exchange(link, clock, Policy(telegram_size=10))
    with pytest.raises(RequestError, match="18 bytes"):
        exchange.ask(SetBrickName("x"))
    with pytest.raises(RequestError):
        exchange.tell(SetBrickName("x"))
    assert link.sent == []


def test_a_brick_that_is_only_looked_at_is_not_told_to_coast():
    talk = Talk([BATTERY])
    with talk.brick as brick:
        brick.device.battery_v()
    assert len(talk.link.sent) == 1
    assert talk.link.closed


def test_leaving_lets_engaged_motors_coast_and_waits_for_the_brick():
    talk = Talk([b"\x02\x04\x00"])
    with talk.brick as brick:
        brick.motors.drive(OutputPort.A, 50)
    assert talk.link.sent[1] == COAST_ALL
    assert talk.link.sent[2][1] == 0x94
    assert len(talk.link.sent) == 3


@pytest.mark.parametrize("crash", [KeyboardInterrupt, ZeroDivisionError, SystemExit])
def test_every_way_out_lets_engaged_motors_coast(crash):
    talk = Talk()
    talk.brick.motors.drive(OutputPort.A, 50, confirm=False)
    with pytest.raises(crash), talk.brick:
        raise crash
    assert COAST_ALL in talk.link.sent
    assert talk.link.closed


def test_ctrl_c_inside_a_drive_command_lets_the_motor_coast():
    talk = Talk([KeyboardInterrupt()])
    with pytest.raises(KeyboardInterrupt), talk.brick as brick:
        brick.motors.drive(OutputPort.A, 50)
    assert talk.link.sent[1] == COAST_ALL


def test_a_braked_motor_counts_as_engaged():
    talk = Talk([b"\x02\x04\x00"])
    with talk.brick as brick:
        brick.motors.brake(OutputPort.A)
    assert COAST_ALL in talk.link.sent


def test_coasting_is_tried_again_where_the_brick_does_not_confirm():
    clock = VirtualClock()
    link = ScriptedLink(clock, lambda _: [])
    with Brick(link, clock, POLICY) as brick:
        brick.motors.drive(OutputPort.A, 50, confirm=False)
    assert link.sent.count(COAST_ALL) == 2
    assert link.closed


def test_leaving_over_a_lost_link_keeps_the_first_error():
    talk = Talk([LinkLostError("unplugged")])
    talk.link.close()
    with pytest.raises(LinkLostError), talk.brick as brick:
        brick.motors.drive(OutputPort.A, 50)


def test_closing_twice_does_nothing():
    talk = Talk([b"\x02\x04\x00"])
    talk.brick.motors.drive(OutputPort.A, 50)
    talk.brick.close()
    sent = len(talk.link.sent)
    talk.brick.close()
    assert len(talk.link.sent) == sent


def test_a_brick_that_is_polled_for_long_is_kept_awake():
    clock = VirtualClock()
    link = ScriptedLink(
        clock, lambda sent: [b"\x02\x0d\x00\xc0\x27\x09\x00"] if sent[1] == 0x0D else [BATTERY]
    )
    brick = Brick(link, clock, Policy(keep_alive_period_s=60.0))
    for _ in range(300):
        brick.device.battery_v()
        clock.sleep(1.0)
    assert link.sent.count(b"\x00\x0d") == 4


def test_keep_awake_tells_the_sleep_timeout():
    talk = Talk([b"\x02\x0d\x00\xc0\x27\x09\x00"])
    assert talk.brick.device.keep_awake().value == 600.0


def test_keep_awake_does_not_let_a_late_reply_through_to_the_next_request():
    talk = Talk([1.5, motor_reply(0, 1)], [b"\x02\x0d\x00\xc0\x27\x09\x00"], [motor_reply(0, 2)])
    with pytest.raises(LinkTimeoutError):
        talk.brick.motors.read(OutputPort.A)
    talk.brick.device.keep_awake()
    assert talk.brick.motors.read(OutputPort.A).value.tacho_deg == 2


def test_without_a_period_nobody_is_kept_awake():
    talk = Talk(*([BATTERY] for _ in range(5)))
    for _ in range(5):
        talk.clock.sleep(1000.0)
        talk.brick.device.battery_v()
    assert all(sent == bytes((0, GetBatteryLevel.OPCODE)) for sent in talk.link.sent)


FOREIGN = b"\x80\x09\x00\x02A\0"


def test_what_comes_instead_of_a_reply_does_not_lengthen_the_wait():
    talk = Talk([0.4, FOREIGN, 0.4, FOREIGN, 0.4, BATTERY])
    before_s = talk.clock.time_s
    with pytest.raises(GarbageError, match="GET_BATT_LVL"):
        talk.brick.device.battery_v()
    assert talk.clock.time_s - before_s == pytest.approx(1.0, abs=1e-3)
    assert (talk.brick.health.timeouts, talk.brick.health.foreign) == (1, 2)


def test_a_reply_in_the_last_moment_after_a_foreign_telegram_is_taken():
    talk = Talk([0.4, FOREIGN, 0.59, BATTERY])
    assert talk.brick.device.battery_v().value > 8


def test_late_replies_alone_are_a_timeout_and_no_garbage():
    talk = Talk([0.4, motor_reply(1, 5)])
    with pytest.raises(LinkTimeoutError):
        talk.brick.device.battery_v()
    assert (talk.brick.health.late, talk.brick.health.foreign) == (1, 0)


def test_half_a_telegram_counts_as_a_timeout_wherever_it_comes():
    talk = Talk([HalfTelegramError("half")], [FOREIGN, HalfTelegramError("half")])
    for count in (1, 2):
        with pytest.raises(HalfTelegramError):
            talk.brick.device.battery_v()
        assert talk.brick.health.timeouts == count


def test_a_brick_is_out_of_step_until_a_marker_has_come_back():
    """The first marker is lost; the second brings requests and replies together."""
    clock, markers = VirtualClock(), []

    def script(telegram: bytes):
        if telegram[1] != 0x94:
            return [] if not markers else [BATTERY]
        markers.append(telegram)
        return [] if len(markers) == 1 else [marker_reply(telegram)]

    brick = Brick(ScriptedLink(clock, script), clock, POLICY)
    with pytest.raises(LinkTimeoutError):
        brick.device.battery_v()
    assert brick.device.battery_v().value > 8
    assert len(markers) == 2
    assert markers[0] != markers[1]
    assert brick.health.resynchronised == 1
    brick.device.battery_v()
    assert len(markers) == 2


def test_a_brick_is_kept_awake_no_sooner_than_its_period_tells():
    clock = VirtualClock()
    link = ScriptedLink(
        clock, lambda sent: [b"\x02\x0d\x00\xc0\x27\x09\x00"] if sent[1] == 0x0D else [BATTERY]
    )
    brick = Brick(link, clock, Policy(keep_alive_period_s=60.0))
    for wait_s, kept_awake in ((59.0, 0), (1.1, 1), (59.0, 1), (1.1, 2)):
        clock.sleep(wait_s)
        brick.device.battery_v()
        assert link.sent.count(b"\x00\x0d") == kept_awake


def test_sixteen_markers_follow_one_another_before_one_comes_again():
    assert len({marker.telegram for marker in _MARKERS}) == len(_MARKERS) == 16
