"""From a divergence to an adopted effect, and calm."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from twin_feed import nxt_motor
from twin_rig import Rig, run, world_with

from nxt_twin.diagnose.diagnosis import Moved
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.twin.adopt import Adopter, AtOnce, battery_is_another
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.gain import gain
from nxt_twin.twin.records import Event
from nxt_twin.twin.verdict import Seen, verdict

SEEN = Seen(1000, 30.0, 0.0)


def test_a_load_is_found_adopted_and_the_divergence_vanishes(tmp_path):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.05}}))
    adopter = Adopter(AtOnce())
    outcome = run(rig, 40.0, adopter=adopter)
    kinds = outcome.kinds()
    assert kinds.index("divergence") < kinds.index("effect_named") < kinds.index("adopted")
    assert kinds[-2:] == ["calm", "stopped"]
    assert "constant load" in outcome.first("adopted").words
    assert not outcome.session.monitors["a"].diverging
    *_, (port, diagnosis) = adopter.diagnoses
    assert port == "a"
    assert "constant_load" in [effect.id for effect in diagnosis.effects]
    assert verdict(outcome.memory.events, [], SEEN).outcome == "explained"


class _Failing:
    def __init__(self, error):
        self._error = error

    def submit(self, *_, **__):
        future = Future()
        future.set_exception(self._error)
        return future

    def shutdown(self, **_):
        pass


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (DiagnosisError("too little moves"), "too little moves"),
        (ZeroDivisionError("by nothing"), "an error of this program (ZeroDivisionError: by nothing)"),
    ],
)
def test_a_diagnosis_that_fails_leaves_model_and_session_alone(tmp_path, error, words):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.05}}))
    outcome = run(rig, 5.0, adopter=Adopter(_Failing(error), enough_s=2.0))
    assert "adopted" not in outcome.kinds()
    assert outcome.kinds()[-1] == "stopped"
    assert words in outcome.first("undiagnosed").words
    assert "\n" not in outcome.first("undiagnosed").words
    assert verdict(outcome.memory.events, ["a"], SEEN).outcome == "diverges"


def test_who_does_it_at_once_hands_errors_on_as_a_thread_would():
    future = AtOnce().submit(int, "none")
    assert isinstance(future.exception(), ValueError)


def test_a_twin_is_diagnosed_with_the_battery_that_it_is_run_with():
    twin = BrickTwin({"a": nxt_motor(), "b": nxt_motor()}, TwinOptions(candidates=(), cells_ohm=0.4))
    sag = Slot("battery_sag", "internal")
    as_run = twin.plant_as_run("a")
    assert as_run.values[sag] == 0.4
    twin.adopt("a", as_run.with_effect("battery_sag", {"internal": 0.9}), 0.0)
    assert "battery_sag" not in twin.plants["a"].active  # it is the battery's, which all motors share
    assert twin.plant_as_run("b").values[sag] == 0.9


def test_a_battery_that_may_be_as_it_was_stays_so():
    twin = BrickTwin({"a": nxt_motor(), "b": nxt_motor()}, TwinOptions(candidates=(), cells_ohm=0.4))
    twin.adopt("a", nxt_motor().with_effect("battery_sag", {"internal": 0.9}), 0.0, told_of_battery=False)
    assert "battery_sag" not in twin.plants["a"].active
    assert twin.plant_as_run("b").values[Slot("battery_sag", "internal")] == 0.4


@pytest.mark.parametrize(("interval", "sure"), [((0.2, 1.3), False), ((0.2, 0.9), True), (None, True)])
def test_a_battery_is_another_if_the_diagnosis_is_sure(interval, sure):
    moved = Moved(before=1.0, after=0.5, std=0.25, unit="Ω", interval_95=interval)
    assert battery_is_another({"internal_resistance_ohm": moved}) is sure


def test_what_is_adopted_of_one_motor_leaves_the_others_in_peace(tmp_path):
    """Twelve seconds of one motor hardly tell the battery's resistance, which all three share."""
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": -0.045}}))
    outcome = run(
        rig,
        24.0,
        ports=("a", "b", "c"),
        sensors={1: "touch", 3: "light", 4: "ultrasonic"},
        candidates=DEFAULT_CANDIDATES,
        adopter=Adopter(AtOnce()),
    )
    assert "adopted" in outcome.kinds()
    assert {event.port for event in outcome.memory.events if event.kind == "divergence"} == {"a"}


def test_a_twin_goes_on_where_it_is_when_its_model_is_replaced():
    """Also where time has passed since the last count: the other motors were read meanwhile."""
    twin = BrickTwin({"a": nxt_motor()}, TwinOptions(candidates=("constant_load",)))
    twin.read_tacho("a", 0.0, 0)
    twin.command("a", 80, "drive", 0.0)
    for n in range(1, 40):
        twin.move(0.01 * n)
        twin.read_tacho("a", 0.01 * n, int(twin.state("a").angle_deg // 1))
    twin.move(0.405)
    before = twin.state("a")
    assert before.speed_deg_per_s > 500.0
    twin.adopt("a", nxt_motor(), 0.0)
    after = twin.state("a")
    assert after.angle_deg == pytest.approx(before.angle_deg, abs=1e-6)
    assert after.speed_deg_per_s == pytest.approx(before.speed_deg_per_s, rel=1e-9)


def test_a_session_in_which_all_held_says_so():
    assert verdict([], [], SEEN).outcome == "holds"


@pytest.mark.parametrize(
    ("seen", "outcome", "words"),
    [
        (Seen(0, 30.0, 0.0), "unseen", "nothing was seen: the brick answered no poll"),
        (Seen(40, 30.0, 25.0), "unseen", "too little was seen: the link was lost for 25.0 of 30.0 s"),
        (Seen(400, 30.0, 5.0), "holds", "holds where it was seen; the link was lost for 5.0 of 30.0 s"),
    ],
)
def test_where_little_was_seen_nothing_is_claimed(seen, outcome, words):
    said = verdict([], [], seen)
    assert said.outcome == outcome
    assert words in said.sentence


def test_the_headline_names_every_effect_that_was_taken_over():
    def adopted(*effects, port="a"):
        return Event(1.0, "adopted", f"port {port.upper()}: words of {len(effects)}", port, effects=effects)

    events = [adopted("a spring"), adopted("a load", "stiction"), adopted(), adopted("play", port="b")]
    sentence = verdict(events, [], SEEN).sentence
    assert sentence == (
        "brick and model agree again: port A: the model now has a spring, a load, stiction, "
        "with its parameters re-fitted later; port B: words of 1"
    )
    assert verdict([adopted()], [], SEEN).sentence.endswith(": port A: words of 0")


class _Answering:
    """Answers every diagnosis with a re-fit of the plant to another resistance."""

    def __init__(self, resistance_ohm):
        self._resistance_ohm = resistance_ohm

    def submit(self, _, case, plant, port):
        config = plant.to_config() | {"resistance_ohm": self._resistance_ohm}
        diagnosis = SimpleNamespace(effects=(), verdict="adequate", refit={})
        answer = SimpleNamespace(diagnosis=diagnosis, plant=plant_from_config(config, "power_pct"))
        return AtOnce().submit(lambda: (answer, gain(plant, answer.plant, case.recordings[0], port)))

    def shutdown(self, **_):
        pass


@pytest.mark.parametrize(("resistance_ohm", "adopted"), [(7.6, False), (9.9, True)])
def test_a_refit_is_taken_over_only_if_it_gains_something(tmp_path, resistance_ohm, adopted):
    rig = Rig(world_with(tmp_path, resistance_ohm=9.9))
    outcome = run(rig, 8.0, adopter=Adopter(_Answering(resistance_ohm), enough_s=2.0))
    assert ("adopted" in outcome.kinds()) == adopted
    if not adopted:
        assert "re-fitted parameters do not improve the model" in outcome.first("undiagnosed").words


def test_what_the_others_draw_is_not_taken_for_a_weak_battery():
    """Three motors that are driven alike: to one of them the battery looks three times as soft as it is."""
    twin = BrickTwin(dict.fromkeys("abc", nxt_motor()), TwinOptions(candidates=(), cells_ohm=0.4))
    for poll in range(100):
        twin.move(0.01 * poll)
        for port in "abc":
            twin.read_tacho(port, 0.01 * poll, int(twin.state(port).angle_deg // 1))
            twin.command(port, 70 if poll < 50 else -70, "drive", 0.01 * poll)
    seen = twin.plant_as_run("a")
    assert seen.values[Slot("battery_sag", "internal")] == pytest.approx(1.2, rel=0.05)
    twin.adopt("a", seen, began_s=0.0)
    assert twin.plant_as_run("b").values[Slot("battery_sag", "internal")] == pytest.approx(1.2, rel=0.05)
    alone = BrickTwin({"a": nxt_motor()}, TwinOptions(candidates=(), cells_ohm=0.4))
    assert alone.plant_as_run("a").values[Slot("battery_sag", "internal")] == 0.4
