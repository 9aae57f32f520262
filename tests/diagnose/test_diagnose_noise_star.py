"""The search for the likeliest noise: its next step where some of its runs ran away, and its way out of a trap."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
import yaml
from scipy.signal import lfilter

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import estimate, first_noise, to_the_lowest
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import read_case

FREE = np.array([False, False])


def test_a_paraboloid_is_followed_to_its_lowest_point():
    right, up = 0.4, -0.2
    points = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]])
    costs = np.sum((points - [right, up]) ** 2, axis=1)
    step, fall = to_the_lowest(costs, FREE)
    assert step == pytest.approx([right, up])
    assert fall == pytest.approx(right**2 + up**2)


@pytest.mark.parametrize(
    ("costs", "fall"),
    [
        ([5.0, np.inf, 3.0, np.inf, np.nan, np.inf], 2.0),
        ([np.inf, np.inf, 3.0, np.inf, np.nan, np.inf], np.inf),
        ([np.inf] * 6, 0.0),
        ([np.nan] * 6, 0.0),
    ],
)
def test_runs_that_ran_away_lead_to_the_best_that_did_not_and_warn_nobody(costs, fall):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        step, found = to_the_lowest(np.array(costs), FREE)
    assert found == fall
    assert step.tolist() == ([-3.0, 0.0] if np.isfinite(costs[2]) else [0.0, 0.0])


MASS_KG, DRAG_N_S_PER_M, SCATTER_M = 12.0, 45.0, 6e-5


@pytest.fixture(scope="module")
def axis(tmp_path_factory):
    """An axis under steps of force, its positions by the recursion of a held force, and readings that scatter."""
    rng = np.random.default_rng(3)
    folder = tmp_path_factory.mktemp("axis")
    step_s, rows = 5e-3, 3000
    kept = np.exp(-DRAG_N_S_PER_M / MASS_KG * step_s)
    for number in range(3):
        force = np.repeat(rng.uniform(-9.0, 9.0, rows // 150), 150)
        speed = lfilter([0.0, (1.0 - kept) / DRAG_N_S_PER_M], [1.0, -kept], force)
        moved = force / DRAG_N_S_PER_M * step_s + (speed - force / DRAG_N_S_PER_M) * (1.0 - kept) * (
            MASS_KG / DRAG_N_S_PER_M
        )
        position = np.concatenate([[0.0], np.cumsum(moved)[:-1]]) + SCATTER_M * rng.standard_normal(rows)
        table = np.column_stack([np.arange(rows) * step_s, force, position])
        np.savetxt(folder / f"r{number}.csv", table, "%.9g", ",", header="t,f,x", comments="")
    mapping = {
        "table": {"format": "csv"},
        "time": {"column": "t", "unit": "s"},
        "input": {"column": "f", "kind": "force_n"},
        "output": {"column": "x", "kind": "position_m"},
    }
    (folder / "mapping.yaml").write_text(yaml.safe_dump(mapping))
    plant = {"kind": "rigid_body", "inertia": 14.0, "viscous_friction": 30.0}
    case = {"plant": plant, "recordings": [f"r{n}.csv" for n in range(3)], "mapping": "mapping.yaml"}
    (folder / "case.yaml").write_text(yaml.safe_dump(case))
    return problem_for(read_case(folder))


@pytest.mark.parametrize("hidden", [1e-3, 3e-2, 1.0])
@pytest.mark.parametrize("near", [False, True])
def test_reading_noise_that_a_poor_plant_hid_is_found_again_beside_the_right_one(axis, hidden, near):
    drag = Slot("viscous_friction", "viscous")
    right = axis.plant.with_values({Slot(BASE_OWNER, "inertia"): MASS_KG, drag: DRAG_N_S_PER_M})
    first = first_noise(axis.plant, axis.signals, axis.scale.torque)
    with Simulator(axis.plant.layout) as simulator:
        target = Fitter(simulator, axis).target(2e-3)
        start = replace(first, reading_std=hidden * SCATTER_M, disturbance_std=0.1)
        found, gain = estimate(simulator, right, target, start, near=near)
    assert found.reading_std == pytest.approx(SCATTER_M, rel=0.5)
    assert gain > 100.0
