"""The check of names finds functions of two rooms and classes that bear one name, and nothing else."""

import importlib.util
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[2] / "tools"

_LISTED = ("bristle_torque", "current_after", "fit", "main", "to_json")
MEANT = dict.fromkeys(
    ("nxt_twin/blind/meant.py", "nxt_twin/physics/meant.py"),
    "".join(f"def {name}(): ...\n" for name in _LISTED),
)


@pytest.fixture(scope="module")
def house_names():
    spec = importlib.util.spec_from_file_location("house_names", TOOLS / "house_names.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def findings(house_names, root, files):
    for name, text in {**MEANT, **files}.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return list(house_names.names(root))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("nxt_twin/twin/a.py", "nxt_twin/view/b.py"),
        ("nxt_twin/cli/a.py", "nxt_twin/view/b.py"),
        ("nxt_twin/threads.py", "nxt_twin/view/b.py"),
        ("firmware_protocol/a.py", "nxt_twin/brick/deep/b.py"),
    ],
)
def test_functions_of_two_rooms_with_one_name_are_found(house_names, tmp_path, one, other):
    text = "def alike(): ...\n"
    (found,) = findings(house_names, tmp_path, {one: text, other: text})
    assert found.endswith((f"in {one}:1", f"in {other}:1"))
    assert "alike" in found


@pytest.mark.parametrize(
    "files",
    [
        {"nxt_twin/twin/a.py": "def one(): ...\n", "nxt_twin/twin/deep/b.py": "def one(): ...\n"},
        {"nxt_twin/twin/a.py": "def _one(): ...\n", "nxt_twin/view/b.py": "def _one(): ...\n"},
        {"nxt_twin/cli/one.py": "def one(): ...\n", "nxt_twin/view/b.py": "def one(): ...\n"},
        {"nxt_twin/cli/a.py": "@app.command()\ndef one(): ...\n", "nxt_twin/view/b.py": "def one(): ...\n"},
        {"nxt_twin/api/a.py": "def one(): ...\n", "nxt_twin/view/b.py": "def one(): ...\n"},
        {"nxt_twin/twin/a.py": "class A:\n def one(self): ...\n", "nxt_twin/view/b.py": "def one(): ...\n"},
    ],
    ids=["one room", "private", "verb", "verb of a verb", "public face", "method"],
)
def test_names_that_mislead_nobody_are_left_alone(house_names, tmp_path, files):
    assert findings(house_names, tmp_path, files) == []


@pytest.mark.parametrize("other", ["nxt_twin/b.py", "firmware_protocol/b.py"])
def test_classes_of_one_name_are_found(house_names, tmp_path, other):
    found = findings(house_names, tmp_path, dict.fromkeys(("nxt_twin/a.py", other), "class A: ...\n"))
    assert found == [f"{other}:1: class A is defined in nxt_twin/a.py:1 already"]


def test_a_meant_name_that_no_two_rooms_share_is_to_go(house_names, tmp_path):
    found = findings(house_names, tmp_path, {"nxt_twin/blind/meant.py": ""})
    assert len(found) == len(house_names.MEANT)
    assert all("take it out of MEANT" in each for each in found)
