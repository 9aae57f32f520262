"""`nxt-twin diagnose`."""

import json
from pathlib import Path

import pytest
import yaml
from cli_program import run, succeed


def number(value):
    return isinstance(value, int | float) and not isinstance(value, bool)


def assert_is_a_diagnosis(answer):
    """Keys and types of a diagnosis, as docs/formats.md#diagnosis-json writes them."""
    assert answer["schema"] == "nxt-twin/diagnosis/1"
    assert answer["verdict"] in ("adequate", "explained", "unexplained")
    assert answer["refit"]
    for moved in answer["refit"].values():
        assert all(number(moved[key]) for key in ("from", "to", "std"))
    mismatch = answer["mismatch"]
    assert isinstance(mismatch["channel"], str)
    for spell in mismatch["when"]:
        assert isinstance(spell["recording"], str)
        assert spell["start_s"] <= spell["end_s"]
        assert number(spell["strength"])
    for regime in mismatch["regimes"]:
        assert isinstance(regime["regime"], str)
        assert number(regime["strength"])
        assert 0.0 <= regime["p_value"] <= 1.0
    assert mismatch["equation"] in ("torque_balance", "electrical", "measurement", "timing", None)
    for effect in answer["effects"]:
        assert all(isinstance(effect[key], str) for key in ("id", "name", "equation"))
        assert 0.0 <= effect["probability"] <= 1.0
        for param in effect["params"].values():
            assert number(param["value"])
            assert number(param["std"])
            assert isinstance(param["unit"], str)
        for other in effect["confusable_with"]:
            assert all(isinstance(other[key], str) for key in ("id", "why"))
    for other in answer["alternatives"]:
        assert isinstance(other["id"], str)
        assert 0.0 <= other["probability"] <= 1.0
        assert number(other["holdout_rmse"])
    fit = answer["fit"]
    assert fit["metric"] == "free-run RMSE, held-out"
    assert isinstance(fit["unit"], str)
    assert all(fit[key] >= 0.0 for key in ("baseline", "improved", "floor"))
    following = answer["next_experiment"]
    assert following is None or all(isinstance(following[key], str) for key in ("why", "input"))


def test_the_json_is_as_documented_and_names_what_was_concealed(diagnosed):
    answer = json.loads(diagnosed.json.read_text(encoding="utf-8"))
    assert_is_a_diagnosis(answer)
    assert answer["verdict"] == "explained"
    assert [effect["id"] for effect in answer["effects"]] == ["coulomb_friction"]
    assert answer["effects"][0]["params"]["coulomb_friction_nm"]["unit"] == "N·m"
    assert answer["fit"]["unit"] == "deg"
    assert answer["fit"]["improved"] < answer["fit"]["baseline"]
    assert answer["mismatch"]["channel"] == "a_tacho_deg"
    assert answer["mismatch"]["when"]
    assert all(spell["recording"] == "r1.csv" for spell in answer["mismatch"]["when"])


def test_a_person_is_told_the_verdict_the_effect_and_where_the_report_is(diagnosed):
    said = diagnosed.outcome.out
    assert "friction: explained" in said
    assert "Coulomb friction" in said
    assert "coulomb_friction_nm = " in said
    assert f"report: {diagnosed.report / 'friction.html'}" in said
    assert diagnosed.outcome.err == ""


def test_the_model_is_a_plant_that_predicts_better_than_the_baseline(diagnosed, cases, tmp_path):
    model = yaml.safe_load(diagnosed.model.read_text(encoding="utf-8"))
    assert model["kind"] == "dc_motor"
    assert model["coulomb_friction_nm"] > 0.0
    baseline = tmp_path / "baseline.yaml"
    baseline.write_text(
        yaml.safe_dump(yaml.safe_load((cases["friction"] / "case.yaml").read_text())["plant"])
    )
    recording = cases["friction"] / "r1.csv"
    improved, before = (
        succeed("simulate", plant, recording, "--restart-every", "2", "--json", "-").json()["errors"][0][
            "rmse"
        ]
        for plant in (diagnosed.model, baseline)
    )
    assert improved < 0.5 * before


def test_the_report_is_a_page_that_says_the_same(diagnosed):
    pages = list(diagnosed.report.iterdir())
    assert [page.name for page in pages] == ["friction.html"]
    text = pages[0].read_text(encoding="utf-8")
    assert text.lower().startswith("<!doctype html>")
    assert "Coulomb friction" in text


def test_json_on_standard_output_is_all_that_is_there_and_each_time_the_same(cases):
    said, again = (
        succeed("diagnose", cases["clean"], "--json", "-"),
        succeed("diagnose", cases["clean"], "--json"),
    )
    answer = said.json()
    assert_is_a_diagnosis(answer)
    assert answer["verdict"] == "adequate"
    assert answer["effects"] == []
    assert answer["mismatch"]["when"] == []
    assert answer["next_experiment"] is None
    assert again.out == said.out
    assert said.err == again.err == ""


def test_several_cases_are_diagnosed_by_themselves_whatever_becomes_of_one(cases, tmp_path):
    folder, models = tmp_path / "answers", tmp_path / "models"
    nowhere = tmp_path / "nowhere"
    outcome = run(
        "diagnose", cases["clean"], nowhere, cases["friction"], "--json", folder, "--model-out", models
    )
    assert outcome.status == 1
    assert outcome.err.startswith(f"nxt-twin: {nowhere}")
    assert outcome.err.count("\n") == 1
    verdicts = {
        path.name: json.loads(path.read_text(encoding="utf-8"))["verdict"] for path in folder.iterdir()
    }
    assert verdicts == {"clean.json": "adequate", "friction.json": "explained"}
    assert sorted(path.name for path in models.iterdir()) == ["clean.yaml", "friction.yaml"]
    assert "clean: adequate" in outcome.out
    assert "friction: explained" in outcome.out


def test_a_recording_alone_is_a_case_about_the_plant_its_sidecar_names(cases, tmp_path):
    recording = tmp_path / "alone.csv"
    recording.write_bytes((cases["clean"] / "r1.csv").read_bytes())
    keys = yaml.safe_load((cases["clean"] / "case.yaml").read_text())["plant"]
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump({**keys, "inertia_kg_m2": 1.25e-3}))
    recording.with_suffix(".yaml").write_text("plant: mine.yaml\n")
    answer = succeed("diagnose", recording, "--json", "-").json()
    assert answer["refit"]["inertia_kg_m2"]["from"] == pytest.approx(1.25e-3)


@pytest.mark.parametrize(
    ("case_yaml", "complaint"),
    [
        ("plant: nxt_motor\nrecordings: [gone.csv]\n", "gone.csv"),
        ("plant: nxt_motr\nrecordings: [r1.csv]\n", "nxt_motr"),
        ("plant: {kind: dc_motor}\nrecordings: [r1.csv]\n", "is missing"),
        ("recordings: [r1.csv]\n", "plant"),
        ("plant: [\n", "YAML"),
    ],
)
def test_a_case_that_is_none_is_refused_in_one_line(cases, tmp_path, case_yaml, complaint):
    (tmp_path / "case.yaml").write_text(case_yaml)
    (tmp_path / "r1.csv").write_bytes((cases["clean"] / "r1.csv").read_bytes())
    outcome = run("diagnose", tmp_path, "--json", "-")
    assert outcome.status == 1
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert complaint in outcome.err


def test_a_motor_that_never_moves_is_refused(tmp_path):
    rows = "\n".join(f"{0.01 * k:.2f},50,0" for k in range(500))
    recording = tmp_path / "still.csv"
    recording.write_text(f"time_s,a_power_pct,a_tacho_deg\n{rows}\n")
    outcome = run("diagnose", recording)
    assert outcome.status == 1
    assert "nothing moves" in outcome.err


def keys_of(value, parent=""):
    """Every key of a JSON value, but for names of parameters and settings of a motor program."""
    if isinstance(value, dict):
        for key, inside in value.items():
            if parent not in ("refit", "params"):
                yield key
            if key != "program":
                yield from keys_of(inside, key)
    elif isinstance(value, list):
        for inside in value:
            yield from keys_of(inside, parent)


def test_every_key_of_the_json_stands_on_the_page_of_formats(diagnosed):
    page = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    section = page.split("\n## Diagnosis JSON\n")[1].split("\n## ")[0]
    answer = json.loads(diagnosed.json.read_text(encoding="utf-8"))
    assert {key for key in keys_of(answer) if f"`{key}`" not in section} == set()
