"""Files for the recording tests."""

from collections.abc import Callable
from pathlib import Path

import pytest

from nxt_twin.errors import NxtTwinError


@pytest.fixture
def put(tmp_path: Path) -> Callable[..., Path]:
    """Write text or bytes to a named file in the test's folder."""

    def write(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


@pytest.fixture
def refusal() -> Callable[..., str]:
    """Call, and return the one line with which it refuses."""

    def refuse(error: type[NxtTwinError], call: Callable[..., object], *arguments: object) -> str:
        with pytest.raises(error) as caught:
            call(*arguments)
        line = str(caught.value)
        assert "\n" not in line
        return line

    return refuse
