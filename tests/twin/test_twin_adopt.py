"""From a divergence to an adopted effect, and calm."""

from concurrent.futures import Future
from types import SimpleNamespace

import numpy as np
import pytest
from twin_feed import nxt_motor
from twin_rig import Rig, run, world_with

from nxt_twin.diagnose.diagnosis import Moved, Tolerance
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.stepper import Stepper
from nxt_twin.twin.adopt import (
    Adopter,
    AtOnce,
    Finished,
    adoption_events,
    battery_is_another,
    leaning_to,
    weak_battery,
    why_not,
)
from nxt_twin.twin.apart import Apart
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import Hold
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.gain import Gain
from nxt_twin.twin.records import Event
from nxt_twin.twin.verdict import Seen, verdict

SEEN = Seen(1000, 30.0, 0.0)


def test_a_load_is_found_adopted_and_the_divergence_vanishes(tmp_path):
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": 0.05}}))
    adopter = Adopter(AtOnce())
    outcome = run(rig, 28.0, candidates=DEFAULT_CANDIDATES, period_s=0.02, adopter=adopter)
    kinds = outcome.kinds()
    assert kinds.index("divergence") < kinds.index("effect_named") < kinds.index("adopted")
    assert kinds[-2:] == ["calm", "stopped"]
    assert kinds.count("divergence") == 1
    assert not outcome.session.monitors["a"].diverging
    ((port, diagnosis),) = adopter.diagnoses  # the first is right
    assert port == "a"
    assert [effect.id for effect in diagnosis.effects] == ["constant_load"]
    assert outcome.first("adopted").effects == ("constant load",)
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
        (ZeroDivisionError("by nothing"), "an error in nxt-twin (ZeroDivisionError: by nothing)"),
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


@pytest.mark.slow
def test_what_is_adopted_of_one_motor_leaves_the_others_in_peace(tmp_path):
    """Twelve seconds of one motor hardly tell the battery's resistance, which all three share."""
    rig = Rig(world_with(tmp_path, effects={"constant_load": {"load_torque_nm": -0.045}}))
    outcome = run(
        rig,
        15.0,
        ports=("a", "b", "c"),
        sensors={1: "touch", 3: "light", 4: "ultrasonic"},
        candidates=DEFAULT_CANDIDATES,
        period_s=0.02,
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


def test_a_twin_knows_that_its_encoder_is_off_its_centre():
    """The filter compares with what the encoder shows, not with where the motor is."""
    off = nxt_motor().with_effect("encoder_eccentricity", {"amplitude": 0.1, "cycles": 4.0, "phase": 0.5})
    options = TwinOptions(candidates=())
    truth = Stepper([off])
    knowing, unknowing = BrickTwin({"a": off}, options), BrickTwin({"a": nxt_motor()}, options)
    squares = {knowing: [], unknowing: []}
    for twin in squares:
        twin.command("a", 40, "drive", 0.0)
    for n in range(1, 201):
        for _ in range(10):
            truth.step(np.array([0.4]), np.array([0]), knowing.supply_v, 1e-3)
        for twin, found in squares.items():
            shown = int(np.degrees(truth.shown[0]) // 1)
            found.append(twin.read_tacho("a", 0.01 * n, shown).believed.normalised_square)
    assert np.mean(squares[knowing]) < 1.5
    assert np.mean(squares[unknowing]) > 2.0 * np.mean(squares[knowing])
    unknowing.adopt("a", off, 0.0)
    after = unknowing.read_tacho("a", 2.01, int(np.degrees(truth.shown[0] + 0.01 * truth.speed[0]) // 1))
    assert after.innovation.normalised_square < 9.0


def test_a_winding_is_as_warm_as_it_was_when_its_model_is_replaced():
    """What was adopted counts from where the diagnosed recording began: by then the winding is warm already."""
    warm = nxt_motor().with_effect("winding_heating", {"rise": 5.0, "thermal_time": 20.0})
    given, plain = BrickTwin({"a": warm, "b": warm}), BrickTwin({"a": nxt_motor(), "b": warm})
    for twin in (given, plain):
        for port in "ab":
            twin.read_tacho(port, 0.0, 0)
            twin.command(port, 90, "brake" if port == "b" else "drive", 0.0)
        twin.move(4.0)
    plain.adopt("a", warm, 0.0, [(0.0, Hold(0.0, 0.9, 0))])
    for twin in (given, plain):
        twin.move(4.5)
    assert plain.state("a").speed_deg_per_s == pytest.approx(given.state("a").speed_deg_per_s, rel=2e-3)
    fresh = BrickTwin({"a": nxt_motor()})
    fresh.read_tacho("a", 0.0, 0)
    fresh.command("a", 90, "drive", 0.0)
    fresh.move(4.0)
    fresh.adopt("a", warm, 4.0)
    fresh.move(4.5)
    assert fresh.state("a").speed_deg_per_s > 1.01 * given.state("a").speed_deg_per_s


def test_a_session_in_which_all_held_says_so():
    assert verdict([], [], SEEN).outcome == "holds"


@pytest.mark.parametrize(
    ("seen", "outcome", "words"),
    [
        (Seen(0, 30.0, 0.0), "unseen", "the brick answered no poll"),
        (
            Seen(40, 30.0, 25.0),
            "unseen",
            "the link was lost for 25.0 of 30.0 s, so this session does not judge",
        ),
        (
            Seen(400, 30.0, 5.0),
            "holds",
            "holds wherever the brick answered; the link was lost for 5.0 of 30.0 s",
        ),
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
        "brick and model agree again; port A: the model now has a spring, a load, stiction, "
        "with its parameters re-fitted later; port B: words of 1"
    )
    assert verdict([adopted()], [], SEEN).sentence.endswith("; port A: words of 0")


def test_names_that_take_the_place_of_others_are_all_that_the_headline_has():
    events = [
        Event(1.0, "adopted", "words", "a", effects=effects, instead=instead)
        for effects, instead in ((("a load",), False), (("a spring",), True), ((), False))
    ]
    assert "the model now has a spring, with" in verdict(events, [], SEEN).sentence


@pytest.mark.parametrize(
    ("names", "improved", "after_deg", "kept"),
    [(1, 0.5, 0.5, False), (1, 0.2, 9.0, False), (1, 0.5, 9.0, True), (0, 0.5, 0.5, True)],
)
def test_names_beside_what_is_unexplained_are_worth_what_either_error_says(names, improved, after_deg, kept):
    fit = SimpleNamespace(improved=improved, baseline=0.46)
    found = SimpleNamespace(verdict="unexplained", effects=("shaft",) * names, fit=fit)
    assert bool(why_not(found, Gain(10.0, after_deg), named=bool(names))) == kept


def test_what_is_not_weighed_shares_with_the_weighed_effect_that_it_looks_like():
    weighed = {"constant_load": 0.9, "stiction": 0.1, "nothing": 0.0}
    leaning = leaning_to(weighed, nxt_motor())
    assert leaning["asymmetric_friction"] == leaning["constant_load"] > 0.0
    assert "stiction" not in leaning
    assert leaning_to({"nothing": 0.95, "unknown": 0.05}, nxt_motor()) == {}
    assert leaning_to({"stiction": 0.6, "unknown": 0.4}, nxt_motor()) == {}


@pytest.mark.parametrize(
    ("std", "leaning_nats", "named"),
    [(0.2, 0.0, True), (2.0, 0.0, False), (2.0, 3.0, True), (2.0, 0.5, False)],
)
def test_a_battery_far_weaker_than_is_taken_for_granted_has_a_name(std, leaning_nats, named):
    moved = Moved(before=0.35, after=1.5, std=std, unit="Ω")
    found = {"effects": (), "refit": {"internal_resistance_ohm": moved}, "verdict": "adequate"}
    assert weak_battery(SimpleNamespace(**found, tolerance=Tolerance(0.5, "deg", 3.0)), leaning_nats) == 0.0
    diagnosis = SimpleNamespace(**found, tolerance=Tolerance(0.5, "deg", 1.0))
    weak = weak_battery(diagnosis, leaning_nats)
    *_, adopted = adoption_events(Finished("a", 0.0, 12.0, None, "", Gain(4.4, 0.7), weak), diagnosis, 20.0)
    assert adopted.effects == (("battery sag",) if named else ())
    assert adopted.words.endswith("(free-run error 4.4 deg before, 0.7 deg after)")


def test_a_short_peace_does_not_end_a_divergence():
    apart = Apart()
    assert apart.since("a", 5.0, 6.0) == 5.0
    assert apart.since("a", 20.0, 22.0) == 5.0
    assert apart.since("a", 60.0, 61.0) == 60.0
    apart.forget("a")
    assert apart.since("a", 62.0, 63.0) == 62.0


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
