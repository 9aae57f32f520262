"""A brick on USB: which one, whether it may be used, and what it takes to make it answer."""

from __future__ import annotations

import errno

import pytest
from brick_fake_usb import VERSIONS_REPLY, FakeUsbBackend, FakeUsbBrick
from brick_fakes import VirtualClock

from nxt_twin.brick.errors import (
    GarbageError,
    LinkLostError,
    LinkRefusedError,
    LinkTimeoutError,
    LinkUrlError,
    Refusal,
)
from nxt_twin.brick.links.usb import Recovery, open_usb
from nxt_twin.brick.search.usb import look_on_usb


def open_only(brick: FakeUsbBrick, address: str = "", *, may_reset: bool = True):
    return open_usb(address, VirtualClock(), backend=FakeUsbBackend(brick), may_reset=may_reset)


def refusal(*bricks: FakeUsbBrick, address: str = "") -> LinkRefusedError:
    with pytest.raises(LinkRefusedError) as caught:
        open_usb(address, VirtualClock(), backend=FakeUsbBackend(*bricks))
    return caught.value


def test_a_healthy_brick_is_opened_without_any_recovery_and_named_by_its_serial_number():
    brick = FakeUsbBrick()
    link = open_only(brick)
    assert link.describe() == "usb:001653010203"
    assert link.recovery is Recovery.NONE
    assert brick.calls == []


def test_telegrams_go_out_and_come_in():
    link = open_only(FakeUsbBrick())
    link.send(b"\x01\x88")
    assert link.receive(1.0) == VERSIONS_REPLY
    with pytest.raises(LinkTimeoutError):
        link.receive(0.0)


def test_replies_of_an_earlier_session_are_drained():
    brick = FakeUsbBrick()
    brick.stale.extend([b"\x02\x06\x00", b"\x02\x0b\x00\x00\x20"])
    link = open_only(brick)
    assert link.recovery is Recovery.DRAIN
    assert link.describe() == "usb:001653010203 (needed: drain)"
    assert brick.calls == []


def test_a_halted_endpoint_is_cleared_before_a_reset_is_thought_of():
    brick = FakeUsbBrick()
    brick.halted = True
    link = open_only(brick)
    link.send(b"\x01\x88")
    assert link.receive(1.0) == VERSIONS_REPLY
    assert link.recovery is Recovery.CLEAR_HALT
    assert brick.calls == ["clear halt"]


def test_a_brick_that_stays_silent_is_reset_at_last():
    brick = FakeUsbBrick()
    brick.silent_until_reset = True
    link = open_only(brick)
    assert link.recovery is Recovery.RESET
    assert brick.calls == ["clear halt", "clear halt", "reset"]
    assert brick.claimed


def test_where_a_reset_loses_the_device_none_is_tried():
    brick = FakeUsbBrick()
    brick.silent_until_reset = True
    with pytest.raises(LinkRefusedError, match="in spite of clear halt"):
        open_only(brick, may_reset=False)
    assert "reset" not in brick.calls
    assert not brick.claimed


@pytest.mark.parametrize(
    ("number", "cause", "mend"),
    [
        (errno.EACCES, Refusal.NO_PERMISSION, "nxt-twin udev"),
        (errno.EBUSY, Refusal.BUSY, "close"),
        (errno.ENOSYS, Refusal.NO_DRIVER, "Zadig"),
        (errno.ENODEV, Refusal.NOT_FOUND, "plug it in"),
    ],
)
def test_an_obstacle_is_named_with_its_mend(number: int, cause: Refusal, mend: str):
    brick = FakeUsbBrick()
    brick.claim_error = number
    error = refusal(brick)
    assert error.cause is cause
    assert mend in error.mend


def test_a_device_that_may_not_even_be_read_says_so():
    brick = FakeUsbBrick()
    brick.open_error = errno.EACCES
    assert refusal(brick).cause is Refusal.NO_PERMISSION
    assert refusal(brick, address="001653010203").cause is Refusal.NO_PERMISSION


def test_no_brick_at_all_says_so():
    assert refusal().cause is Refusal.NOT_FOUND


def test_firmware_download_mode_is_recognised():
    assert refusal(FakeUsbBrick(vendor=(0x03EB, 0x6124))).cause is Refusal.BOOT_MODE


def test_other_firmware_is_recognised_and_named():
    error = refusal(FakeUsbBrick(product="NXT + Pybricks"))
    assert error.cause is Refusal.OTHER_FIRMWARE
    assert "Pybricks" in error.what


def test_of_several_bricks_one_has_to_be_named():
    one, two = FakeUsbBrick(), FakeUsbBrick(serial="00165309AABB")
    error = refusal(one, two)
    assert "usb:001653010203, usb:00165309AABB" in error.mend
    link = open_usb("00:16:53:09:aa:bb", VirtualClock(), backend=FakeUsbBackend(one, two))
    assert link.describe() == "usb:00165309AABB"
    assert two.claimed
    assert not one.claimed


def test_a_serial_number_that_nobody_has_names_those_there_are():
    assert "usb:001653010203" in refusal(FakeUsbBrick(), address="001653FFFFFF").mend


def test_a_serial_number_that_is_none_is_wrong_use():
    with pytest.raises(LinkUrlError):
        open_only(FakeUsbBrick(), "brick")


def test_unplugging_is_a_lost_link():
    brick = FakeUsbBrick()
    link = open_only(brick)
    brick.unplugged = True
    for use in (lambda: link.send(b"\x01\x88"), lambda: link.receive(0.1)):
        with pytest.raises(LinkLostError):
            use()


def test_an_endpoint_that_halts_later_is_garbage_and_survived():
    brick = FakeUsbBrick()
    link = open_only(brick)
    brick.halted = True
    with pytest.raises(GarbageError):
        link.receive(0.1)
    link.send(b"\x01\x88")
    assert link.receive(0.1) == VERSIONS_REPLY


def test_a_closed_link_gives_the_device_back_and_is_lost():
    brick = FakeUsbBrick()
    link = open_only(brick)
    link.close()
    link.close()
    assert not brick.claimed
    with pytest.raises(LinkLostError):
        link.send(b"\x01\x88")


def test_the_search_neither_opens_nor_resets_and_tells_what_it_cannot_use():
    good, foreign, booting = (
        FakeUsbBrick(),
        FakeUsbBrick(product="Pybricks"),
        FakeUsbBrick(vendor=(0x03EB, 0x6124)),
    )
    report = look_on_usb(VirtualClock(), backend=FakeUsbBackend(good, foreign, booting))
    assert [brick.url for brick in report.bricks] == ["usb:001653010203"]
    assert [reason.cause for reason in report.reasons] == [Refusal.OTHER_FIRMWARE, Refusal.BOOT_MODE]
    assert good.calls == []
    assert not good.claimed


def test_a_search_without_permission_points_to_the_rule():
    brick = FakeUsbBrick()
    brick.open_error = errno.EACCES
    (reason,) = look_on_usb(VirtualClock(), backend=FakeUsbBackend(brick)).reasons
    assert reason.cause is Refusal.NO_PERMISSION
    assert "nxt-twin udev" in reason.mend


def test_a_search_that_finds_nothing_says_so():
    (reason,) = look_on_usb(VirtualClock(), backend=FakeUsbBackend()).reasons
    assert reason.cause is Refusal.NOT_FOUND
