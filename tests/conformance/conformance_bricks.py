"""The bricks that the checks run against; another one is one more line."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager

from conformance_fake import FakeBrick
from conformance_serving import (
    OpenBrick,
    served_by_pty,
    served_by_socket_pair,
    served_by_tcp,
    served_directly,
)

BRICKS: dict[str, Callable[[], AbstractContextManager[OpenBrick]]] = {
    "fake, directly": lambda: served_directly(FakeBrick().answer),
    "fake, socket pair": lambda: served_by_socket_pair(FakeBrick().answer),
    "fake, tcp": lambda: served_by_tcp(FakeBrick().answer),
    "fake, pty": lambda: served_by_pty(FakeBrick().answer),
}
