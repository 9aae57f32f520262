"""What every link that carries a stream of bytes has to do when all goes well, and when it does not."""

from __future__ import annotations

import pytest
from conformance_links import LINKS, LinkPair

from firmware_protocol import frame
from nxt_twin.brick.errors import GarbageError, HalfTelegramError, LinkLostError, LinkTimeoutError

REPLY = b"\x02\x0b\x00\x10\x20"
WAIT_S = 0.1


@pytest.fixture(params=LINKS)
def pair(request: pytest.FixtureRequest):
    with LINKS[request.param]() as pair:
        yield pair


def test_a_telegram_goes_out_behind_its_length(pair: LinkPair):
    pair.link.send(b"\x00\x0b")
    assert pair.far.read() == b"\x02\x00\x00\x0b"


def test_a_telegram_comes_in_whole(pair: LinkPair):
    pair.far.write(frame(REPLY))
    assert pair.link.receive(1.0) == REPLY


def test_telegrams_that_come_at_once_are_given_one_by_one(pair: LinkPair):
    pair.far.write(frame(REPLY) + frame(b"\x02\x0d\x00\x00\x00\x00\x00"))
    assert pair.link.receive(1.0) == REPLY
    assert pair.link.receive(0.0)[1] == 0x0D


def test_a_telegram_that_comes_in_pieces_is_put_together(pair: LinkPair):
    stream = frame(REPLY)
    pair.far.write(stream[:3])
    with pytest.raises(LinkTimeoutError):
        pair.link.receive(0.0)
    pair.far.write(frame(REPLY))
    pair.link.send(b"\x00\x0b")
    pair.far.write(stream[:4])
    pair.far.write(stream[4:])
    assert pair.link.receive(1.0) == REPLY


def test_silence_is_a_timeout(pair: LinkPair):
    with pytest.raises(LinkTimeoutError) as caught:
        pair.link.receive(WAIT_S)
    assert not isinstance(caught.value, HalfTelegramError)


def test_half_a_telegram_is_told_from_silence_and_survived(pair: LinkPair):
    pair.far.write(frame(REPLY)[:-1])
    with pytest.raises(HalfTelegramError, match="half a telegram"):
        pair.link.receive(WAIT_S)
    pair.far.write(REPLY[-1:])
    pair.link.send(b"\x00\x0b")
    pair.far.write(frame(REPLY))
    assert pair.link.receive(1.0) == REPLY


def test_a_length_that_makes_no_sense_is_garbage_and_survived(pair: LinkPair):
    pair.far.write(b"\xff\xff\x01\x02\x03")
    with pytest.raises(GarbageError):
        pair.link.receive(WAIT_S)
    pair.link.send(b"\x00\x0b")
    pair.far.write(frame(REPLY))
    assert pair.link.receive(1.0) == REPLY


def test_a_far_end_that_vanishes_is_a_lost_link(pair: LinkPair):
    pair.far.vanish()
    with pytest.raises(LinkLostError):
        pair.link.receive(1.0)


def test_what_came_before_the_loss_is_still_given(pair: LinkPair):
    pair.far.write(frame(REPLY))
    assert pair.link.receive(1.0) == REPLY
    pair.far.vanish()
    with pytest.raises(LinkLostError):
        pair.link.receive(1.0)


def test_a_closed_link_is_a_lost_link_and_may_be_closed_again(pair: LinkPair):
    pair.link.close()
    pair.link.close()
    with pytest.raises(LinkLostError):
        pair.link.send(b"\x00\x0b")
    with pytest.raises(LinkLostError):
        pair.link.receive(WAIT_S)


def test_every_link_says_what_it_is(pair: LinkPair):
    assert pair.link.describe()
