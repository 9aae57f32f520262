"""What the program imports before it can answer: what is slow to import waits until it is needed."""

import subprocess
import sys

import pyarrow as pa
import pyarrow.parquet
import pytest

from nxt_twin.cli.app import COMMANDS

COMPILER = {"numba", "llvmlite", "scipy"}
PICTURES = {"matplotlib", "jinja2", "rerun"}
NUMBERS = {"numpy", "pyarrow", "yaml"}
TELL = "import sys; print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr)"
RUN = "import atexit\n@atexit.register\ndef tell():\n    {tell}\nfrom nxt_twin.cli import main\nmain()"


def imported(code, *arguments):
    """The packages that a fresh interpreter has imported once it has run `code`."""
    program = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(program, capture_output=True, text=True, timeout=120, check=True)
    return set(done.stderr.split()), done.stdout


def imported_by_program(*arguments):
    return imported(RUN.format(tell=TELL), *arguments)


def test_the_package_imports_only_the_standard_library():
    found, _ = imported(f"import nxt_twin; {TELL}")
    assert "nxt_twin" in found
    assert not found & (COMPILER | PICTURES | NUMBERS | {"typer", "rich"})


def test_the_list_of_commands_imports_no_command():
    found, said = imported_by_program("--help")
    assert not found & (COMPILER | PICTURES | NUMBERS)
    assert all(summary.split()[0] in said for summary in COMMANDS.values())


def test_a_brick_answers_without_the_compiler():
    found, said = imported_by_program("connect", "mock:")
    assert "NXT at mock:" in said
    assert not found & (COMPILER | PICTURES | {"pyarrow"})


@pytest.mark.parametrize(
    ("verb", "names"),
    [
        ("diagnose", "--model-out"),
        ("live", "--adopt"),
        ("replay", "--speed"),
        ("demo", "--conceal"),
        ("identify", "--positioner"),
        ("blind", "reveal"),
    ],
)
def test_help_on_a_command_needs_neither_numbers_nor_the_compiler(verb, names):
    found, said = imported_by_program(verb, "--help")
    assert names in said
    assert not found & (COMPILER | PICTURES | NUMBERS)


def test_a_prediction_needs_no_data_frames(tmp_path):
    table = pa.table({"time_s": [0.0, 0.5, 1.0], "a_power_pct": [50, 50, None]})
    pyarrow.parquet.write_table(table, tmp_path / "run.parquet")
    predicted = str(tmp_path / "predicted.csv")
    found, said = imported_by_program(
        "simulate", "nxt_motor", str(tmp_path / "run.parquet"), "--out", predicted
    )
    assert "a_tacho_deg: predicted" in said
    assert not found & (PICTURES | {"pandas"})


def test_a_prediction_imports_neither_linear_algebra_nor_arrows_functions(tmp_path):
    (tmp_path / "run.csv").write_text("time_s,a_power_pct\n0,50\n0.5,50\n1,0\n")
    asked = TELL.replace("{name.partition('.')[0] for name in sys.modules}", "sys.modules")
    found, said = imported(RUN.format(tell=asked), "simulate", "nxt_motor", str(tmp_path / "run.csv"))
    assert "a_tacho_deg: predicted" in said
    assert "numba.np.arraymath" in found
    assert not found & {"scipy.linalg", "pyarrow.compute"}


def test_a_function_compiled_afterwards_multiplies_matrices():
    code = (
        "import sys\n"
        "from nxt_twin.physics.late_blas import import_without_blas\n"
        "import_without_blas()\n"
        "import numba, numpy as np\n"
        "product = numba.njit(lambda a: a @ a)(np.diag([2.0, 3.0]))\n"
        "print(product[0, 0], product[1, 1], 'scipy.linalg' in sys.modules)"
    )
    assert imported(code)[1] == "4.0 9.0 True\n"


THREADS = (
    "import atexit, os, sys\n"
    "atexit.register(lambda: print(os.environ.get('OPENBLAS_NUM_THREADS'), file=sys.stderr))\n"
    "from nxt_twin.cli import main\nmain()"
)


@pytest.mark.parametrize(("asked", "given"), [({}, "1"), ({"OMP_NUM_THREADS": "4"}, "None")])
def test_the_program_does_linear_algebra_in_one_thread_unless_the_user_says_otherwise(
    monkeypatch, asked, given
):
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    found, _ = imported(THREADS, "--help")
    assert found == {given}
