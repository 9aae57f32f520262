from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import clean_case

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.residuals import Residuals
from nxt_twin.diagnose.judging.judge import leftover_nats, stale_readings
from nxt_twin.diagnose.where.locate import regimes, spells

SIZE = 3000


def made_residuals(*, seed, missing=0.0):
    """White innovations, and where `missing` is not 0 a part that goes with low speed."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(SIZE) * 0.01
    speed = 5.0 * np.sin(1.3 * time_s) + 3.0 * np.sin(2.9 * time_s + seed)
    shape = missing * np.sign(speed) * (np.abs(speed) < 0.5)
    zeros = np.zeros(SIZE)
    return Residuals(
        run=np.zeros(SIZE, dtype=np.int64),
        time_s=time_s,
        normalised=rng.normal(size=SIZE) + shape,
        position=np.cumsum(speed) * 0.01,
        speed=speed,
        acceleration=rng.normal(size=SIZE),
        command=rng.normal(size=SIZE),
        since_command_s=np.mod(time_s, 0.4),
        command_change=np.repeat(rng.uniform(-1, 1, SIZE // 40), 40),
        gap_s=np.full(SIZE, 0.01),
        drive=rng.normal(size=SIZE),
        unknown=zeros,
    )


def test_white_innovations_leave_nothing_to_foretell():
    assert max(leftover_nats(made_residuals(seed=seed)) for seed in range(20)) < 10.0


def test_a_part_that_follows_the_speed_is_foretold():
    assert leftover_nats(made_residuals(seed=1, missing=2.0)) > 50.0


def test_the_regime_in_which_the_mismatch_gathers_comes_first():
    found = regimes(made_residuals(seed=2, missing=2.5), seed=0)
    assert found[0].regime == "low_speed"
    assert found[0].p_value < 0.01


def test_white_innovations_have_no_regime_more_often_than_chance():
    reported = sum(len(regimes(made_residuals(seed=seed), seed=seed)) for seed in range(20))
    assert reported <= 20 * 10 * 0.02 * 3


def test_a_stretch_of_large_innovations_is_found_in_time():
    calm = made_residuals(seed=3)
    struck = calm.normalised.copy()
    struck[1200:1300] += 4.0
    found = spells(Residuals(**{**calm.__dict__, "normalised": struck}), ["run.csv"])
    assert found[0].recording == "run.csv"
    assert (found[0].start_s, found[0].end_s) == (12.0, 13.0)
    assert spells(calm, ["run.csv"]) == ()


@pytest.mark.parametrize(("doubted", "left_out"), [(0.0, 0.0), (0.45, 0.45), (0.55, 0.0), (1.0, 0.0)])
def test_a_plant_that_doubts_most_of_a_recording_does_not_choose_what_judges_it(doubted, left_out):
    problem = problem_for(clean_case(41))
    signals = problem.held_out[0].signals
    plant = problem.plant.with_effect("stale_samples", {"stale_fraction": 0.02})
    trust = np.where(np.arange(signals.time_s.size) < doubted * signals.time_s.size, 0.1, 0.9)
    simulator = SimpleNamespace(trace=lambda *_: {"weight": trust})
    noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
    stale = stale_readings(simulator, signals, plant, noise)
    assert np.mean(stale) == pytest.approx(left_out, abs=0.02)
