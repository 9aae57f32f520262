"""Draw the README's picture from a real run: conceal an effect, diagnose, draw before and after."""

from __future__ import annotations

import tempfile
from pathlib import Path

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.recording.case import read_case
from nxt_twin.view.picture import write_picture

SEED = 6
EFFECT = "gravity_load"


def main() -> None:
    """Write docs/images/demo.png."""
    target = Path(__file__).resolve().parents[1] / "docs" / "images" / "demo.png"
    with tempfile.TemporaryDirectory() as folder:
        case = make_case(SEED, effects=(EFFECT,), size="small", duration_s=12.0, name="demo")
        place = write_case(case, Path(folder) / "cases", Path(folder) / "answers")
        write_picture(diagnose(read_case(place)).diagnosis, target)
    print(target.name)


if __name__ == "__main__":
    main()
