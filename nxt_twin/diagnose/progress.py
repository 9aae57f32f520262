"""A diagnosis tells its progress while it works."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Takes a line of words for a person that waits, each time a step of the work begins."""
