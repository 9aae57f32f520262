"""The packages that installing nxt-twin, or one of its extras, brings: by the metadata of those installed here."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from typing import Final

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

OURS: Final = "nxt-twin"
EXTRAS: Final = ("view", "world", "proof", "rosbag", "fleet", "film")


def brought(extra: str = "") -> dict[str, Distribution]:
    """Packages by name that the core, or the core with an extra, needs; those that are absent here are left out."""
    found: dict[str, Distribution] = {}
    waiting = [Requirement(f"{OURS}[{extra}]" if extra else OURS)]
    seen: set[tuple[str, frozenset[str]]] = set()
    while waiting:
        wanted = waiting.pop()
        name = canonicalize_name(wanted.name)
        if (name, frozenset(wanted.extras)) in seen:
            continue
        seen.add((name, frozenset(wanted.extras)))
        try:
            held = distribution(name)
        except PackageNotFoundError:
            continue
        if name != OURS:
            found[name] = held
        waiting += _needs(held, wanted.extras)
    return dict(sorted(found.items()))


def _needs(held: Distribution, extras: set[str]) -> Iterator[Requirement]:
    for line in held.requires or ():
        need = Requirement(line)
        if need.marker is None or any(need.marker.evaluate({"extra": extra}) for extra in (*extras, "")):
            yield need


def licence(held: Distribution) -> str:
    """A package's licence as its metadata state it, in a few words."""
    known = held.metadata
    classified = [
        line.rpartition(" :: ")[2]
        for line in known.get_all("Classifier") or ()
        if line.startswith("License ::")
    ]
    stated = known.get("License-Expression") or "; ".join(classified) or (known.get("License") or "")
    first = stated.strip().splitlines()[0] if stated.strip() else "not stated in its metadata"
    return re.sub(r"\s+", " ", first)[:80]
