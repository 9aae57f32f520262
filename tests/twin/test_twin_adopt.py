"""From a divergence to an adopted effect, and calm."""

from concurrent.futures import Future

from twin_rig import Rig, run, world_with

from nxt_twin.errors import DiagnosisError
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.verdict import verdict


def test_a_load_is_found_adopted_and_the_divergence_vanishes(tmp_path):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.05}}))
    adopter = Adopter(AtOnce())
    outcome = run(rig, 26.0, adopter=adopter)
    kinds = outcome.kinds()
    assert kinds.index("divergence") < kinds.index("effect_named") < kinds.index("adopted")
    assert kinds[-2:] == ["calm", "stopped"]
    assert "constant load" in outcome.first("adopted").words
    assert not outcome.session.monitors["a"].diverging
    (port, diagnosis), *_ = adopter.diagnoses
    assert port == "a"
    assert "constant_load" in [effect.id for effect in diagnosis.effects]
    assert verdict(outcome.memory.events, []).outcome == "explained"


class _Failing:
    def submit(self, *_, **__):
        future = Future()
        future.set_exception(DiagnosisError("too little moves"))
        return future

    def shutdown(self, **_):
        pass


def test_a_diagnosis_that_fails_leaves_the_model_alone(tmp_path):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.05}}))
    outcome = run(rig, 5.0, adopter=Adopter(_Failing(), enough_s=2.0))
    assert "adopted" not in outcome.kinds()
    assert any("too little moves" in event.words for event in outcome.memory.events)
    said = verdict(outcome.memory.events, ["a"])
    assert said.outcome == "diverges"


def test_a_session_in_which_all_held_says_so():
    assert verdict([], []).outcome == "holds"
