"""An encoder that loses each count by chance: what is left is no other physics, but what chance leaves."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.fitting.noise import LOST
from nxt_twin.diagnose.judging.floors import synthetic
from nxt_twin.diagnose.judging.intervals import covariance_of, robust_covariance
from nxt_twin.diagnose.search.losing import chance_alone
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator

LOSS = 0.12
ABOVE_DEG_S = 300.0


def losing(case, rng):
    """`case` read by an encoder that misses each count above a speed with the chance `LOSS`."""
    made = []
    for run in (*case.recordings, *case.holdout):
        columns = {name: values.copy() for name, values in run.columns.items()}
        read = np.isfinite(columns["a_tacho_deg"])
        time_s, counts = columns["time_s"][read], columns["a_tacho_deg"][read]
        moved = np.diff(counts)
        fast = np.abs(moved) > ABOVE_DEG_S * np.diff(time_s)
        lost = np.sign(moved) * rng.binomial(np.abs(moved).astype(int), np.where(fast, LOSS, 0.0))
        columns["a_tacho_deg"][read] = counts[0] + np.concatenate([[0.0], np.cumsum(moved - lost)])
        made.append(replace(run, columns=columns))
    count = len(case.recordings)
    return replace(case, recordings=tuple(made[:count]), holdout=tuple(made[count:]))


@pytest.fixture(scope="module")
def case():
    return losing(concealed((), seed=152, seconds=12.0), np.random.default_rng(3))


def test_counts_that_are_lost_by_chance_are_named(case):
    diagnosis = diagnose(case).diagnosis
    assert diagnosis.verdict == "explained"
    (found,) = diagnosis.effects
    assert found.id == "missed_counts"
    assert found.params["loss_fraction"].value == pytest.approx(LOSS, abs=0.03)


def test_the_noise_tells_chance_from_a_share_of_all_counts(case):
    for readings, by_chance in ((case, True), (concealed(("missed_counts",), seed=152, seconds=12.0), False)):
        problem = problem_for(readings)
        with Simulator(problem.plant.layout) as simulator:
            fits = Fits(simulator, problem)
            effect = problem.plant.layout.effect("missed_counts")
            plant = problem.plant.with_effect(effect.id, fits.starts(effect)[0])
            found = fits.settled(plant, fits.settled_baseline().noise)
        share = found.plant.values[Slot("missed_counts", "loss")]
        assert found.noise.slip == (
            pytest.approx(share * (1.0 - share) * np.radians(1.0), rel=0.1) if by_chance else 0.0
        )


def test_chance_alone_makes_readings_likelier_only_where_counts_are_lost(case):
    gains, noises = [], []
    for readings in (case, concealed((), seed=152, seconds=12.0)):
        problem = problem_for(readings)
        with Simulator(problem.plant.layout) as simulator:
            fits = Fits(simulator, problem)
            gain, share, noise = chance_alone(fits, fits.settled_baseline())
        gains.append(gain)
        noises.append((share, noise.slip))
    assert gains[0] > 100.0
    assert gains[1] < 0.0
    assert noises[0] == (0.1, pytest.approx(0.09 * np.radians(1.0)))


def test_the_scatter_of_lost_counts_tells_their_share(case):
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        fits = Fits(simulator, problem)
        effect = problem.plant.layout.effect("missed_counts")
        plant = problem.plant.with_effect(effect.id, fits.starts(effect)[0])
        found = fits.settled(plant, fits.settled_baseline().noise)
        final = fits.everything(found.plant, found.noise)
        linear = linearise(simulator, problem, final)
        without, told = robust_covariance(simulator, linear), covariance_of(simulator, problem, linear)
        still = replace(linear, structure=replace(final, noise=replace(final.noise, slip=0.0)))
        untold = covariance_of(simulator, problem, still)
    place = [variable.slots[0] for variable in linear.variables].index(LOST)
    assert told[place, place] < 0.8 * without[place, place]
    assert np.linalg.eigvalsh(told).min() > -1e-12 * np.linalg.eigvalsh(told).max()
    np.testing.assert_allclose(untold, without, rtol=1e-6, atol=1e-12)


def test_a_synthetic_recording_has_the_chance_in_it(case):
    problem = problem_for(case)
    with Simulator(problem.plant.layout) as simulator:
        fits = Fits(simulator, problem)
        noise = replace(fits.first_noise(), disturbance_std=1e-6)
        signals = problem.signals[0]

        def off(slip):
            rng = np.random.default_rng(1)
            made = synthetic(simulator, problem.plant, signals, replace(noise, slip=slip), rng)
            return np.nanstd(
                made.measured - synthetic(simulator, problem.plant, signals, noise, rng).measured
            )

        turned_rad = np.nansum(np.abs(np.diff(signals.measured)))
        assert off(0.0) < 2.0 * noise.reading_std
        assert off(1e-3) > 0.2 * np.sqrt(1e-3 * turned_rad)
