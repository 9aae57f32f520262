"""Whether the installed packages have the versions that this one declares to need."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from importlib import metadata
from typing import Final

from nxt_twin.brick.doctor.facts import PackageFacts

_DISTRIBUTION: Final = "nxt-twin"
_REQUIREMENT: Final = re.compile(r"(?P<name>[A-Za-z0-9._-]+)\s*(?P<wanted>[^;]*)")
_COMPARISONS: Final[dict[str, Callable[[tuple[int, ...], tuple[int, ...]], bool]]] = {
    ">=": operator.ge,
    "<=": operator.le,
    "<": operator.lt,
    ">": operator.gt,
    "==": operator.eq,
    "!=": operator.ne,
}


def installed_packages() -> tuple[PackageFacts, ...]:
    """The packages that nxt-twin needs, extras aside; none where it was not installed but only unpacked."""
    try:
        declared = metadata.requires(_DISTRIBUTION) or []
    except metadata.PackageNotFoundError:
        return ()
    return tuple(_facts(requirement) for requirement in declared if "extra ==" not in requirement)


def version_fits(version: str, wanted: str) -> bool:
    """Whether a version satisfies clauses such as ``>=2,<3``.

    Args:
        version: the version; only its leading numbers count.
        wanted: the clauses; empty for any.
    """
    return all(_clause_holds(version, clause) for clause in wanted.split(",") if clause.strip())


def _facts(requirement: str) -> PackageFacts:
    parts = _REQUIREMENT.match(requirement)
    name, wanted = (parts["name"], parts["wanted"].strip()) if parts else (requirement, "")
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        return PackageFacts(name, wanted, "", fits=False)
    return PackageFacts(name, wanted, version, fits=version_fits(version, wanted))


def _clause_holds(version: str, clause: str) -> bool:
    sign, number = re.sub(r"[^<>=!]", "", clause), re.sub(r"[<>=!\s]", "", clause)
    wanted = _numbers(number.removesuffix(".*"))
    have = _numbers(version)
    length = len(wanted) if number.endswith(".*") else max(len(wanted), len(have))
    return _COMPARISONS[sign](_padded(have, length), _padded(wanted, length))


def _numbers(version: str) -> tuple[int, ...]:
    release = re.match(r"\d+(\.\d+)*", version)
    return tuple(map(int, release.group().split("."))) if release else ()


def _padded(numbers: tuple[int, ...], length: int) -> tuple[int, ...]:
    return (*numbers, *(0,) * length)[:length]
