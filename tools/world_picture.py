"""Draw the picture of docs/world.md: the robots in their worlds, each where its program has brought it.

python tools/world_picture.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from PIL import Image

from nxt_twin.world.arena import open_arena
from nxt_twin.world.film import Camera, View
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import run_program

ROOT: Final = Path(__file__).parents[1]
_SIZE: Final = (400, 260)


class Shot(NamedTuple):
    """A world, its program, when it is stopped, and from where it is looked at."""

    world: str
    program: str
    seconds: float
    view: View
    at_m: tuple[float, float, float]


SHOTS: Final = (
    Shot("line", "follow_line", 5.0, View(1.1, 20.0, -45.0, _SIZE), (0.0, 0.0, 0.0)),
    Shot("sorter", "sort_balls", 3.4, View(0.85, 115.0, -20.0, _SIZE), (0.0, 0.0, 0.0)),
    Shot("ring", "push_out", 3.2, View(1.0, 30.0, -35.0, _SIZE), (0.0, 0.0, 0.0)),
    Shot("pen", "avoid_walls", 3.0, View(1.7, 20.0, -45.0, _SIZE), (0.0, 0.0, 0.0)),
    Shot("balance", "balance", 2.0, View(0.5, 50.0, -15.0, _SIZE), (0.0, 0.0, 0.05)),
    Shot("arm", "lift_arm", 3.0, View(0.6, 30.0, -12.0, _SIZE), (0.0, 0.0, 0.1)),
)


def main() -> None:
    """Run each program for a while, and put the pictures side by side."""
    width, height = _SIZE
    sheet = Image.new("RGB", (3 * width, 2 * height))
    for n, shot in enumerate(SHOTS):
        arena = open_arena(load_setting(shot.world))
        run_program(arena, ROOT / "examples" / "worlds" / f"{shot.program}.py", limit_s=shot.seconds)
        picture = Camera(arena, shot.view).picture(np.array(shot.at_m))
        sheet.paste(picture, ((n % 3) * width, (n // 3) * height))
    sheet.convert("P", palette=Image.Palette.ADAPTIVE, colors=128).save(
        ROOT / "docs" / "pictures" / "worlds.png", optimize=True
    )


if __name__ == "__main__":
    main()
