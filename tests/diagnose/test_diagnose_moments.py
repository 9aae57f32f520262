"""In which seconds one structure gains over another."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.fitting import moments

TIME_S = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5])


LATE = SimpleNamespace(terms={"outlier": None})
DRAG = SimpleNamespace(terms={"friction": None})


def structure(costs, *effects, noise=None):
    """A structure under which readings cost these nats."""
    vectors = np.array(costs), np.ones(len(costs))
    return SimpleNamespace(plant=SimpleNamespace(vectors=lambda: vectors, effects=effects), noise=noise)


@pytest.fixture
def gains(monkeypatch):
    """A function of costs under the simpler and the richer structure, that gives what `moments` says of them."""
    monkeypatch.setattr(moments, "SETTLED", SimpleNamespace(step_for=lambda _: 1e-3))
    job = SimpleNamespace(signals=SimpleNamespace(name="r1.csv", time_s=TIME_S))
    tuned = SimpleNamespace(predicting=lambda: SimpleNamespace(jobs=(job,)))

    def run(values, *_):
        return [SimpleNamespace(cost=values)]

    def told(of, simpler, richer):
        fitter = SimpleNamespace(tuned=lambda *_: tuned, simulator=SimpleNamespace(run=run))
        return of(fitter, structure(simpler), structure(richer))

    return told


def test_a_gain_that_every_second_shares_comes_from_all_of_them(gains):
    assert gains(moments.moments_gained, [3.0] * 6, [1.0] * 6) == pytest.approx(3.0)
    assert gains(moments.gained_elsewhere, [3.0] * 6, [1.0] * 6) == pytest.approx(8.0)


def test_a_gain_of_one_second_is_nothing_elsewhere(gains):
    once = [1.0, 1.0, 90.0, 1.0, 1.0, 1.0]
    assert gains(moments.moments_gained, once, [1.0] * 6) == pytest.approx(1.0)
    assert gains(moments.gained_elsewhere, once, [1.0] * 6) == pytest.approx(0.0)


def test_what_other_seconds_lose_counts_against_it(gains):
    assert gains(moments.gained_elsewhere, [50.0, 1.0, 1.0, 1.0, 1.0, 1.0], [1.0] * 5 + [4.0]) == -3.0


@pytest.mark.parametrize(
    ("simpler", "richer", "under"),
    [
        ((), (DRAG,), "simpler"),
        ((DRAG,), (DRAG, LATE), "richer"),
        ((LATE,), (LATE, DRAG), "simpler"),
    ],
)
def test_doubted_readings_are_weighed_under_the_noise_that_does_not_hide_them(
    monkeypatch, simpler, richer, under
):
    monkeypatch.setattr(moments, "SETTLED", SimpleNamespace(step_for=lambda _: 1e-3))
    asked = []
    jobs = SimpleNamespace(predicting=lambda: SimpleNamespace(jobs=()))
    fitter = SimpleNamespace(
        tuned=lambda noise, _: asked.append(noise) or jobs, simulator=SimpleNamespace(run=lambda *_: [])
    )
    made = [
        structure([1.0], *effects, noise=name) for effects, name in ((simpler, "simpler"), (richer, "richer"))
    ]
    moments._gained(fitter, *made)
    assert asked == [under]
