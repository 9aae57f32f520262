"""By how much doubted readings were late."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting.lateness import lateness_s


def told(late_s, speed, doubted):
    """The lateness of readings of a plant that turns at `speed`, of which some are doubted and late by `late_s`."""
    late_s, speed, doubted = (np.asarray(each) for each in (late_s, speed, doubted))
    predicted = np.cumsum(speed * 0.01)
    signals = SimpleNamespace(measured=predicted - speed * late_s)
    job = SimpleNamespace(signals=signals, start=SimpleNamespace(at=np.arange(speed.size) == 0))
    trace = {"predicted": predicted, "speed": speed, "weight": np.where(doubted, 0.1, 0.9)}
    tuned = SimpleNamespace(predicting=lambda: SimpleNamespace(jobs=(job,)))
    fitter = SimpleNamespace(tuned=lambda *_: tuned, simulator=SimpleNamespace(trace=lambda *_: trace))
    plant = SimpleNamespace(effects=(), values={})
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
