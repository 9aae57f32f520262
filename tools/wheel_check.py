"""Build the wheel twice, compare the bytes, install it in a clean environment, run it, and tell installed sizes."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path
from typing import Final

import closures

_ROOT: Final = Path(__file__).parents[1]
_MB: Final = 1e6


def main() -> int:
    """Print what was built and tried; 1 if the wheels differ or the installed program fails."""
    with tempfile.TemporaryDirectory(prefix="nxt-twin-wheel-") as name:
        folder = Path(name)
        first, second = (_built(folder / side) for side in ("first", "second"))
        prints = [hashlib.sha256(wheel.read_bytes()).hexdigest() for wheel in (first, second)]
        if prints[0] != prints[1]:
            print(f"the wheel differs from build to build: {prints[0]} and {prints[1]}")
            return 1
        print(f"{first.name}: {first.stat().st_size / _MB:.1f} MB, reproducible, sha256 {prints[0]}")
        tried = _tried(first, folder)
    _tell_sizes()
    return tried


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


def _tried(wheel: Path, folder: Path) -> int:
    """Install the wheel over the locked packages in a clean environment and run it; 0 if no index is reached."""
    venv.create(folder / "clean", with_pip=True)
    python = folder / "clean" / ("Scripts" if os.name == "nt" else "bin") / "python"
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    locked = [*pip, "--require-hashes", "--requirement", str(_ROOT / "requirements" / "run.lock")]
    if subprocess.run(locked, check=False, cwd=folder).returncode != 0:
        print(
            "NOT installed: the locked packages could not be fetched. Run make wheel-check again with a network."
        )
        return 0
    subprocess.run([*pip, "--no-deps", str(wheel)], check=True, cwd=folder)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    for arguments in (["--version"], ["connect", "mock:"], ["simulate", "--help"], ["tour", "--yes"]):
        done = subprocess.run(
            [str(python), "-m", "nxt_twin", *arguments], cwd=folder, env=environment, check=False, capture_output=True,
            text=True, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        print(f"nxt-twin {' '.join(arguments)}: exit status {done.returncode}")
        if done.returncode != 0:
            print(done.stderr)
            return 1
    return 0


def _tell_sizes() -> None:
    """Installed sizes by the files of the packages that are installed here."""
    core = closures.brought()
    print(f"installed with its packages: core {sum(map(closures.size_bytes, core.values())) / _MB:.0f} MB")
    for extra in closures.EXTRAS:
        more = {name: held for name, held in closures.brought(extra).items() if name not in core}
        print(f"  extra {extra}: {sum(map(closures.size_bytes, more.values())) / _MB:.0f} MB more")


if __name__ == "__main__":
    sys.exit(main())
