"""`changed` from end to end, on files."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import nxt_twin as nt
from nxt_twin.cli.app import program

pytestmark = pytest.mark.usefixtures("one_by_one")

COMMANDS = program(["changed"])


def run(*arguments):
    return CliRunner().invoke(COMMANDS, [str(each) for each in arguments])


@pytest.fixture
def table(tmp_path):
    """Writes a body of some inertia, pushed to and fro and held back by viscous friction."""

    def written(name, inertia):
        time_s = 0.02 * np.arange(250)
        force = 0.5 * np.sign(np.sin(2.0 * np.pi * 0.5 * time_s + 0.3 * np.sin(time_s)))
        speed, angle, angles = 0.0, 0.0, []
        for push in np.repeat(force, 20):
            angles.append(angle)
            speed += 1e-3 * (push - 0.2 * speed) / inertia
            angle += 1e-3 * speed
        rng = np.random.default_rng(1)
        read = np.array(angles)[::20] + 1e-3 * rng.standard_normal(250)
        rows = "".join(f"{t:.3f},{f:.3f},{a:.5f}\n" for t, f, a in zip(time_s, force, read, strict=True))
        path = tmp_path / name
        path.write_text("t,torque,angle\n" + rows)
        return path

    (tmp_path / "plant.yaml").write_text("{kind: rigid_body, inertia: 0.1, viscous_friction: 0.2}")
    (tmp_path / "map.yaml").write_text(
        "{table: {format: csv}, time: {column: t, unit: s}, input: {column: torque, kind: torque_nm},"
        " output: {column: angle, kind: position_rad}}"
    )
    return written


def test_the_answer_has_the_keys_of_a_diagnosis_and_what_changed(table, tmp_path):
    sides = [table("before.csv", 0.1), table("after.csv", 0.2)]
    stated = ("--mapping", tmp_path / "map.yaml", "--plant", tmp_path / "plant.yaml")
    found = run("changed", *sides, *stated, "--json", "-")
    assert found.exit_code == 0, found.output
    told = json.loads(found.stdout)
    assert told["schema"] == "nxt-twin/diagnosis/1"
    assert {"verdict", "refit", "mismatch", "effects", "alternatives", "fit", "tolerance"} <= told.keys()
    (change,) = told["changes"]
    assert {"of", "before", "after", "std", "probability"} <= change.keys()
    assert change["after"] / change["before"] == pytest.approx(2.0, rel=0.1)
    assert told["verdict"] == "changed"
    many = run(
        "changed", *sides, *sides[:1], *stated, "--json", tmp_path / "out", "--report", tmp_path / "pages"
    )
    assert "unchanged" in many.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "after.json",
        "before (3).json",
        "units.json",
    }
    units = json.loads((tmp_path / "out" / "units.json").read_text())
    assert (units["differs"], units["alike"]) == ({"after": ["inertia"]}, ["before (3)"])
    assert units["sentence"] in many.output.replace("\n", " ")
    assert {path.name for path in (tmp_path / "pages").iterdir()} == {"after.html", "before (3).html"}


def test_bad_input_ends_in_one_line(table, tmp_path):
    good = table("before.csv", 0.1)
    lacking = run("changed", good, tmp_path / "none.csv", "--mapping", tmp_path / "map.yaml")
    assert lacking.exit_code != 0
    assert run("changed", good).exit_code == 2
    assert run("changed", good, good, "--tolerance", "2 apples").exit_code == 2


def test_a_case_with_recordings_from_before_is_compared_by_diagnose(table, tmp_path):
    table("before.csv", 0.1)
    table("after.csv", 0.2)
    (tmp_path / "case.yaml").write_text(
        "{plant: plant.yaml, mapping: map.yaml, recordings: [after.csv], before: [before.csv]}"
    )
    found = CliRunner().invoke(program(["diagnose"]), ["diagnose", str(tmp_path), "--json", "-"])
    told = json.loads(found.stdout)
    assert (told["verdict"], [change["of"] for change in told["changes"]]) == ("changed", ["inertia"])
    in_python = nt.find_missing_physics(tmp_path)
    assert repr(in_python) == f"<Changes before → {tmp_path.name}: changed in inertia>"
    assert in_python.plant.to_config()["inertia"] == pytest.approx(in_python.changes[0].after, rel=1e-6)
    (tmp_path / "case.yaml").write_text(
        "{plant: plant.yaml, mapping: map.yaml, recordings: [after.csv], before: [after.csv]}"
    )
    twice = CliRunner().invoke(program(["diagnose"]), ["diagnose", str(tmp_path)])
    assert twice.exit_code == 1
