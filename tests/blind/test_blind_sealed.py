"""Cases that somebody else's simulator made: their truths are sealed, and scored as ours are."""

import json
from pathlib import Path
from textwrap import dedent

import pytest
import yaml
from typer.testing import CliRunner

from nxt_twin.blind.case import NOMINAL, SEAL_FILE
from nxt_twin.blind.score import score
from nxt_twin.blind.sealed import seal_cases
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.cli.blind import blind
from nxt_twin.errors import CaseError

ROWS = "time_s,a_power_pct,a_tacho_deg\n0.0,50,0\n0.1,50,3\n0.2,50,9\n"
LOAD = {"id": "constant_load", "params": {"load_torque_nm": 0.02}, "size": "large"}


@pytest.fixture
def stranger(tmp_path):
    """A function that makes one case with its truth; it returns the folders of cases, truths and answers."""
    folders = tmp_path / "cases", tmp_path / "truths", tmp_path / "answers"

    def made(truth, name="one", suffix="yaml"):
        case, truths, _ = folders[0] / name, folders[1], folders[2]
        case.mkdir(parents=True)
        truths.mkdir(exist_ok=True)
        (case / "r.csv").write_text(ROWS)
        (case / "case.yaml").write_text(
            yaml.safe_dump({"plant": {"kind": "dc_motor", **NOMINAL}, "recordings": ["r.csv"]})
        )
        (truths / f"{name}.{suffix}").write_text(json.dumps(truth))
        return folders

    return made


def diagnosis(verdict, *names):
    effects = [
        {"id": name, "params": {"load_torque_nm": {"value": 0.03, "std": 0.001}}, "confusable_with": []}
        for name in names
    ]
    fit = {"improved": 1.0, "floor": 1.0, "horizons": []}
    return json.dumps({"verdict": verdict, "effects": effects, "fit": fit, "refit": {}, "mismatch": {}})


@pytest.mark.parametrize("suffix", ["yaml", "json"])
def test_a_sealed_truth_is_scored_under_its_simulators_name(stranger, suffix, tmp_path):
    truth = {"family": "theirs", "effects": [LOAD], "motor": {"inertia_kg_m2": 2.4e-3}}
    cases, truths, answers = stranger(truth, suffix=suffix)
    done = CliRunner().invoke(blind, ["seal", str(cases), str(truths), str(answers)])
    assert done.exit_code == 0, done.output
    assert "1 of 1 cases sealed" in done.output
    given = tmp_path / "given"
    given.mkdir()
    (given / "one.json").write_text(diagnosis("explained", "constant_load"))
    (case,) = score(cases, answers, given).cases
    assert (case.family, case.kind, case.exact, case.sizes) == ("theirs", "single", True, ("large",))
    assert case.parameter_error["constant_load"] == pytest.approx(0.5)
    assert case.parameter_error_own["constant_load"] == pytest.approx(
        2.0
    )  # half the true inertia is believed


def test_physics_of_nobodys_library_has_to_be_refused(stranger, tmp_path):
    cases, truths, answers = stranger({"effects": [{"id": "freewheel", "known": False}]})
    seal_cases([cases / "one"], truths, answers)
    given = tmp_path / "given"
    given.mkdir()
    (given / "one.json").write_text(diagnosis("unexplained"))
    (case,) = score(cases, answers, given).cases
    assert (case.kind, case.exact) == ("unknown", True)


def test_a_clean_case_hides_nothing_and_a_changed_answer_is_refused(stranger):
    cases, truths, answers = stranger({})
    seal_cases([cases / "one"], truths, answers)
    answer = answers / "one.json"
    assert read_sealed(answer, cases / "one")["effects"] == []
    answer.write_text(answer.read_text().replace("another", "other"))
    with pytest.raises(CaseError, match="not the answer that was sealed"):
        read_sealed(answer, cases / "one")


def test_two_answers_with_one_content_have_seals_of_their_own(stranger):
    cases, truths, answers = stranger({}, "one")
    stranger({}, "two")
    for name in ("one", "two"):
        seal_cases([cases / name], truths, answers)
    one, two = (json.loads((answers / f"{name}.json").read_text())["salt"] for name in ("one", "two"))
    assert one != two


@pytest.mark.parametrize(
    ("truth", "told"),
    [
        ({"effects": [{"id": "constant_lode"}]}, "the library has no effect constant_lode"),
        ({"effects": [{"id": "constant_load", "size": "huge"}]}, "key effects.0.size"),
        ({"effect": []}, "key effect"),
        ({"motor": {"inertia": 1.0}}, "a motor has no inertia"),
    ],
)
def test_a_wrong_truth_is_one_line_and_seals_nothing(stranger, truth, told):
    cases, truths, answers = stranger(truth)
    with pytest.raises(CaseError, match=told) as failure:
        seal_cases([cases / "one"], truths, answers)
    assert "one.yaml" in str(failure.value)
    assert not (cases / "one" / SEAL_FILE).exists()
    assert not answers.exists()


def test_a_missing_truth_two_truths_and_a_second_seal_are_refused(stranger):
    cases, truths, answers = stranger({})
    (truths / "one.json").write_text("{}")
    with pytest.raises(CaseError, match="hold only one"):
        seal_cases([cases / "one"], truths, answers)
    (truths / "one.json").rename(truths / "other.json")
    assert seal_cases([cases / "one"], truths, answers) == 1
    assert seal_cases([cases / "one"], truths, answers) == 0
    with pytest.raises(CaseError, match="has a seal, and no answer"):
        seal_cases([cases / "one"], truths, truths / "elsewhere")
    (truths / "one.yaml").unlink()
    (cases / "one" / SEAL_FILE).unlink()
    with pytest.raises(CaseError, match="has to hold one"):
        seal_cases([cases / "one"], truths, answers)


def test_a_folder_without_cases_is_refused(tmp_path):
    done = CliRunner().invoke(blind, ["seal", *[str(tmp_path)] * 3])
    assert isinstance(done.exception, CaseError)
    assert "holds no case" in str(done.exception)


def test_the_page_shows_a_truth_that_can_be_sealed(stranger):
    page = (Path(__file__).parents[2] / "docs" / "proof.md").read_text(encoding="utf-8")
    text = page[page.index("    family: my_simulator") :].split("\n\n")[0]
    cases, truths, answers = stranger({})
    (truths / "one.yaml").write_text(dedent(text))
    seal_cases([cases / "one"], truths, answers)
    answer = read_sealed(answers / "one.json", cases / "one")
    assert [(one["id"], one["known"]) for one in answer["effects"]] == [
        ("stiction", True),
        ("my_clutch", False),
    ]
    assert answer["base"]["inertia_kg_m2"] == 0.0011


def test_one_wrong_truth_seals_no_case(stranger):
    cases, truths, answers = stranger({}, "one")
    stranger({"effects": [{"id": "constant_lode"}]}, "two")
    with pytest.raises(CaseError, match="constant_lode"):
        seal_cases([cases / "one", cases / "two"], truths, answers)
    assert not (cases / "one" / SEAL_FILE).exists()
    assert not answers.exists()


def test_a_plant_whose_number_is_a_word_is_one_line(stranger):
    cases, truths, answers = stranger({})
    file = cases / "one" / "case.yaml"
    file.write_text(file.read_text().replace("inertia_kg_m2: 0.0012", "inertia_kg_m2: heavy"))
    with pytest.raises(CaseError, match=r"inertia_kg_m2: 'heavy' is no number"):
        seal_cases([cases / "one"], truths, answers)
