import math

import pytest
from diagnose_cases import concealed

from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.tolerance import parse_tolerance
from nxt_twin.errors import DiagnosisError


@pytest.mark.parametrize(
    ("text", "si"),
    [
        ("2deg", math.radians(2.0)),
        ("0.5 mm", 5e-4),
        ("1e-2rad", 0.01),
        (".1m/s", 0.1),
        ("3deg/s", math.radians(3)),
    ],
)
def test_a_tolerance_is_a_number_and_a_unit(text, si):
    assert parse_tolerance(text) == pytest.approx(si)


@pytest.mark.parametrize("text", ["", "2", "deg", "-2deg", "0deg", "2 parsec", "nandeg", "2deg" * 100])
def test_anything_else_is_refused_in_one_short_line(text):
    with pytest.raises(DiagnosisError, match="no tolerance") as refused:
        parse_tolerance(text)
    assert len(str(refused.value)) < 200


@pytest.mark.slow
def test_an_unknown_effect_below_the_told_tolerance_leaves_the_model_adequate():
    case, nobody_knows = concealed(("gravity_load",), seed=11), frozenset({"gravity_load", "hanging_payload"})
    usual, wide = (
        diagnose(case, tolerance=tolerance, without=nobody_knows).diagnosis
        for tolerance in (None, parse_tolerance("400deg"))
    )
    assert usual.verdict == "unexplained"
    assert usual.tolerance.value == pytest.approx(0.5)  # half a step of the encoder, deg
    assert wide.verdict == "adequate"
    assert "less than the tolerance of 400 deg" in wide.sentence
