"""Counts that add up: a run in pieces, each a line of JSON, so that a run that was ended goes on where it stopped."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

FOLDER: Final = Path("build") / "counted"


@final
@dataclass(frozen=True)
class Ledger:
    """The pieces of one run.

    Attributes:
        path: of the lines.
        run: what tells this run's lines from others', such as its seed.
    """

    path: Path
    run: str

    def pieces(self) -> Sequence[dict[str, Any]]:
        """All pieces of this run, in order."""
        if not self.path.exists():
            return ()
        lines = map(json.loads, self.path.read_text(encoding="utf-8").splitlines())
        return [line for line in lines if line["run"] == self.run]

    def add(self, piece: dict[str, Any]) -> None:
        """Keep one more piece, with the commit of the tree that was counted."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"run": self.run, "commit": _commit(), **piece}) + "\n")

    def commits(self) -> str:
        """Of all pieces, each once."""
        return ", ".join(dict.fromkeys(piece["commit"] for piece in self.pieces()))


def _commit() -> str:
    asked = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, check=False
    )
    return asked.stdout.strip() or "no commit"
