"""What the true structure reaches, the aims, and the whole benchmark by one command."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from nxt_twin.blind.aims import DETECTABLE_NATS, Aim, aims_of, as_text, is_detectable, shows_each
from nxt_twin.blind.effects.library import UNKNOWN_EFFECTS
from nxt_twin.blind.make import make_case, write_case
from nxt_twin.blind.reach import likelier, reach
from nxt_twin.blind.reached import Reach, reached
from nxt_twin.blind.solve import reach_all, solve_all
from nxt_twin.blind.verdict import Judged
from nxt_twin.fleet.workers.place import Here
from nxt_twin.recording.case import read_case


def judged(
    kind="single", *, exact=True, holds=True, misnamed=False, considered=("stiction",), reach=None, **more
):
    known = {
        "name": "case",
        "hidden": ("stiction",),
        "sizes": ("small",),
        "effect_rms_deg": 5.0,
        "verdict": "explained",
        "named": ("stiction",),
        "parameter_error": {},
        "parameter_error_own": {},
        "covered": {},
        "fit_ratio": None,
        "improved": None,
    }
    return Judged(
        kind=kind, exact=exact, holds=holds, misnamed=misnamed, considered=frozenset(considered), reach=reach,
        **{**known, **more},
    )  # fmt: skip


def aim(cases, words) -> Aim:
    return next(one for one in aims_of(cases) if one.words.startswith(words))


def test_only_detectable_singles_count():
    seen = judged(reach=Reach(50.0, 5.0, 1.0))
    hidden = judged(exact=False, reach=Reach(2.0, 0.1, 1.0))
    unreached = judged(exact=False)
    assert [is_detectable(case) for case in (seen, hidden, unreached)] == [True, False, False]
    exact = aim([seen, hidden, unreached], "single, detectable: exact")
    assert (exact.measured, exact.cases, exact.met) == (1.0, 1, True)


def test_false_alarms_count_every_clean_case_that_is_not_called_adequate():
    cases = [judged("clean", exact=k > 0, verdict="adequate") for k in range(20)]
    alarms = aim(cases, "clean")
    assert alarms.measured == pytest.approx(0.05)
    assert not alarms.met


def test_the_free_run_is_compared_with_that_of_the_true_structure():
    cases = [judged(improved=1.1 * k, reach=Reach(50.0, 5.0, float(k))) for k in (1, 2, 3)]
    over = aim(cases, "free run")
    assert over.measured == pytest.approx(1.1)
    assert over.met


def test_an_aim_without_cases_is_neither_met_nor_missed():
    text = as_text(aims_of([judged("clean", verdict="adequate")]))
    pairs = next(line for line in text.splitlines() if line.startswith("pairs"))
    assert "no case" in pairs
    assert "MISSED" not in pairs


def test_cover_counts_exact_cases_only():
    cases = [judged(covered={"stiction": True})] * 9 + [judged(covered={"stiction": False})]
    assert (
        aim([*cases, judged(exact=False, covered={"stiction": False})], "main parameter within").measured
        == 0.9
    )


def test_the_true_structure_beats_the_baseline_where_something_is_hidden(tmp_path):
    case = make_case(11, effects=("stiction",), size="large", recordings=3, duration_s=8.0)
    folder = write_case(case, tmp_path / "cases", tmp_path / "answers")
    found = reach(read_case(folder), case.answer)
    assert found is not None
    assert found.gain_nats > DETECTABLE_NATS
    assert 0.0 < found.held_out_rmse < 20.0


@pytest.mark.parametrize(("other_cost", "counts"), [(98.9, "other"), (99.1, "usual"), (101.0, "usual")])
def test_of_two_fits_of_the_true_structure_the_likelier_counts(other_cost, counts):
    fits = {"usual": SimpleNamespace(fitted_cost=100.0), "other": SimpleNamespace(fitted_cost=other_cost)}
    assert likelier(**fits) is fits[counts]


def test_a_pair_tells_the_effect_that_its_data_do_not_show(tmp_path):
    """A winding that hardly warms, beside an arm: the pair gains much, and the winding nothing beside the arm."""
    both = ("winding_heating", "gravity_load")
    case = make_case(15, effects=both, size="small", recordings=3, duration_s=8.0)
    folder = write_case(case, tmp_path / "cases", tmp_path / "answers")
    found = reach(read_case(folder), case.answer)
    assert found is not None
    assert found.gain_nats > DETECTABLE_NATS
    assert found.each_gain_nats["gravity_load"] > DETECTABLE_NATS
    assert found.each_gain_nats["winding_heating"] < DETECTABLE_NATS
    assert not shows_each(judged("pair", hidden=both, reach=found))
    assert reached(found.as_dict()) == found


def test_a_stranger_cannot_be_reached(tmp_path):
    case = make_case(12, effects=(next(iter(UNKNOWN_EFFECTS)),), recordings=1, duration_s=8.0)
    folder = write_case(case, tmp_path / "cases", tmp_path / "answers")
    assert reach(read_case(folder), case.answer) is None


def test_what_is_solved_is_not_solved_again(tmp_path):
    case = make_case(13, effects=(), recordings=1, duration_s=8.0, name="one")
    folder = write_case(case, tmp_path / "cases", tmp_path / "answers")
    assert list(solve_all([folder], tmp_path / "out", seed=0, place=Here())) == [("one", "")]
    written = (tmp_path / "out" / "one.json").read_text()
    assert json.loads(written)["schema"] == "nxt-twin/diagnosis/1"
    assert list(solve_all([folder], tmp_path / "out", seed=0, place=Here())) == []
    assert list(reach_all([folder], tmp_path / "answers", tmp_path / "reached", place=Here())) == [
        ("one", "")
    ]
    held = json.loads((tmp_path / "reached" / "one.json").read_text())
    assert held["gain_nats"] == pytest.approx(0.0, abs=1e-6)
