"""`diagnose`, `simulate` and `fit` for a robot on two wheels."""

import json

import numpy as np
import pytest
import yaml
from cli_program import succeed

PLANT = {
    "kind": "differential_drive",
    "left": "b",
    "right": "c",
    "left_wheel_radius_m": 0.028,
    "right_wheel_radius_m": 0.028,
    "track_m": 0.12,
}
TRUE_RADIUS_M = 0.0285


@pytest.fixture
def folder(tmp_path):
    """Four runs of half-circles to the left and to the right, on wheels larger than the model's."""
    time_s = np.arange(0.0, 24.0, 0.05)
    for number in range(4):
        rng = np.random.default_rng(number)
        way = np.where((time_s // 6.0).astype(int) % 2 == number % 2, 1.0, -1.0)
        rate = np.where(time_s < 6.0, 0.0, 0.5 * way)
        heading = np.concatenate([[0.0], np.cumsum(rate[1:] * 0.05)])
        place = np.concatenate([[0.0], np.cumsum(0.01 * np.exp(0.5j * (heading[1:] + heading[:-1])))])
        wheels = [
            np.concatenate([[0.0], np.cumsum((0.2 + side * 0.06 * rate[1:]) * 0.05)]) / TRUE_RADIUS_M
            for side in (-1.0, 1.0)
        ]
        table = [
            time_s,
            np.floor(np.degrees(wheels[0])),
            np.floor(np.degrees(wheels[1])),
            place.real + 5e-4 * rng.standard_normal(time_s.size),
            place.imag + 5e-4 * rng.standard_normal(time_s.size),
            np.degrees(heading) + 0.2 * rng.standard_normal(time_s.size),
        ]
        head = "time_s,b_tacho_deg,c_tacho_deg,pose_x_m,pose_y_m,pose_heading_deg"
        np.savetxt(
            tmp_path / f"r{number}.csv",
            np.array(table).T,
            delimiter=",",
            header=head,
            comments="",
            fmt="%.6f",
        )
    content = {"plant": PLANT, "recordings": [f"r{number}.csv" for number in range(4)]}
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(content))
    return tmp_path


def test_from_a_folder_to_a_model_that_predicts_the_pose(folder):
    model = folder / "model.yaml"
    said = json.loads(succeed("diagnose", folder, "--json", "-", "--model-out", model).out)
    assert [effect["id"] for effect in said["effects"]] == ["wheel_radius"]
    answer = succeed("simulate", model, folder / "r1.csv", "--restart-every", "2", "--json", "-").out
    errors = json.loads(answer)["errors"]
    assert [error["channel"] for error in errors] == ["pose_x_m", "pose_y_m", "pose_heading_deg"]
    assert errors[0]["rmse"] < 2e-3


def test_fit_prints_wheels_track_and_markers(folder):
    fitted = json.loads(succeed("fit", folder, "--json", "-").out)["parameters"]
    values = {one["name"]: one for one in fitted}
    assert values["mean_wheel_radius_m"]["value"] == pytest.approx(TRUE_RADIUS_M, abs=5e-5)
    assert values["track_m"]["value"] == pytest.approx(0.12, abs=3e-4)
