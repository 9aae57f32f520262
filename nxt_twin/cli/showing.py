"""What `live`, `replay` and `demo` show of a session; light, since each command's help needs it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, final

ViewChoice = Literal["spawn", "web", "none"]


@final
@dataclass(frozen=True)
class Showing:
    """The output of a session: dashboard, reports and files.

    Attributes:
        title: of the session.
        schema: of its JSON.
        view: the dashboard.
        save: where the dashboard's data are kept.
        report: folder for the reports.
        model_out: where the plant of each motor is written.
        since: name of the plant with which each motor is compared at the end.
        json: file for the JSON, or `-` for standard output and nothing else.
        lossless: whether the dashboard may hold the session up.
        world: whether the dashboard shows a robot's world.
    """

    title: str
    schema: str
    view: ViewChoice = "none"
    save: Path | None = None
    report: Path | None = None
    model_out: Path | None = None
    since: str | None = None
    json: str | None = None
    lossless: bool = False
    world: bool = False
