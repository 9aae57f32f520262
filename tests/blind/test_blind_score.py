from __future__ import annotations

import json
import re

import pytest

from nxt_twin.blind.answer import encoded, seal
from nxt_twin.blind.case import NOMINAL, SEAL_FILE
from nxt_twin.blind.score import score
from nxt_twin.blind.share import Share
from nxt_twin.errors import CaseError


def effect(effect_id, *, size="medium", known=True, **params):
    return {"id": effect_id, "known": known, "size": size, "main": next(iter(params)), "params": params}


def found(effect_id, confusable=(), **params):
    return {
        "id": effect_id,
        "name": effect_id,
        "equation": "",
        "params": {name: {"value": value, "std": 0.0, "unit": ""} for name, value in params.items()},
        "probability": 0.9,
        "confusable_with": [{"id": other, "why": ""} for other in confusable],
    }


@pytest.fixture
def bench(tmp_path):
    """Write a case's answer and diagnosis by hand: `bench(name, hidden, verdict, named)`; `bench.score()`."""

    class Bench:
        def __call__(
            self,
            name,
            hidden,
            verdict=None,
            named=(),
            *,
            rms_deg=5.0,
            refit=None,
            floor=0.5,
            mismatch=None,
            others=(),
        ):
            answer = encoded(
                {
                    "case": name,
                    "effects": list(hidden),
                    "effect_rms_deg": rms_deg,
                    "base": {**NOMINAL, "inertia_kg_m2": 1.0e-3},
                    "baseline": dict(NOMINAL),
                    "salt": name,
                }
            )
            for folder in ("answers", "diagnoses", f"cases/{name}"):
                (tmp_path / folder).mkdir(parents=True, exist_ok=True)
            (tmp_path / "answers" / f"{name}.json").write_bytes(answer)
            (tmp_path / "cases" / name / SEAL_FILE).write_text(seal(answer) + "\n")
            if verdict:
                diagnosis = {
                    "schema": "nxt-twin/diagnosis/1",
                    "verdict": verdict,
                    "refit": refit or {},
                    "effects": list(named),
                    "alternatives": [{"id": other} for other in others],
                    "mismatch": mismatch
                    or {"channel": "a_tacho_deg", "when": [], "regimes": [], "equation": None},
                    "fit": {"baseline": 9.0, "improved": 1.0, "floor": floor},
                }
                (tmp_path / "diagnoses" / f"{name}.json").write_text(json.dumps(diagnosis))

        @staticmethod
        def score():
            return score(tmp_path / "cases", tmp_path / "answers", tmp_path / "diagnoses")

    return Bench()


def test_the_set_holds_what_an_adequate_answer_tells_as_left_out(bench):
    hidden = [effect("shaft_compliance", stiffness_nm_per_rad=1.0)]
    bench("told", hidden, "adequate", others=["shaft_compliance"])
    bench("silent", hidden, "adequate")
    bench("other", hidden, "explained", [found("backlash")], others=["shaft_compliance"])
    holds = {case.name: case.holds for case in bench.score().cases}
    assert holds == {"told": True, "silent": False, "other": False}


def test_a_single_effect_is_exact_only_when_named_alone(bench):
    hidden = [effect("stiction", breakaway_torque_nm=0.03)]
    bench("right", hidden, "explained", [found("stiction", breakaway_torque_nm=0.036)])
    bench("more", hidden, "explained", [found("stiction"), found("backlash")])
    bench("alike", hidden, "explained", [found("presliding", confusable=["stiction"])])
    bench("wrong", hidden, "explained", [found("backlash")])
    bench("blind", hidden, "adequate")
    bench("silent", hidden)
    row = bench.score().row("single")
    assert (row.exact.count, row.exact.of) == (1, 6)
    assert row.holds.count == 3
    assert row.misnamed.count == 2
    assert row.missed.count == 1
    assert row.set_size == pytest.approx((1 + 2 + 2 + 1) / 4)
    assert row.parameter_error == pytest.approx(0.2)
    assert row.fit_ratio == pytest.approx(2.0)
    assert bench.score().row("stiction").exact.of == 6


def test_torques_are_also_compared_relative_to_the_motors_inertia(bench):
    hidden = [effect("constant_load", load_torque_nm=0.02)]
    named = [found("constant_load", load_torque_nm=0.024)]
    bench(
        "scaled",
        hidden,
        "explained",
        named,
        refit={"inertia_kg_m2": {"from": 1.2e-3, "to": 1.2e-3, "std": 0}},
    )
    row = bench.score().row("single")
    assert row.parameter_error == pytest.approx(0.2)
    assert row.parameter_error_own == pytest.approx(0.0, abs=1e-12)


def test_clean_cases_count_false_alarms(bench):
    bench("quiet", [], "adequate", rms_deg=0.0)
    bench("alarm", [], "explained", [found("stiction")], rms_deg=0.0)
    bench("doubt", [], "unexplained", rms_deg=0.0)
    row = bench.score().row("clean")
    assert (row.exact.count, row.misnamed.count) == (1, 1)


def test_pairs_and_triples_need_every_name(bench):
    pair = [effect("stiction", breakaway_torque_nm=0.03), effect("command_delay", delay_s=0.02)]
    triple = [*pair, effect("backlash", gap_deg=5.0)]
    bench("pair", pair, "explained", [found("command_delay"), found("stiction")])
    bench("half", pair, "explained", [found("stiction")])
    bench("triple", triple, "explained", [found("stiction"), found("command_delay"), found("backlash")])
    table = bench.score()
    assert (table.row("pair").exact.count, table.row("pair").exact.of) == (1, 2)
    assert table.row("pair").misnamed.count == 0
    assert table.row("triple").exact.count == 1


def test_an_unknown_effect_must_be_refused(bench):
    hidden = [effect("resonant_fan", known=False, surprise_a=1e-4)]
    bench("refused", hidden, "unexplained", [found("quadratic_drag")])
    bench("fooled", hidden, "explained", [found("quadratic_drag")])
    row = bench.score().row("unknown")
    assert (row.exact.count, row.misnamed.count) == (1, 1)


def test_results_are_binned_by_size_and_by_how_far_the_effect_moves_the_encoder(bench):
    bench("faint", [effect("stiction", size="small", breakaway_torque_nm=0.03)], "adequate", rms_deg=0.4)
    bench("plain", [effect("stiction", size="large", breakaway_torque_nm=0.03)], "explained", rms_deg=50.0)
    table = bench.score()
    assert table.row("single, effect 0–1°").missed.count == 1
    assert table.row("single, effect 30–100°").missed.count == 0
    assert table.row("single, small").exact.of == 1


def test_an_answer_changed_after_sealing_is_refused(bench, tmp_path):
    bench("case", [], "adequate")
    path = tmp_path / "answers" / "case.json"
    path.write_bytes(path.read_bytes() + b" ")
    with pytest.raises(CaseError, match="not the answer that was sealed"):
        bench.score()


def test_a_case_without_seal_is_refused(bench, tmp_path):
    bench("case", [], "adequate")
    (tmp_path / "cases" / "case" / SEAL_FILE).unlink()
    with pytest.raises(CaseError, match="cannot be read"):
        bench.score()


@pytest.mark.parametrize("text", ["{", "[]", '{"verdict": "adequate"}'])
def test_a_file_that_is_no_diagnosis_is_refused_by_name(bench, tmp_path, text):
    bench("case", [], "adequate")
    (tmp_path / "diagnoses" / "case.json").write_text(text)
    with pytest.raises(CaseError, match=r"case\.json"):
        bench.score()


def test_an_empty_answers_folder_is_refused(tmp_path):
    with pytest.raises(CaseError, match="holds no answers"):
        score(tmp_path, tmp_path, tmp_path)


def test_a_floor_that_is_not_known_leaves_the_fit_ratio_out(bench):
    bench("case", [], "adequate", floor=None)
    assert bench.score().row("clean").fit_ratio is None


def test_wilson_interval_of_nine_in_ten():
    low, high = Share(9, 10).interval
    assert low == pytest.approx(0.5958, abs=1e-4)
    assert high == pytest.approx(0.9821, abs=1e-4)
    assert Share(0, 0).interval == (0.0, 1.0)


def test_table_goes_out_as_text_and_as_json(bench):
    bench("case", [effect("stiction", breakaway_torque_nm=0.03)], "explained", [found("stiction")])
    table = bench.score()
    assert "stiction" in table.as_text()
    assert "1/1 [21–100 %]" in table.as_text()
    values = json.loads(json.dumps(table.as_dict()))
    assert values["cases"][0]["exact"] is True
    assert values["rows"][0]["exact"]["count"] == 1


def test_the_table_defines_each_of_its_columns(bench):
    bench("case", [effect("stiction", breakaway_torque_nm=0.03)], "explained", [found("stiction")])
    head, *rest = bench.score().as_text().splitlines()
    titles = re.split(r"\s{2,}", head)[1:]
    defined = [line for line in rest if re.match(r"\w[\w ,]*? {2,}\w", line)]
    for title in titles:
        assert any(title in re.split(r" {2,}|, ", line) for line in defined), title
