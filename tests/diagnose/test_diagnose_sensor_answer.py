"""What comes with a sensor's diagnosis: JSON, model, report, held-out error, refusals, the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from diagnose_sensor_cases import own_case, sensor_case, sensor_diagnosis

from nxt_twin.cli.app import program
from nxt_twin.diagnose.sensor.engine import diagnose_sensor, is_sensor_case
from nxt_twin.diagnose.sensor.simulate import expected_readings
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.errors import DiagnosisError
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.files import read_recording, write_recording
from nxt_twin.view.report import render_report


def test_a_motor_is_no_sensor():
    motor = Case("m", Path(), "nxt_motor", (), (), "a")
    assert not is_sensor_case(motor)
    assert is_sensor_case(Case("u", Path(), "nxt_ultrasonic", (), (), None))
    with pytest.raises(DiagnosisError, match="no sensor case"):
        diagnose_sensor(motor)


def test_the_json_is_as_documented():
    answer = json.loads(to_json(sensor_diagnosis("touch_sensor", ("touch_hysteresis",))[0].diagnosis))
    assert answer["schema"] == "nxt-twin/diagnosis/1"
    assert answer["mismatch"]["channel"] == "s1_touch"
    assert answer["mismatch"]["equation"] == "measurement"
    assert set(answer["effects"][0]["params"]) == {"press_force_g", "release_force_g"}
    assert answer["refit"]["force_noise_g"]["std"] > 0
    assert answer["fit"]["improved"] < answer["fit"]["baseline"]


def test_the_same_case_gives_the_same_answer():
    case, _ = sensor_case("touch_sensor", ("touch_hysteresis",))
    assert to_json(diagnose_sensor(case).diagnosis) == to_json(
        sensor_diagnosis("touch_sensor", ("touch_hysteresis",))[0].diagnosis
    )


@pytest.mark.parametrize(
    ("kind", "effect"), [("light_sensor", "light_saturation"), ("touch_sensor", "touch_hysteresis")]
)
def test_the_improved_sensor_foretells_a_recording_from_the_rigs_truth(kind, effect):
    answer, _ = sensor_diagnosis(kind, (effect,), every=4 if kind == "light_sensor" else 1)
    case, _ = sensor_case(kind, (effect,))
    said = expected_readings(answer.model.to_config(), case.recordings[0])
    assert said.channel == answer.diagnosis.mismatch.channel
    assert said.rmse < 1.5 * answer.diagnosis.fit.floor + 0.02
    assert effect in answer.model.to_config()["effects"]


def test_recordings_that_the_case_holds_out_are_judged_and_not_fitted():
    answer, _ = sensor_diagnosis("light_sensor", ("light_ambient_offset",), every=4, hold_out=1)
    said = answer.diagnosis
    assert [run.recording for run in said.held_out] == ["r4.csv"]
    assert [effect.id for effect in said.effects] == ["light_ambient_offset"]
    assert said.held_out[0].measured.size == 80  # a fifth of 100 tells its room light
    assert said.fit.improved < 1.3 * said.fit.floor < said.fit.baseline
    assert any("first fifth" in note for note in said.notes)


def test_the_report_shows_readings_against_the_truth():
    page = render_report(sensor_diagnosis("light_sensor", ("light_saturation",), every=4)[0].diagnosis)
    assert "true position (mm)" in page
    assert "value that the rig had set" in page
    assert "drawn large" not in page


def test_a_scale_error_is_said_to_be_no_thermometer():
    said = sensor_diagnosis("ultrasonic_sensor", ("ultrasonic_sound_speed",), every=4)[0].diagnosis
    assert any("thermometer" in note for note in said.notes)


def test_the_case_of_a_travel_rig_speaks_of_millimetres():
    travel = np.tile(np.concatenate([np.arange(1.0, 3.0, 0.02), np.arange(3.0, 1.0, -0.02)]), 10)
    told, closed = [], False
    for depth in travel:
        closed = depth > 1.81 if closed else depth > 2.11
        told.append(closed)
    columns = {"time_s": 0.02 * np.arange(travel.size), "s1_touch": told, "rig_compression_mm": travel}
    said = diagnose_sensor(own_case("touch_sensor", columns)).diagnosis
    params = said.effects[0].params
    assert params["press_travel_mm"].value == pytest.approx(2.11, abs=0.02)
    assert params["release_travel_mm"].value == pytest.approx(1.81, abs=0.02)


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        ({"s4_ultrasonic_cm": np.full(50, 20.0)}, "rig_distance_mm is missing"),
        ({"rig_distance_mm": np.full(50, 200.0)}, "no recording of a ultrasonic_sensor"),
        (
            {
                "s4_ultrasonic_cm": np.where(np.arange(50) < 5, 20.0, np.nan),
                "rig_distance_mm": np.full(50, 200.0),
            },
            "too few readings",
        ),
    ],
)
def test_says_what_a_case_lacks(columns, says):
    case = own_case("ultrasonic_sensor", {"time_s": 0.06 * np.arange(50), **columns})
    with pytest.raises(DiagnosisError, match=says):
        diagnose_sensor(case)


def test_keys_of_the_baseline_that_no_sensor_has_are_passed_over_and_told():
    case, _ = sensor_case("touch_sensor", ("touch_hysteresis",))
    plant = {"kind": "touch_sensor", "switch_force_g": 50.0, "threshold": 3}
    said = diagnose_sensor(Case("x", Path(), plant, case.recordings, (), None)).diagnosis
    assert any("threshold" in note for note in said.notes)


def test_from_a_folder_by_the_command_line_to_a_model_and_back(tmp_path, capsys):
    case, _ = sensor_case("touch_sensor", ("touch_hysteresis",))
    folder = tmp_path / "case"
    folder.mkdir()
    for recording in case.recordings:
        write_recording(recording, folder / recording.name)
    content = {"plant": {"kind": "touch_sensor"}, "recordings": ["r1.csv", "r2.csv"], "holdout": ["r3.csv"]}
    (folder / "case.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    assert is_sensor_case(read_case(folder))
    model, expected = tmp_path / "model.yaml", tmp_path / "expected.csv"
    app = program(("diagnose", "simulate"))
    app(["diagnose", str(folder), "--model-out", str(model), "--json", "-"], standalone_mode=False)
    assert json.loads(capsys.readouterr().out)["verdict"] == "explained"
    app(["simulate", str(model), str(folder / "r3.csv"), "--out", str(expected)], standalone_mode=False)
    told, drawn = (
        read_recording(expected).columns["s1_touch"],
        read_recording(folder / "r3.csv").columns["s1_touch"],
    )
    assert np.mean(told == drawn) > 0.99
