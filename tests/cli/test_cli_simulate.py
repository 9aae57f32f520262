"""`nxt-twin simulate` and `nxt-twin fit`."""

import numpy as np
import pyarrow.parquet
import pytest
import yaml
from cli_program import column, run, succeed

from nxt_twin.recording.files import read_recording

MOTOR = {
    "kind": "dc_motor",
    "resistance_ohm": 7.6,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
}


@pytest.fixture
def recording(cases):
    return cases["clean"] / "r1.csv"


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "motor.yaml"
    path.write_text(yaml.safe_dump(MOTOR))
    return path


def test_a_prediction_is_a_recording_with_the_same_columns_and_commands(recording, tmp_path):
    out = tmp_path / "prediction.csv"
    said = succeed("simulate", "nxt_motor", recording, "--out", out).out
    measured, predicted = read_recording(recording), read_recording(out)
    assert list(predicted.columns) == list(measured.columns)
    for name in ("time_s", "a_power_pct", "battery_v"):
        np.testing.assert_array_equal(predicted.columns[name], measured.columns[name])
    assert np.isfinite(predicted.columns["a_tacho_deg"]).all()
    assert "a_tacho_deg: free-run RMSE" in said
    assert str(out) in said


def test_a_prediction_starts_at_rest_where_the_recording_starts(recording, tmp_path):
    out = tmp_path / "prediction.csv"
    succeed("simulate", "nxt_motor", recording, "--out", out)
    angle, time_s = column(out, "a_tacho_deg"), column(out, "time_s")
    assert angle[0] == column(recording, "a_tacho_deg")[0]
    driven = np.flatnonzero(np.nan_to_num(column(recording, "a_power_pct")) != 0.0)[0]
    assert np.all(angle[: driven + 1] == angle[0])
    assert np.ptp(angle[time_s < time_s[0] + 3.0]) > 10.0


def test_a_prediction_knows_nothing_of_later_readings(recording, tmp_path):
    lines = recording.read_text().splitlines()
    at = lines[0].split(",").index("a_tacho_deg")
    first, *later = (line.split(",") for line in lines[1:])
    wrong = [[*cells[:at], "0" if cells[at] else "", *cells[at + 1 :]] for cells in later]
    (tmp_path / "wrong.csv").write_text(
        "\n".join(",".join(cells) for cells in [lines[0].split(","), first, *wrong])
    )
    outs = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for source, out in zip((recording, tmp_path / "wrong.csv"), outs, strict=True):
        succeed("simulate", "nxt_motor", source, "--out", out)
    np.testing.assert_array_equal(*(column(out, "a_tacho_deg") for out in outs))


def test_restarts_bring_the_prediction_back_to_the_readings(recording, tmp_path):
    out = tmp_path / "prediction.csv"
    whole, often = (
        succeed("simulate", "nxt_motor", recording, *more, "--out", out, "--json", "-").json()["errors"][0]
        for more in ([], ["--restart-every", "0.25"])
    )
    assert often["rmse"] < 0.3 * whole["rmse"]
    assert often["readings"] < whole["readings"]
    off = np.abs(column(out, "a_tacho_deg") - column(recording, "a_tacho_deg"))
    window = np.floor((column(out, "time_s") - column(out, "time_s")[0]) / 0.25)
    anew = np.flatnonzero(np.diff(window, prepend=-1.0) > 0.0)
    assert np.median(off[anew]) < 1.0


def test_json_on_standard_output_is_all_that_is_there(recording, tmp_path):
    outcome = succeed("simulate", "nxt_motor", recording, "--out", tmp_path / "p.csv", "--json")
    assert outcome.json()["schema"] == "nxt-twin/simulation/1"
    assert outcome.json()["errors"][0]["unit"] == "deg"
    assert outcome.err == ""


def test_a_prediction_may_be_written_as_parquet(recording, tmp_path):
    outs = [tmp_path / "p.csv", tmp_path / "p.parquet"]
    for out in outs:
        succeed("simulate", "nxt_motor", recording, "--out", out)
    assert pyarrow.parquet.read_table(outs[1]).column_names == list(read_recording(recording).columns)
    np.testing.assert_array_equal(*(column(out, "a_tacho_deg") for out in outs))


def test_every_motor_of_a_recording_is_predicted(tmp_path, model):
    rows = [f"{0.01 * k:.2f},50,-80,0,7" for k in range(100)]
    two = tmp_path / "two.csv"
    two.write_text("\n".join(["time_s,a_power_pct,c_power_pct,a_tacho_deg,c_tacho_deg", *rows]))
    out = tmp_path / "out.csv"
    errors = succeed("simulate", model, two, "--out", out, "--json", "-").json()["errors"]
    assert [error["channel"] for error in errors] == ["a_tacho_deg", "c_tacho_deg"]
    assert column(out, "a_tacho_deg")[-1] > 100.0
    assert column(out, "c_tacho_deg")[-1] < -150.0
    assert column(out, "c_tacho_deg")[0] == 7.0


def test_a_table_from_elsewhere_is_predicted_through_its_mapping(tmp_path, model):
    time_ms = np.arange(0, 2000, 5)
    lines = ["ms;volts;turns", *(f"{t};4.0;0.25" for t in time_ms)]
    (tmp_path / "bench.txt").write_text("\n".join(lines))
    mapping = tmp_path / "bench.yaml"
    mapping.write_text(
        "table: {format: csv, delimiter: ';'}\n"
        "time: {column: ms, unit: ms}\n"
        "input: {column: volts, kind: voltage_v}\n"
        "output: {column: turns, kind: position_deg, gain: 360.0}\n"
    )
    out = tmp_path / "out.parquet"
    succeed("simulate", model, tmp_path / "bench.txt", "--mapping", mapping, "--out", out)
    table = pyarrow.parquet.read_table(out)
    assert table.column_names == ["time_s", "input", "output"]
    time_s, volts, angle = (table[name].to_numpy() for name in table.column_names)
    np.testing.assert_allclose(time_s, time_ms / 1000.0)
    assert np.all(volts == 4.0)
    rate = (1.92e-3 + 0.4908**2 / 7.6) / 1.2e-3
    steady = 0.4908 * 4.0 / 7.6 / 1.2e-3 / rate
    expected = np.pi / 2.0 + steady * (time_s - (1.0 - np.exp(-rate * time_s)) / rate)
    np.testing.assert_allclose(angle, expected, atol=1e-3)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("no_such_motor", "r1.csv"), "no_such_motor"),
        (("nxt_motor", "gone.csv"), "gone.csv"),
        (("gone.yaml", "r1.csv"), "gone.yaml"),
        (("nxt_motor", "r1.csv", "--mapping", "gone.yaml"), "gone.yaml"),
        (("nxt_motor", "r1.csv", "--out", "p.xlsx"), "p.xlsx"),
        (("nxt_motor", "r1.csv", "--out", "gone/p.csv"), "p.csv"),
    ],
)
def test_what_cannot_be_simulated_is_refused_in_one_line(cases, monkeypatch, arguments, complaint):
    monkeypatch.chdir(cases["clean"])
    outcome = run("simulate", *arguments)
    assert outcome.status == 1
    assert outcome.err.startswith("nxt-twin: ")
    assert outcome.err.count("\n") == 1
    assert complaint in outcome.err


def test_a_plant_of_another_kind_is_refused(tmp_path, recording):
    plant = tmp_path / "axis.yaml"
    plant.write_text("kind: rigid_body\ninertia: 1.0\n")
    outcome = run("simulate", plant, recording)
    assert outcome.status == 1
    assert "rigid_body" in outcome.err


@pytest.mark.parametrize("every", ["0", "-1", "often"])
def test_restarts_at_no_interval_are_wrong_use(recording, every):
    assert run("simulate", "nxt_motor", recording, "--restart-every", every).status == 2


def test_a_fit_moves_the_plant_s_numbers_to_what_the_recording_shows(cases, tmp_path):
    model = tmp_path / "fitted.yaml"
    said = succeed("fit", cases["clean"], "--model-out", model)
    fitted = yaml.safe_load(model.read_text())
    given = yaml.safe_load((cases["clean"] / "case.yaml").read_text())["plant"]
    assert set(fitted) == set(given)
    assert "inertia_kg_m2 = " in said.out
    recording = cases["clean"] / "r1.csv"
    rmse = [
        succeed("simulate", plant, recording, "--restart-every", "2", "--json", "-").json()["errors"][0][
            "rmse"
        ]
        for plant in (model, "nxt_motor")
    ]
    assert rmse[0] < rmse[1]


def test_a_fit_as_json_gives_value_spread_and_unit_of_each_number(cases):
    answer = succeed("fit", cases["clean"], "--json").json()
    assert answer["schema"] == "nxt-twin/fit/1"
    found = {row["name"]: row for row in answer["parameters"]}
    assert found["inertia_kg_m2"]["unit"] == "kg·m²"
    assert 0.0 < found["inertia_kg_m2"]["std"] < found["inertia_kg_m2"]["value"] < 3e-3
