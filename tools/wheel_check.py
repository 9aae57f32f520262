"""Build the wheel twice, compare the bytes, and try it in clean environments: alone, and with each extra.

Each environment is told by its size and runs what it was installed for, in an empty folder with an empty cache.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path
from typing import Final

_ROOT: Final = Path(__file__).parents[1]
_MB: Final = 1e6
_TWIN: Final = "nxt_twin"
_RECORD: Final = (
    *(_TWIN, "record", "mock:", "--program", "gentle_steps", "--seconds", "4", "--ports", "a", "--yes"),
    *("--out", "fleet/unit/session/run.csv"),
)
_BLIND: Final = (
    *(_TWIN, "blind", "make", "cases", "answers", "--family", "mujoco", "--effects", "payload_inertia"),
    *("--clean", "0", "--pairs", "0", "--triples", "0", "--unknown", "0"),
)
_COMMANDS: Final[dict[str, tuple[tuple[str, ...], ...]]] = {
    "": (
        (_TWIN, "--version"),
        (_TWIN, "connect", "mock:"),
        _RECORD,
        (_TWIN, "simulate", "nxt_motor", "fleet/unit/session/run.csv"),
        (_TWIN, "tour", "--yes"),
    ),
    "view": ((_TWIN, "export", "fleet/unit/session/run.csv", "--to", "rrd", "--out", "run.rrd"),),
    "world": ((_TWIN, "world", "playground", "--seconds", "1"),),
    "fleet": (
        (_TWIN, "fleet", "diagnose", "fleet", "--out", "fleet.parquet", "--jobs", "1"),
        ("distributed.cli.dask_scheduler", "--version"),
    ),
    "rosbag": ((_TWIN, "export", "fleet/unit/session/run.csv", "--to", "mcap", "--out", "run.mcap"),),
    "world,film": ((_TWIN, "world", "playground", "--seconds", "1", "--film", "square.mp4"),),
    "proof": (
        _BLIND,
        (_TWIN, "blind", "peers", "cases", "answers", "peers"),
    ),
}
"""By extra, and first without any, what is run once it is installed."""


def main() -> int:
    """Print what was built and tried; 1 if the wheels differ, or the installed program or an extra fails."""
    with tempfile.TemporaryDirectory(prefix="nxt-twin-wheel-") as name:
        folder = Path(name)
        first, second = (_built(folder / side) for side in ("first", "second"))
        prints = [hashlib.sha256(wheel.read_bytes()).hexdigest() for wheel in (first, second)]
        if prints[0] != prints[1]:
            print(f"the wheel differs from build to build: {prints[0]} and {prints[1]}")
            return 1
        print(
            f"{first.name}: {first.stat().st_size / _MB:.1f} MB, reproducible, sha256 {prints[0]}", flush=True
        )
        (folder / "fleet" / "unit" / "session").mkdir(parents=True)
        versions = folder / "versions.txt"
        versions.write_text(_versions(), encoding="utf-8")
        return _tried(first, folder)


def _built(folder: Path) -> Path:
    """The wheel of this checkout, with all times in it fixed."""
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1577836800", "PYTHONHASHSEED": "0"}
    command = [
        sys.executable,
        "-m",
        "build",
        "--wheel",
        "--no-isolation",
        "--outdir",
        str(folder),
        str(_ROOT),
    ]
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
    (wheel,) = folder.glob("*.whl")
    return wheel


def _versions() -> str:
    """The locked versions without their hashes, which pip would ask of our own wheel too."""
    lock = (_ROOT / "requirements" / "dev.lock").read_text(encoding="utf-8")
    return "\n".join(line.rstrip("\\ ") for line in lock.splitlines() if line[:1].isalnum())


def _tried(wheel: Path, folder: Path) -> int:
    """Install the wheel, alone and with each extra, in clean environments, and run it; 0 if no index is reached."""
    core_bytes = 0
    for extra, commands in _COMMANDS.items():
        place = folder / "environment"
        if not _installed(place, wheel, extra, folder):
            print("NOT installed: packages could not be fetched. Run make wheel-check again with a network.")
            return 0
        size = sum(
            file.stat().st_size for file in place.rglob("*") if file.is_file() and not file.is_symlink()
        )
        core_bytes = core_bytes or size
        beyond = f"{(size - core_bytes) / _MB:.0f} MB more" if extra else f"{size / _MB:.0f} MB"
        print(f"installed {f'with {extra}' if extra else 'alone'}: {beyond}", flush=True)
        if not all(_runs(place, command, folder) for command in commands):
            return 1
        shutil.rmtree(place)
    return 0


def _installed(place: Path, wheel: Path, extra: str, folder: Path) -> bool:
    venv.create(place, with_pip=True)
    pip = [str(_python(place)), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    wanted = f"{wheel}[{extra}]" if extra else str(wheel)
    command = [*pip, "--constraint", str(folder / "versions.txt"), wanted]
    return subprocess.run(command, check=False, cwd=folder).returncode == 0


def _runs(place: Path, command: tuple[str, ...], folder: Path) -> bool:
    """Run the installed program, as somebody who has neither the checkout nor any compiled model."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment["NXT_TWIN_CACHE"] = str(folder / "cache")
    done = subprocess.run(
        [str(_python(place)), "-m", *command], cwd=folder, env=environment, check=False, capture_output=True,
        text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    print(f"  python -m {' '.join(command)}: exit status {done.returncode}", flush=True)
    if done.returncode != 0:
        print(done.stdout, done.stderr)
    return done.returncode == 0


def _python(place: Path) -> Path:
    return place / ("Scripts" if os.name == "nt" else "bin") / "python"


if __name__ == "__main__":
    sys.exit(main())
