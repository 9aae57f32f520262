"""What counts as seen: a move above a reading's own error, an error after well above that before, a gap that opens."""

from types import SimpleNamespace

import numpy as np
import pytest
from test_diagnose_changed_weighing import fit_with

from nxt_twin.diagnose.changed.drift import with_drift
from nxt_twin.diagnose.changed.engine import ReadyPair
from nxt_twin.diagnose.changed.joint import JointFit
from nxt_twin.diagnose.changed.play import may_lose, shown_nats
from nxt_twin.diagnose.changed.seen import is_as_well, is_seen
from nxt_twin.physics.parameter import NXT_SCALE

STEP = 1.0
OWN_ERROR = STEP / 12.0**0.5


class Windows:
    """Stands in for a fitter: windows after end `moved` further with a change than without."""

    def __init__(self, moved):
        signals = SimpleNamespace(quantum=STEP)
        self.sides = (SimpleNamespace(jobs=(SimpleNamespace(signals=signals),)),)
        self.moved = moved

    def run(self, model, x, side, which):
        assert (side, which, x.shape[0]) == (1, "everything", 1)
        return np.full((1, 50), self.moved if model.changes else 0.0)


@pytest.mark.parametrize(("moved", "seen"), [(0.97, False), (1.03, True)])
def test_a_change_is_seen_that_moves_windows_by_more_than_a_readings_own_error(moved, seen):
    simpler, _ = fit_with({})
    wider, _ = fit_with({"viscous": 1.1})
    assert is_seen(Windows(moved * OWN_ERROR), simpler, wider) == seen


@pytest.mark.parametrize(
    ("errors", "wished", "predicted"),
    [
        ((0.4, 0.59), False, True),
        ((0.4, 0.61), False, False),
        ((0.4, 0.61), True, True),
        ((0.9, 1.01), True, False),
        ((0.9, 1.01), False, False),
    ],
)
def test_rough_readings_hide_no_error_that_grew_and_a_wished_tolerance_does(errors, wished, predicted):
    problem = SimpleNamespace(tolerance=1.0)
    joint, _ = fit_with({}, check_rms=errors)
    pair = ReadyPair((problem, problem), None, joint.model, wished)
    assert pair.is_predicted(joint) == predicted


@pytest.mark.parametrize(
    ("errors", "as_well"),
    [
        ((0.99, 1.9), True),
        ((1.2, 2.1), False),
        ((0.2, 0.39), True),
        ((0.2, 0.61), False),
        ((0.05, 0.59), True),
    ],
)
def test_a_search_ends_where_errors_are_as_small_as_those_before_alone_and_alike(errors, as_well):
    assert is_as_well(errors, alone=0.5, tolerance=1.0, as_read=0.3) == as_well


@pytest.mark.parametrize(
    ("gap_deg", "over_inertia", "over_tied", "shown"),
    [
        (6.0, 25.0, 13.0, 13.0),
        (6.0, 25.0, 11.0, 0.0),
        (6.0, 19.0, 50.0, 0.0),
        (2.9, 60.0, 60.0, 0.0),
        (3.1, 60.0, 50.0, 50.0),
        (3.9, 60.0, 31.0, 31.0),
        (3.9, 60.0, 29.0, 0.0),
        (4.1, 60.0, 29.0, 29.0),
    ],
)
def test_play_has_to_beat_inertia_and_a_second_body_without_play(gap_deg, over_inertia, over_tied, shown):
    assert shown_nats(np.radians(gap_deg), over_inertia, over_tied) == shown


def test_play_may_lose_in_longer_windows_half_of_what_close_ones_gain():
    assert may_lose(49.0, 100.0)
    assert not may_lose(51.0, 100.0)


def test_of_an_effect_that_the_plant_lacked_the_main_parameter_alone_may_differ():
    joint, _ = fit_with({})
    start = {"binding": 0.01, "cycles": 2.0, "phase": 0.0, "sharpness": 4.0}
    model = joint.model.lacking("angle_dependent_friction", start, NXT_SCALE)
    may = {model.ways[n].slot.symbol for n in model.may_differ}
    assert "binding" in may
    assert not {"cycles", "phase", "sharpness"} & may


class Rubbing:
    """Stands in for a fitter: viscous friction differs by a factor, and that gains."""

    def __init__(self, factor):
        self.factor = factor

    def fit(self, model, x):
        (n,) = model.differs
        found = np.array(x)
        found[len(model.shared)] = np.log(self.factor)
        viscous = model.ways[n].slot.symbol == "viscous"
        return JointFit(model, found, 0.01, -40.0 if viscous else 0.0, 0.0, (0.01, 0.01))


@pytest.mark.parametrize(("factor", "differs"), [(1.04, 1), (1.06, 0)])
def test_friction_that_drifts_as_from_run_to_run_is_nothing_unexplained(factor, differs):
    joint, _ = fit_with({})
    assert with_drift(Rubbing(factor), joint).model.changes == differs
