"""The notebook runs from its first cell to its last, and finds what it hides."""

from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[2] / "examples" / "first_diagnosis.ipynb"


def outputs(cell):
    return [
        output.get("text") or output.get("data", {}).get("text/plain", "")
        for output in cell.get("outputs", [])
    ]


@pytest.fixture(scope="module")
def executed():
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    return notebook


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::RuntimeWarning")
def test_the_notebook_finds_the_concealed_load_and_draws_it(executed):
    cells = [cell for cell in executed.cells if cell.cell_type == "code"]
    said = "\n".join(text for cell in cells for text in outputs(cell))
    assert "constant_load: load_torque_nm = " in said
    assert any("image/png" in output.get("data", {}) for cell in cells for output in cell.outputs)
    given, _, improved = (float(line.split()[0]) for line in said.splitlines() if "degrees RMS" in line)
    assert improved < given / 3


def test_the_notebook_is_kept_without_outputs():
    nbformat = pytest.importorskip("nbformat")
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    assert all(
        not cell.outputs and cell.execution_count is None for cell in cells if cell.cell_type == "code"
    )
