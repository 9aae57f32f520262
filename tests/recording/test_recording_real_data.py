"""Other people's recordings: made into cases as their descriptions say."""

from math import pi

import numpy as np
import pytest
from scipy.io import savemat

from nxt_twin.errors import CaseError, MissingDataError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.realdata import data_root, prepare_case
from nxt_twin.recording.recording import SignalKinds


@pytest.fixture(scope="module")
def data():
    try:
        return data_root()
    except MissingDataError as missing:
        pytest.skip(str(missing))


@pytest.mark.real_data
def test_emps_is_fitted_on_one_run_and_judged_on_the_other(data, tmp_path):
    case = read_case(prepare_case("emps", data, tmp_path))
    assert case.plant == {"kind": "rigid_body", "inertia": 95.0, "viscous_friction": 200.0}
    (fitted,), (held_out,) = case.recordings, case.holdout
    assert (fitted.name, held_out.name) == ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat")
    for recording in (fitted, held_out):
        assert recording.kinds == SignalKinds("force_n", "position_m")
        assert recording.rows == 24841
        assert recording.duration_s == pytest.approx(24.84, abs=1e-3)
    assert fitted.columns["input"][0] == pytest.approx(35.15065188 * 2.53862809, rel=1e-8)


@pytest.mark.real_data
def test_ev3_large_is_split_as_fixed_beforehand(data, tmp_path):
    case = read_case(prepare_case("ev3-large", data, tmp_path))
    fitted = {recording.columns["a_power_pct"][0] for recording in case.recordings}
    assert fitted == {sign * duty for sign in (1.0, -1.0) for duty in (20, 40, 60, 80)}
    steps = {r.name: r.columns["a_power_pct"] for r in case.holdout if r.name.startswith("step")}
    assert {power[0] for power in steps.values()} == {
        s * d for s in (1.0, -1.0) for d in (10, 30, 50, 70, 100)
    }
    assert steps["step_m100.csv"][0] == -100.0
    assert all(np.all(power == power[0]) for power in steps.values())
    assert case.port == "a"
    assert "coulomb_friction_nm" not in case.plant


@pytest.mark.real_data
def test_ev3_large_turns_the_way_it_is_driven_and_sines_follow_their_stamps(data, tmp_path):
    case = read_case(prepare_case("ev3-large", data, tmp_path))
    sines = [recording for recording in case.holdout if recording.name.startswith("sine")]
    for recording in (*case.recordings, *(r for r in case.holdout if r not in sines)):
        assert recording.columns["a_tacho_deg"][-1] * recording.columns["a_power_pct"][0] > 0
    assert [sine.name for sine in sines] == ["sine_w3.14.csv", "sine_w6.28.csv", "sine_w9.42.csv"]
    for number, sine in enumerate(sines, 1):
        expected = 100 * np.sin(number * pi * sine.time_s)
        np.testing.assert_allclose(sine.columns["a_power_pct"], expected, atol=1e-9)


@pytest.mark.real_data
def test_nxt_step_is_a_constant_duty_counted_in_degrees(data, tmp_path):
    case = read_case(prepare_case("nxt-step", data, tmp_path))
    (recording,) = case.recordings
    assert case.plant == "nxt_motor"
    assert recording.kinds == SignalKinds("power_pct", "position_rad")
    assert recording.rows == 376
    assert recording.duration_s == pytest.approx(2.161)
    assert recording.output_quantum == pytest.approx(pi / 180)
    assert set(recording.columns["input"]) == {60.0}
    assert recording.columns["output"][-1] == pytest.approx(np.deg2rad(1176), abs=0.5)


def _put_emps(data):
    (data / "emps").mkdir(parents=True)
    for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"):
        columns = {"t": [0.0, 0.001], "vir": [1.0, 2.0], "qm": [0.0, 1e-6]}
        savemat(data / "emps" / name, {key: np.array(values) for key, values in columns.items()})


def test_a_prepared_case_stands_alone_and_can_be_prepared_again(tmp_path):
    _put_emps(tmp_path / "data")
    for _ in range(2):
        folder = prepare_case("emps", tmp_path / "data", tmp_path / "out")
    assert folder == tmp_path / "out" / "emps"
    assert sorted(path.name for path in folder.iterdir()) == [
        "DATA_EMPS.mat",
        "DATA_EMPS_PULSES.mat",
        "case.yaml",
        "emps.yaml",
    ]
    np.testing.assert_allclose(read_case(folder).holdout[0].columns["input"], [35.15065188, 70.30130376])


def test_says_what_is_missing_and_where_to_get_it(tmp_path, monkeypatch, refusal):
    line = refusal(MissingDataError, prepare_case, "nxt-step", tmp_path, tmp_path / "out")
    assert "motor_data_identifikace.txt" in line
    assert "docs/real-data.md" in line
    monkeypatch.setenv("NXT_TWIN_DATA", str(tmp_path / "none"))
    line = refusal(MissingDataError, data_root)
    assert "NXT_TWIN_DATA" in line


def test_the_variable_names_the_data_root(tmp_path, monkeypatch):
    monkeypatch.setenv("NXT_TWIN_DATA", str(tmp_path))
    assert data_root() == tmp_path


def test_refuses_an_unknown_data_set(tmp_path, refusal):
    assert "nearest known: emps" in refusal(CaseError, prepare_case, "emp", tmp_path, tmp_path)
