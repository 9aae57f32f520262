"""Every check on every brick, and a brick that fails."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conformance_fake import FakeBrick
from conformance_serving import served_directly

from nxt_twin.testing.conformance import (
    CHECKS,
    NotConformingError,
    OpenBrick,
    check_keeps_files_of_any_size,
    check_says_who_it_is,
)


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_conformance(check, open_brick: OpenBrick):
    check(open_brick)


class Forgetful(FakeBrick):
    """Loses the last byte of every read, and its name."""

    def on_ReadFile(self, asked):
        reply = super().on_ReadFile(asked)
        return replace(reply, data=reply.data[:-1] + b"!") if hasattr(reply, "data") else reply

    def on_GetDeviceInfo(self, asked):
        return replace(super().on_GetDeviceInfo(asked), name="")


@pytest.mark.parametrize(
    ("check", "told"),
    [(check_keeps_files_of_any_size, "file of 1 bytes"), (check_says_who_it_is, "characters of the name: 0")],
)
def test_a_brick_that_fails_is_told_how(check, told):
    with served_directly(Forgetful().answer) as opener, pytest.raises(NotConformingError, match=told):
        check(opener)
