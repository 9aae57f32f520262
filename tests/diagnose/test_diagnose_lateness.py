"""By how much doubted readings were late."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting.lateness import lateness_s
from nxt_twin.physics.layout import Slot


def told(late_s, speed, doubted, stop=None):
    """The lateness of readings of a plant that turns at `speed`, of which some are doubted and late by `late_s`."""
    late_s, speed, doubted = (np.asarray(each) for each in (late_s, speed, doubted))
    predicted = np.cumsum(speed * 0.01)
    signals = SimpleNamespace(measured=predicted - speed * late_s)
    job = SimpleNamespace(signals=signals, start=SimpleNamespace(at=np.arange(speed.size) == 0))
    trace = {"predicted": predicted, "speed": speed, "weight": np.where(doubted, 0.1, 0.9)}
    tuned = SimpleNamespace(predicting=lambda: SimpleNamespace(jobs=(job,)))
    fitter = SimpleNamespace(tuned=lambda *_: tuned, simulator=SimpleNamespace(trace=lambda *_: trace))
    values = {} if stop is None else {Slot("end_stop", "limit"): stop}
    plant = SimpleNamespace(effects=(), values=values, layout=SimpleNamespace(frame="motor"))
    return lateness_s(fitter, SimpleNamespace(plant=plant, noise=None))


@pytest.fixture(autouse=True)
def any_step(monkeypatch):
    settled = SimpleNamespace(step_for=lambda _: 1e-3)
    monkeypatch.setattr("nxt_twin.diagnose.fitting.lateness.SETTLED", settled)


def test_it_is_the_age_of_doubted_readings_in_either_direction():
    turns = [10.0, -10.0, 10.0, -10.0]
    assert told([0.004] * 4, turns, [False, True, True, False]) == pytest.approx(0.004)


def test_readings_that_are_believed_do_not_count():
    assert told([0.0, 0.009, 0.002], [5.0, 5.0, 5.0], [False, False, True]) == pytest.approx(0.002)


def test_faster_turning_weighs_more():
    assert told([0.0, 0.001, 0.005], [1.0, 30.0, 10.0], [False, True, True]) == pytest.approx(0.002)


def test_readings_ahead_of_the_plant_are_not_late():
    assert told([0.0, -0.003], [8.0, 8.0], [False, True]) < 0.0


def test_nothing_doubted_is_no_lateness():
    assert told([0.0, 0.004], [8.0, 8.0], [False, False]) == 0.0


@pytest.mark.parametrize(("stop", "late"), [(None, True), (0.2, False), (-0.1, True), (5.0, True)])
def test_readings_that_are_doubted_at_a_stop_are_not_late(stop, late):
    """The motor turns on by 0.1 rad a reading, so that three of the doubted ones are within 0.25 rad of 0.2 rad."""
    found = told([0.004] * 5, [10.0] * 5, [False, True, True, True, False], stop)
    assert (found > 0.0) is late
