"""Which engine made a row: its version and a fingerprint of its sources."""

from __future__ import annotations

from functools import cache
from hashlib import blake2b
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final

import nxt_twin

_ROOMS: Final = ("diagnose", "physics", "recording", "sensors", "configs")
_EFFECTS: Final = "nxt_twin.effects"


@cache
def engine_version() -> str:
    """`0.1.0+3f2a…`: another one wherever a diagnosis might come out otherwise.

    The fingerprint covers the sources of the engine, the plants that come along, and users' packages of effects.
    """
    root = Path(nxt_twin.__file__).parent
    digest = blake2b(digest_size=5)
    for room in _ROOMS:
        folder = root / room if (root / room).is_dir() else root.parent / room
        for path in sorted(each for each in folder.rglob("*") if each.suffix in (".py", ".yaml")):
            digest.update(path.relative_to(folder).as_posix().encode())
            digest.update(path.read_bytes())
    for point in sorted(entry_points(group=_EFFECTS), key=lambda each: each.name):
        package = point.dist
        digest.update(f"{point.name} {point.value} {package.version if package else ''}".encode())
    return f"{nxt_twin.__version__}+{digest.hexdigest()}"
