import json

import numpy as np
import pytest
from diagnose_cases import LETS_GO, LONG, TWISTING, concealed, diagnosed

from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.physics.plant import plant_from_config


def named_or_confused(diagnosis):
    found = {effect.id for effect in diagnosis.effects}
    return found | {other.id for effect in diagnosis.effects for other in effect.confusable_with}


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("effect", "made"),
    [
        ("gravity_load", LONG),
        ("command_delay", {"seed": 12}),
        ("stiction", {"seed": 14}),
        ("shaft_compliance", TWISTING),
    ],
)
def test_a_concealed_effect_is_named_and_the_error_on_unfitted_data_falls(effect, made):
    diagnosis = diagnosed((effect,), **made).diagnosis
    assert diagnosis.verdict == "explained"
    assert effect in named_or_confused(diagnosis)
    assert diagnosis.fit.improved < 0.95 * diagnosis.fit.baseline


@pytest.mark.slow
def test_an_effect_whose_size_readings_leave_open_is_listed_and_explains_no_error_that_matters():
    diagnosis = diagnosed(("stiction",), seed=13).diagnosis
    assert diagnosis.verdict == "unexplained"
    assert [effect.id for effect in diagnosis.effects] == ["stiction"]
    assert "its 95 % interval is wider than the size" in diagnosis.sentence


@pytest.mark.slow_variants
@pytest.mark.parametrize("made", [LETS_GO, {"seed": 22, "link": "bluetooth"}], ids=["usb", "bluetooth"])
def test_nothing_is_blamed_where_only_parameters_were_wrong(made):
    diagnosis = diagnosed((), **made).diagnosis
    assert diagnosis.verdict == "adequate"
    assert diagnosis.effects == ()
    assert diagnosis.mismatch.when == ()
    assert diagnosis.fit.improved == diagnosis.fit.baseline
    assert all(moved.after != moved.before for moved in diagnosis.refit.values())


def test_an_effect_that_nobody_knows_is_refused():
    diagnosis = diagnosed(("swapped_sense",), seed=31).diagnosis
    assert diagnosis.verdict == "unexplained"
    assert diagnosis.leftover is not None
    assert np.std(diagnosis.leftover.after) > 0.0


def test_the_improved_plant_holds_what_was_found():
    answer = diagnosed(("gravity_load",), **LONG)
    config = answer.plant.to_config()
    assert "gravity_load" in config["effects"]
    assert plant_from_config(config, "power_pct").active == answer.plant.active


def test_the_json_is_as_documented():
    content = json.loads(to_json(diagnosed(("gravity_load",), **LONG).diagnosis))
    assert content["schema"] == "nxt-twin/diagnosis/1"
    assert {"channel", "when", "regimes", "equation"} <= set(content["mismatch"])
    assert content["mismatch"]["channel"] == "a_tacho_deg"
    assert content["mismatch"]["when"][0].keys() == {"recording", "start_s", "end_s", "strength"}
    assert set(content["fit"]) == {"metric", "unit", "baseline", "improved", "floor", "horizons"}
    lengths = [horizon["seconds"] for horizon in content["fit"]["horizons"]]
    assert lengths == [0.5, 2.0, 10.0, None]
    assert {"given", "baseline", "improved", "floor"} <= content["fit"]["horizons"][0].keys()
    assert content["tolerance"].keys() == {"value", "unit", "remaining"}
    effect = content["effects"][0]
    assert effect["id"] == "gravity_load"
    assert {"value", "std", "unit"} <= set(effect["params"]["gravity_torque_nm"])
    assert 0.0 <= effect["probability"] <= 1.0


def test_a_diagnosis_is_the_same_twice():
    from nxt_twin.diagnose.engine import diagnose

    first = to_json(diagnosed(("command_delay",), seed=12).diagnosis)
    assert to_json(diagnose(concealed(("command_delay",), seed=12)).diagnosis) == first
