"""A free function beside the effects that were found: its sizes, and what it does to a simulation."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import final

import numpy as np
import pytest
from diagnose_records import FOUND

from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.judging.verdict import Record
from nxt_twin.diagnose.where import beyond
from nxt_twin.diagnose.where.beyond import with_shapes
from nxt_twin.diagnose.where.marginal import likeliest
from nxt_twin.diagnose.where.rested import RESTED
from nxt_twin.diagnose.where.setting_in import SETTING_IN, kin_of
from nxt_twin.physics.effects.binding import PRESLIDING
from nxt_twin.physics.effects.encoder import MISSED_COUNTS
from nxt_twin.physics.effects.friction import QUADRATIC_DRAG, STICTION, VISCOUS_FRICTION
from nxt_twin.physics.effects.load import COGGING, GRAVITY_LOAD, SPRING_LOAD
from nxt_twin.physics.effects.stop import END_STOP
from nxt_twin.physics.effects.transmission import BACKLASH

READINGS = 400
STEP_S = 0.01


def linear(innovations, slopes):
    """A fitted structure of which only a regression is known."""
    nothing = SimpleNamespace()
    return Linear(
        structure=nothing,
        jobs=(),
        counted=(),
        innovations=innovations,
        slopes=slopes,
        tightness=np.full(len(slopes), 1e-6),
        run=np.zeros(READINGS, dtype=np.int64),
        time_s=np.arange(READINGS) * STEP_S,
        checks=np.zeros(READINGS, dtype=np.bool_),
        gain=(),
        predicted=(),
    )


def drawn():
    rng = np.random.default_rng(5)
    return rng.normal(size=READINGS), rng.normal(size=(2, READINGS)), rng.normal(size=(3, READINGS))


def test_missing_rows_gain_beside_the_variables_of_a_refit():
    noise, slopes, rows = drawn()
    innovations = noise + np.array([3.0, 0.0, -2.0]) @ rows + np.array([0.5, -1.0]) @ slopes
    assert likeliest(linear(innovations, slopes), [rows[:, :150], rows[:, 150:]]) > 500.0


def test_noise_alone_asks_for_no_rows():
    noise, slopes, rows = drawn()
    assert likeliest(linear(noise, slopes), [rows]) < 3.0


def test_without_a_found_effect_no_shape_is_asked():
    evidence = SimpleNamespace(record=SimpleNamespace(found=False))
    assert with_shapes(SimpleNamespace(), evidence) is evidence


@pytest.fixture
def heard(monkeypatch):
    """Shapes that gain 30 nats, those of the time at rest 50, and a drag that sets in at a speed 70."""
    drags = SETTING_IN["high_speed"]

    def gain(_scene, _linear, shape):
        return 70.0 if shape in drags else 50.0 if shape in RESTED else 30.0

    monkeypatch.setattr(beyond, "staged", lambda *_: None)
    monkeypatch.setattr(beyond, "heard", gain)
    monkeypatch.setattr(beyond, "sober_nats", lambda *_: 20.0)


@final
@dataclass(frozen=True)
class Told:
    """The part of an evidence that shapes are asked by."""

    record: Record
    explanation: object
    problem: object = None
    final: object = None
    linear: object = field(default_factory=lambda: SimpleNamespace(structure=None))


def told(effect, remaining, colour=1.0):
    evidence = Told(
        replace(FOUND, remaining=remaining, colour=colour), SimpleNamespace(found=[(effect, None)])
    )
    return with_shapes(None, evidence).record


@pytest.mark.usefixtures("heard")
def test_effects_that_windows_told_are_only_asked_for_laws_under_a_soberer_torque():
    evidence = Told(replace(FOUND, by_windows=True), SimpleNamespace(found=[(STICTION, None)]))
    assert with_shapes(None, evidence).record == replace(FOUND, by_windows=True, sober_nats=20.0)


@pytest.mark.usefixtures("heard")
def test_the_time_at_rest_is_asked_whatever_error_is_left():
    record = told(STICTION, 3.0)
    assert (record.rested_nats, record.kin_nats) == (50.0, 0.0)


@pytest.mark.usefixtures("heard")
@pytest.mark.parametrize("effect", [COGGING, END_STOP, SPRING_LOAD])
def test_what_is_no_friction_at_low_speed_is_not_asked_for_the_time_at_rest(effect):
    assert told(effect, 0.1).rested_nats == 0.0


@pytest.mark.usefixtures("heard")
@pytest.mark.parametrize("effect", [PRESLIDING, BACKLASH, MISSED_COUNTS])
def test_what_moves_on_at_rest_or_reads_amiss_is_not_asked_for_the_time_at_rest(effect):
    assert told(effect, 0.1).rested_nats == 0.0


@pytest.mark.usefixtures("heard")
def test_a_drag_is_held_against_one_that_sets_in_at_a_speed():
    assert told(QUADRATIC_DRAG, 0.1).kin_nats == 70.0


@pytest.mark.parametrize(
    ("effect", "regime"),
    [
        (QUADRATIC_DRAG, "high_speed"),
        (SPRING_LOAD, "angle"),
        (GRAVITY_LOAD, "angle"),
        (STICTION, None),
        (VISCOUS_FRICTION, None),
        (MISSED_COUNTS, None),
    ],
)
def test_torques_of_one_regime_alone_have_kin_that_sets_in_there(effect, regime):
    assert kin_of(effect) == (SETTING_IN[regime] if regime else ())


def test_what_sets_in_is_nought_up_to_there_and_grows_from_there():
    course = SimpleNamespace(pace=np.linspace(-4.0, 4.0, 601), passed=np.linspace(-1.0, 1.0, 601))
    unit = SimpleNamespace(speed=2.0, places=np.array([-1.0, 0.0, 1.0]))
    for family in SETTING_IN["high_speed"]:
        straight, bent = family.rows(course, unit)
        assert not straight[np.abs(course.pace) < 0.5].any()
        assert np.all(np.diff(straight) >= 0.0)
        assert straight[-1] == -straight[0] > 0.0
        assert bent == pytest.approx(straight * np.abs(straight))
    starts = [np.flatnonzero(family.rows(course, unit)[0])[0] for family in SETTING_IN["angle"]]
    assert course.passed[starts] == pytest.approx(np.linspace(-0.8, 0.8, 9), abs=0.01)
    pull, growing = SETTING_IN["angle"][4].rows(course, unit)
    assert set(pull) == {0.0, 1.0}
    assert (growing[0], growing[-1]) == (0.0, pytest.approx(0.5))


def test_drags_set_in_at_six_shares_of_the_usual_speed_and_pulls_at_nine_of_the_reach():
    unit = SimpleNamespace(speed=2.0, places=np.array([-1.0, 0.0, 1.0]))
    for kind, shares in (
        ("high_speed", (0.25, 0.45, 0.7, 1.0, 1.3, 1.6)),
        ("angle", (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)),
    ):
        for family, share in zip(SETTING_IN[kind], shares, strict=True):
            around = share + np.array([-1e-3, 1e-3])
            course = SimpleNamespace(pace=2.0 * around, passed=2.0 * around - 1.0)
            below, above = family.rows(course, unit).T
            assert not below.any()
            assert above.all()
