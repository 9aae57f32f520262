"""A guessed mapping as YAML, its reasons beside its keys."""

from __future__ import annotations

from collections.abc import Sequence

import yaml

from nxt_twin.recording.guess.guess import Guessed

_WIDTH = 100_000  # no line is broken: a key and what stands under it are one line


def mapping_text(guessed: Guessed, seen: Sequence[str]) -> str:
    """The mapping's text: first what was seen, then each key below its reason."""
    lines = [f"# {line}" for line in seen]
    for guess in guessed.guesses:
        value = yaml.safe_dump(
            guess.value, default_flow_style=True, sort_keys=False, allow_unicode=True, width=_WIDTH
        )
        lines += [f"# {guess.key}: {' '.join(guess.why.split())}", f"{guess.key}: {value.strip()}"]
    return "\n".join(lines) + "\n"
