"""Effects that readings speak for, and that an answer without a missing effect tells as left out."""

import math
from types import SimpleNamespace

import pytest

from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.diagnose.telling import findings, words
from nxt_twin.diagnose.telling.calibration import LEFT_OUT
from nxt_twin.diagnose.telling.findings import alternatives, too_weak

TWIST, DRAG = (SimpleNamespace(id=name, name=name) for name in ("shaft_compliance", "quadratic_drag"))
SPEAKS = Weight(gain=8.1, check_gain=2.1, free_run_ratio=1.0, runs_worse=False)


def evidence(*refused, needless=()):
    explanation = SimpleNamespace(refused=refused, rivals={})
    return SimpleNamespace(
        explanation=explanation, needless=needless, units=SimpleNamespace(reading_factor=math.degrees(1.0))
    )


def refused(weight, effect=DRAG):
    return effect, weight, SimpleNamespace(plant=None)


@pytest.mark.parametrize(
    ("weight", "verdict", "told"),
    [
        (SPEAKS, "adequate", True),
        (SPEAKS, "unexplained", False),
        (SPEAKS, "explained", False),
        (Weight(8.0, 2.1, 1.0, runs_worse=False), "adequate", False),
        (Weight(8.1, 2.0, 1.0, runs_worse=False), "adequate", False),
    ],
)
def test_what_readings_speak_for_is_told_where_nothing_is_missing(weight, verdict, told):
    assert bool(too_weak(evidence(refused(weight)), verdict)) is told


def test_what_is_left_out_is_listed_with_the_error_of_the_plant_that_has_it(monkeypatch):
    monkeypatch.setattr(findings, "_runs", lambda *_: "runs")
    monkeypatch.setattr(findings, "overall", lambda _: math.radians(3.0))
    needless = (SimpleNamespace(effect=TWIST, rms=math.radians(2.0)),)
    held = evidence(refused(SPEAKS), refused(SPEAKS, TWIST), needless=needless)
    listed = [
        (one.id, one.probability, round(one.holdout_rmse, 6)) for one in alternatives(None, held, "adequate")
    ]
    assert listed == [("shaft_compliance", LEFT_OUT, 2.0), ("quadratic_drag", LEFT_OUT, 3.0)]
    assert alternatives(None, held, "explained") == ()


def test_the_sentence_names_what_readings_speak_for():
    assert words.too_weak([]) == ()
    (one,) = words.too_weak(["quadratic drag"])
    assert one.startswith("Readings speak for quadratic drag")
    assert one.endswith("to call it missing.")
    (two,) = words.too_weak(["quadratic drag", "cogging"])
    assert "quadratic drag and cogging" in two
    assert "call them missing" in two
