"""One key of a guessed mapping."""

from __future__ import annotations

from typing import Any, NamedTuple


class Guess(NamedTuple):
    """One key of a mapping: what stands under it, and why."""

    key: str
    value: dict[str, Any] | list[dict[str, Any]]
    why: str
