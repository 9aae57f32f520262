"""`nxt-twin blind`."""

import json

import pytest
from cli_program import run, succeed

TINY = (
    "--clean",
    "1",
    "--pairs",
    "0",
    "--triples",
    "0",
    "--unknown",
    "0",
    "--duration",
    "5",
    "--link",
    "usb",
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folders of cases and of answers: gravity in three sizes, and a clean one."""
    root = tmp_path_factory.mktemp("blind")
    said = succeed(
        "blind", "make", root / "cases", root / "answers", "--effects", "gravity_load", "--seed", "3", *TINY
    )
    assert "4 cases" in said.out
    return root


def names(folder):
    return sorted(path.stem for path in folder.iterdir())


def test_each_case_has_its_recordings_its_seal_and_elsewhere_its_answer(made):
    assert names(made / "cases") == names(made / "answers")
    for case in (made / "cases").iterdir():
        held = {path.name for path in case.iterdir()}
        assert {"case.yaml", "answer.sha256", "r1.csv"} <= held
        assert "gravity" not in "".join(path.read_text() for path in case.iterdir())


@pytest.mark.slow
def test_the_same_seed_makes_the_same_set(made, tmp_path):
    again = (
        "blind",
        "make",
        tmp_path / "cases",
        tmp_path / "answers",
        "--effects",
        "gravity_load",
        "--seed",
        "3",
    )
    succeed(*again, *TINY)
    for name in names(made / "cases"):
        for file in ("case.yaml", "r1.csv", "answer.sha256"):
            assert (tmp_path / "cases" / name / file).read_bytes() == (
                made / "cases" / name / file
            ).read_bytes()


def test_what_is_solved_is_scored_against_the_answers(made, tmp_path):
    diagnoses = tmp_path / "diagnoses"
    diagnoses.mkdir()
    clean = []
    for path in (made / "answers").iterdir():
        hidden = [effect["id"] for effect in json.loads(path.read_text())["effects"]]
        clean += [] if hidden else [path.stem]
        effects = [{"id": i, "params": {}, "confusable_with": []} for i in hidden]
        answer = {
            "verdict": "explained" if hidden else "adequate",
            "effects": effects,
            "refit": {},
            "fit": {"baseline": 9.0, "improved": 1.0, "floor": 0.5},
        }
        (diagnoses / path.name).write_text(json.dumps({"schema": "nxt-twin/diagnosis/1", **answer}))
    assert len(clean) == 1
    (diagnoses / f"{clean[0]}.json").unlink()
    solved = succeed("blind", "solve", made / "cases", diagnoses)
    assert "4 cases" in solved.out
    assert json.loads((diagnoses / f"{clean[0]}.json").read_text())["verdict"] == "adequate"
    table = tmp_path / "table.json"
    said = succeed("blind", "score", made / "cases", made / "answers", diagnoses, "--json", table)
    assert "3/3" in said.out
    rows = {row["group"]: row for row in json.loads(table.read_text())["rows"]}
    assert rows["gravity_load"]["exact"]["count"] == rows["gravity_load"]["cases"] == 3
    assert rows["clean"]["exact"]["count"] == 1
    only = succeed("blind", "score", made / "cases", made / "answers", diagnoses, "--json").json()
    assert only["rows"] == list(rows.values())


def test_a_changed_answer_is_found_out(made, tmp_path):
    answers = tmp_path / "answers"
    answers.mkdir()
    for path in (made / "answers").iterdir():
        (answers / path.name).write_text(path.read_text().replace("0.", "1.", 1))
    outcome = run("blind", "score", made / "cases", answers, tmp_path)
    assert outcome.status == 1
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize(
    ("option", "value", "status"), [("--effects", "levitation", 1), ("--link", "smoke", 2)]
)
def test_an_effect_or_link_that_nobody_knows_is_refused(tmp_path, option, value, status):
    outcome = run("blind", "make", tmp_path / "c", tmp_path / "a", *TINY, option, value)
    assert outcome.status == status
    assert value in outcome.err


def test_pairs_without_effects_are_refused_in_one_line(tmp_path):
    folders = (tmp_path / "c", tmp_path / "a")
    outcome = run("blind", "make", *folders, "--effects", "none", "--pairs", "4", "--triples", "0")
    assert outcome.status == 1
    assert outcome.err.count("\n") == 1
    assert "--pairs 0" in outcome.err
    assert not any(folder.exists() for folder in folders)


def test_a_proof_without_a_finished_case_says_what_to_do(tmp_path):
    said = run("blind", "proof", tmp_path / "none", "--minutes", "0")
    assert said.status == 1
    assert "none: holds no finished case of the range sample (give it more --minutes)" in said.err
    assert not (tmp_path / "none").exists()
