"""The wheel: two builds have equal bytes, and what is installed from it runs without the checkout."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import nxt_twin

ROOT = Path(__file__).parents[2]


def run(*command, cwd=None, **extra):
    environment = {**os.environ, **extra}
    done = subprocess.run(
        [sys.executable, *command], cwd=cwd, env=environment, check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheels(tmp_path_factory):
    built = []
    for side in ("first", "second"):
        folder = tmp_path_factory.mktemp(side)
        fixed = {"SOURCE_DATE_EPOCH": "1577836800", "PYTHONHASHSEED": "0"}
        run("-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT), **fixed)
        built.extend(folder.glob("*.whl"))
    return built


@pytest.fixture
def site(wheels, tmp_path):
    """A folder that holds what pip installs from the wheel, and nothing else of this project."""
    where = tmp_path / "site"
    pip = ("-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index")
    run(*pip, "--target", str(where), str(wheels[0]))
    return where


@pytest.mark.slow
def test_two_builds_of_the_wheel_have_equal_bytes(wheels):
    first, second = wheels
    assert first.name == second.name == f"nxt_twin-{nxt_twin.__version__}-py3-none-any.whl"
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.slow
def test_what_the_wheel_installs_runs_in_an_empty_folder(site, tmp_path):
    alone = {"cwd": tmp_path, "PYTHONPATH": str(site)}
    where = run(
        "-c", "import nxt_twin, firmware_protocol as f; print(nxt_twin.__file__, f.__file__)", **alone
    )
    assert all(path.startswith(str(site)) for path in where.split())
    assert nxt_twin.__version__ in run("-m", "nxt_twin", "--version", **alone)
    assert "1.29" in run("-m", "nxt_twin", "connect", "mock:", **alone)
    assert "hanging_payload" in run("-m", "nxt_twin", "blind", "families", **alone)
    for package in ("nxt_twin", "firmware_protocol"):
        assert (site / package / "py.typed").is_file()
    (points,) = site.glob("nxt_twin-*.dist-info/entry_points.txt")
    assert "[pytest11]" in points.read_text()
