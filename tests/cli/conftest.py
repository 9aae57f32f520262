"""Two tiny cases, and the diagnosis of one with all that a diagnosis may write; made once."""

from types import SimpleNamespace

import pytest
from cli_program import succeed

from nxt_twin.blind.make import make_case, write_case


@pytest.fixture(scope="session")
def cases(tmp_path_factory):
    """Folders by name: nothing is missing in `clean`, Coulomb friction in `friction`."""
    root = tmp_path_factory.mktemp("cli")
    concealed = {"clean": (), "friction": ("coulomb_friction",)}
    return {
        name: write_case(
            make_case(5, effects=effects, duration_s=6.0, recordings=1, name=name),
            root / "cases",
            root / "answers",
        )
        for name, effects in concealed.items()
    }


@pytest.fixture(scope="session")
def diagnosed(cases, tmp_path_factory):
    """What `diagnose` said of `friction`, and the files it wrote."""
    out = tmp_path_factory.mktemp("diagnosed")
    files = SimpleNamespace(json=out / "new" / "d.json", model=out / "new" / "m.yaml", report=out / "pages")
    files.outcome = succeed(
        "diagnose",
        cases["friction"],
        "--json",
        files.json,
        "--model-out",
        files.model,
        "--report",
        files.report,
    )
    return files
