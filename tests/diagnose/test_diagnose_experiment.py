"""What to record next: safe inputs, the evidence they promise, and the program that comes of it."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from diagnose_motors import recorded, settled
from typer.testing import CliRunner

from nxt_twin.cli.app import program
from nxt_twin.diagnose.diagnosis import Mismatch, NextExperiment
from nxt_twin.diagnose.dispatch import Answered
from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting import settling
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.judging.confusion import alike, without
from nxt_twin.diagnose.next.inputs import family
from nxt_twin.diagnose.next.next_experiment import propose
from nxt_twin.diagnose.next.next_step import _twice_and_half, _with_program
from nxt_twin.diagnose.telling import words
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.program import MotorProgram, commands, read_program


@cache
def loaded_case():
    return recorded(71, motor={"constant_torque_nm": 0.004}, seconds=8.0)


@pytest.mark.parametrize("most", [20, 55, 100])
def test_no_input_of_the_family_goes_beyond_the_power_that_was_recorded(most):
    patterns = list(family(most))
    assert len(patterns) > 20
    assert len({pattern.words for pattern in patterns}) == len(patterns)
    for pattern in patterns:
        for segment in pattern.segments:
            assert abs(segment.power_pct) <= most or abs(segment.power_pct) <= 10
        assert pattern.period_s <= 20.0
        length_s = sum(segment.duration_s for segment in pattern.lasting(30.0))
        assert 30.0 <= length_s + 1e-6 < 30.0 + pattern.period_s


@pytest.fixture(scope="module")
def rivals():
    """A constant load and friction that differs by direction, each fitted to what the load has made."""
    case = recorded(71, motor={"constant_torque_nm": 0.004}, families=("reversals", "steps", "steps"))
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, fitter, load = settled(simulator, case, added={"constant_load": {"load": 0.004}})
        bare = without(load.plant, "constant_load", problem.plant)
        level = bare.values[("coulomb_friction", "coulomb")]
        lean = {"forward": max(level - 0.004, 0.0), "reverse": level + 0.004}
        other = settling.settled(fitter, bare.with_effect("asymmetric_friction", lean), load.noise)
        yield simulator, problem, load, other, bare


def test_rivals_leave_nearly_the_same_trace_and_strangers_do_not(rivals):
    simulator, problem, load, _, bare = rivals
    linear = linearise(simulator, problem, load)
    effect = load.plant.layout.effect("constant_load")
    others = [load.plant.layout.effect(name) for name in ("asymmetric_friction", "power_curve")]
    near, far = alike(simulator, problem.scale, linear, effect, bare, others)
    assert near.effect.id == "asymmetric_friction"
    assert near.cosine > 0.8
    assert near.apart_nats < far.apart_nats


def test_an_experiment_is_proposed_that_promises_evidence_and_is_the_same_twice(rivals):
    simulator, problem, load, other, _ = rivals
    found = propose(simulator, problem, load, other, np.random.default_rng(1))
    assert found is not None
    assert found.expected_nats > 0.0
    assert 1.0 <= found.seconds <= 600.0
    assert found == propose(simulator, problem, load, other, np.random.default_rng(1))


def test_a_structure_cannot_be_told_from_itself(rivals):
    simulator, problem, load, _, _ = rivals
    found = propose(simulator, problem, load, load, np.random.default_rng(1))
    assert found is None or found.seconds > 100.0


@pytest.fixture(scope="module")
def loaded():
    return diagnose(loaded_case())


def test_the_json_carries_doubt_intervals_and_the_program(loaded):
    diagnosis = loaded.diagnosis
    content = json.loads(to_json(diagnosis))
    assert {"detectable", "excitation", "false_alarm_rate", "nearest"} <= content.keys()
    inertia = content["refit"]["inertia_kg_m2"]
    low, high = inertia["interval_95"]
    assert low < inertia["to"] < high
    assert inertia["rests_on"] == ["resistance_ohm", "torque_constant_nm_per_a"]
    assert content["refit"]["torque_constant_nm_per_a"]["rests_on"] == []
    torque = next(cell for cell in content["effects"][0]["params"].values() if cell["unit"] == "N·m")
    assert torque["ratio"]["of"] == "inertia_kg_m2"
    assert torque["ratio"]["std"] / torque["ratio"]["value"] < torque["std"] / torque["value"]
    assert 0.0 <= content["false_alarm_rate"]["rate"] <= content["false_alarm_rate"]["upper_95"] <= 1.0
    experiment = content["next_experiment"]
    if experiment is not None:
        assert MotorProgram.model_validate(experiment["program"]).ports == ("a",)


def test_the_transmission_is_told_by_source_since_the_format_knows_four_equations(loaded):
    moved = replace(loaded.diagnosis, mismatch=Mismatch("a_tacho_deg", (), (), "kinematic", "transmission"))
    mismatch = json.loads(to_json(moved))["mismatch"]
    assert mismatch["equation"] == "torque_balance"
    assert mismatch["source"] == "transmission"


@pytest.fixture
def as_if_diagnosed(loaded, monkeypatch, tmp_path):
    """Run `diagnose --experiment-out` on a recording, as if its diagnosis ended with this experiment."""
    case = loaded_case()
    target = tmp_path / "next" / "program.yaml"

    def command(experiment):
        answer = Answered(replace(loaded.diagnosis, next_experiment=experiment), loaded.plant.to_config())
        monkeypatch.setattr("nxt_twin.diagnose.dispatch.diagnose_any", lambda *_, **__: answer)
        write_recording(case.recordings[0], tmp_path / "r1.csv")
        arguments = ["diagnose", str(tmp_path / "r1.csv"), "--experiment-out", str(target)]
        result = CliRunner().invoke(program(), arguments)
        assert result.exit_code == 0
        return target, result.stdout

    return problem_for(case), command


def test_the_next_experiment_is_written_as_a_program_that_can_be_read(as_if_diagnosed):
    problem, command = as_if_diagnosed
    told = words.experiment_for_unknown()
    target, _ = command(_with_program(problem, told, "what-repeats", _twice_and_half(problem)))
    following = read_program(target)
    assert following.why
    powers = [abs(each.power_pct) for run in following.runs for each in commands(run)]
    assert 0 < max(powers) <= 100


@pytest.mark.parametrize(
    ("experiment", "said"),
    [(None, "no experiment is written"), (NextExperiment("why", "a heavier load"), "told in words")],
)
def test_where_no_program_can_be_written_the_reason_is_told(as_if_diagnosed, experiment, said):
    target, stdout = as_if_diagnosed[1](experiment)
    assert not target.exists()
    assert said in stdout
