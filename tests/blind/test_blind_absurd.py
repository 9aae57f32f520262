"""What no diagnosis may say: each sentence counts an answer on one side of its limit, and none on the other."""

import pytest

from nxt_twin.blind.absurd import SENTENCES, absurd_rows

IMPROBABLE, BEATEN, VAGUE, NOISE, LEAVES, WORSE, MOVED = range(len(SENTENCES))


def effect(probability=0.9, *, alike=(), std=0.1, ratio=None):
    size = {"value": 1.0, "std": std, "ratio": ratio}
    return {
        "id": "cogging",
        "probability": probability,
        "confusable_with": list(alike),
        "params": {"amplitude_nm": size},
    }


def answer(verdict="explained", *, at=None, **changed):
    whole = {"seconds": 2.0, "given": 9.0, "baseline": 9.0, "improved": 2.0, "floor": 1.0, **(at or {})}
    return {
        "verdict": verdict,
        "effects": [effect()],
        "alternatives": [],
        "fit": {"horizons": [whole]},
        "tolerance": {"value": 0.5},
        "notes": [],
        "refit": {},
        "sentence": "The model leaves out cogging.",
        **changed,
    }


def moved(to):
    return {"inertia_kg_m2": {"from": 1.0, "to": to}}


HANDED_ON = ["At some horizon …: the re-fitted baseline is handed on."]
AT_WORST = {"improved": 9.2, "floor": 9.0}


@pytest.mark.parametrize(
    ("number", "told", "counted"),
    [
        (IMPROBABLE, answer(effects=[effect(0.49)]), 1),
        (IMPROBABLE, answer(effects=[effect(0.51)]), 0),
        (IMPROBABLE, answer(effects=[effect(0.49, alike=[{"id": "stiction"}])]), 0),
        (IMPROBABLE, answer("unexplained", effects=[effect(0.49)]), 0),
        (BEATEN, answer(effects=[effect(0.02)], alternatives=[{"probability": 0.41}]), 1),
        (BEATEN, answer(effects=[effect(0.02)], alternatives=[{"probability": 0.39}]), 0),
        (VAGUE, answer(effects=[effect(std=0.26)]), 1),
        (VAGUE, answer(effects=[effect(std=0.25)]), 0),
        (VAGUE, answer(effects=[effect(std=9.0, ratio={"value": 1.0, "std": 0.25})]), 0),
        (NOISE, answer(false_alarm_rate={"rate": 0.015}), 1),
        (NOISE, answer(false_alarm_rate={"rate": 0.01}), 0),
        (NOISE, answer(), 0),
        (LEAVES, answer(at={"improved": 5.1}), 1),
        (LEAVES, answer(at={"improved": 4.9}), 0),
        (LEAVES, answer(at={"improved": 5.1}, tolerance={"value": 5.2}), 0),
        (LEAVES, answer("unexplained", at={"improved": 5.1}), 0),
        (WORSE, answer(at=AT_WORST), 1),
        (WORSE, answer(at=AT_WORST, notes=HANDED_ON), 0),
        (WORSE, answer(at={**AT_WORST, "improved": 9.17}), 0),
        (WORSE, answer(at={**AT_WORST, "seconds": None}), 0),
        (WORSE, answer(at={**AT_WORST, "seconds": None, "improved": 9.91}), 1),
        (WORSE, answer(at={**AT_WORST, "given": 3.0, "improved": 3.1}), 1),
        (WORSE, answer(at=AT_WORST, tolerance={"value": 9.3}), 0),
        (MOVED, answer(refit=moved(3.1)), 1),
        (MOVED, answer(refit=moved(2.9)), 0),
        (MOVED, answer("adequate", refit=moved(0.32)), 1),
        (MOVED, answer(refit=moved(11.0), sentence="The re-fit moved inertia to 11 kg·m²."), 0),
        (MOVED, answer(refit=moved(3.1), notes=["The re-fit moved inertia to 3.1 kg·m²."]), 1),
        (MOVED, answer("unexplained", refit=moved(3.1)), 0),
    ],
)
def test_an_answer_is_counted_where_it_says_what_none_may_say(number, told, counted):
    row = absurd_rows([("stiff", told)])[1 + number]
    assert row[0] == SENTENCES[number].words
    assert row[1].split(" of ")[0] == str(counted)


def test_answers_are_counted_by_family_and_over_all():
    rows = absurd_rows([("stiff", answer()), ("mujoco", answer(effects=[effect(0.4)])), ("stiff", answer())])
    assert rows[0] == ("", "mujoco", "stiff", "all")
    assert rows[1 + IMPROBABLE][1:] == ("1 of 1", "0 of 2", "1 of 3")
