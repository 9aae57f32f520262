"""The reference of the public names: pages that mkdocstrings fills with their docstrings."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from types import ModuleType

import firmware_protocol
import nxt_twin
from nxt_twin.testing import conformance


def library() -> str:
    """The names that `import nxt_twin` offers, the root of all errors, and what stands ready for tests."""
    lead = "[The library's page](../api.md) says how these names go together."
    tests = f"## Checks for a brick of your own\n\n{_filled(conformance.__name__, 3)}"
    return "\n".join([f"# Docstrings of the library\n\n{lead}\n", *_public(nxt_twin), tests])


def protocol() -> str:
    """The names that `import firmware_protocol` offers."""
    lead = "[The wire language's page](../protocol.md) says how these names go together."
    return "\n".join([f"# Docstrings of the wire language\n\n{lead}\n", *_public(firmware_protocol)])


def _public(package: ModuleType) -> Iterator[str]:
    """A section a file, in the order of their names; constants and modules have no section."""
    homes: dict[str, list[str]] = {}
    for name in package.__all__:
        thing = getattr(package, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            homes.setdefault(thing.__module__, []).append(name)
    for home, names in sorted(homes.items()):
        yield f"## {home}\n"
        yield from (_filled(f"{home}.{name}", 3) for name in sorted(names))


def _filled(name: str, level: int) -> str:
    return f"::: {name}\n    options:\n      heading_level: {level}\n"
