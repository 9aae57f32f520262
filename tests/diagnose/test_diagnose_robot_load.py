"""A payload on a robot: its reach is unknown, and commands may act late."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnose_robot_cases import powered_case, robot_of_seed

from nxt_twin.diagnose.robot.engine import diagnose_robot

ADDED_KG = 0.6


@pytest.mark.slow_variants
@pytest.mark.parametrize("reach", [0.0, 0.3])
def test_the_interval_of_a_payload_admits_that_its_reach_is_unknown(reach):
    truth = robot_of_seed(5)
    more = truth.spin_kg_m2 * reach * ADDED_KG / truth.mass_kg
    loaded = replace(truth, mass_kg=truth.mass_kg + ADDED_KG, spin_kg_m2=truth.spin_kg_m2 + more)
    (effect,) = diagnose_robot(powered_case("loaded", loaded, 1)).diagnosis.effects
    assert effect.id == "payload_mass"
    low_kg, high_kg = effect.params["added_mass_kg"].interval_95
    assert low_kg < ADDED_KG < high_kg < 2.5 * ADDED_KG


def _stamped_early(case, rows):
    """The case where each command is stamped some rows before it acts."""

    def early(recording):
        powers = {
            name: np.concatenate([values[rows:], np.full(rows, values[-1])])
            for name, values in recording.columns.items()
            if name.endswith(("_power_pct", "_mode"))
        }
        return replace(recording, columns={**recording.columns, **powers})

    return replace(case, recordings=tuple(map(early, case.recordings)), holdout=())


def test_commands_that_act_late_are_no_missing_force():
    truth = robot_of_seed(5)
    loaded = powered_case("late", replace(truth, mass_kg=truth.mass_kg + ADDED_KG), 1)
    period_s = float(np.median(np.diff(loaded.recordings[0].time_s)))
    found = diagnose_robot(_stamped_early(loaded, 3)).diagnosis
    assert found.verdict == "explained"
    assert [effect.id for effect in found.effects] == ["payload_mass"]
    (told,) = (note for note in found.notes if "after their stamps" in note)
    assert abs(float(told.split("act ")[1].split(" ms")[0]) - 3e3 * period_s) <= 10.0


def _lost_from_sight(case):
    """The case where a camera loses the robot for a third of a second, ten times a run."""

    def blinded(recording):
        rows = np.arange(recording.time_s.size)
        gone = (rows % (rows.size // 10) > rows.size // 10 - 8) & (rows > 20)
        lost = {
            name: np.where(gone, np.nan, values)
            for name, values in recording.columns.items()
            if name.startswith("pose_")
        }
        return replace(recording, columns={**recording.columns, **lost})

    return replace(case, recordings=tuple(map(blinded, case.recordings)))


def test_powers_act_while_the_camera_does_not_see_the_robot():
    truth = robot_of_seed(5)
    loaded = powered_case("blind", replace(truth, mass_kg=truth.mass_kg + ADDED_KG), 1)
    found = diagnose_robot(_lost_from_sight(loaded)).diagnosis
    assert found.verdict == "explained"
    assert [effect.id for effect in found.effects] == ["payload_mass"]
    low_kg, high_kg = found.effects[0].params["added_mass_kg"].interval_95
    assert low_kg < ADDED_KG < high_kg
