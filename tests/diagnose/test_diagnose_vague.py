"""Found effects whose size is hardly clear of zero."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose_records import FOUND

from nxt_twin.diagnose.diagnosis import Estimate, Ratio
from nxt_twin.diagnose.telling import estimates
from nxt_twin.diagnose.telling.estimates import vague_effect


@pytest.fixture
def judged(monkeypatch):
    """Which of some effects is vague, by their sizes' standard deviations over these sizes."""

    def judge(*doubts, nearer=0.5, law=""):
        found = [SimpleNamespace(id=str(n), supersedes=law, neutral=0.0) for n in range(len(doubts))]
        sizes = {str(n): SimpleNamespace(value=2.0, std=2.0 * doubt) for n, doubt in enumerate(doubts)}
        monkeypatch.setattr(
            estimates,
            "estimates",
            lambda _, effect: {"size": SimpleNamespace(**vars(sizes[effect.id]), ratio=None)},
        )
        evidence = SimpleNamespace(
            explanation=SimpleNamespace(found=[(effect, None) for effect in found]),
            record=replace(FOUND, nearer=nearer),
        )
        vague = vague_effect(evidence)
        return vague and int(vague.id)

    return judge


def test_of_several_effects_the_weakest_vague_one_goes(judged):
    assert judged(0.76, 0.8, 0.74) == 1
    assert judged(0.75, 0.75) is None


def test_one_vague_effect_stays_where_it_brings_a_simulation_nearer(judged):
    assert judged(0.9, nearer=0.979) is None
    assert judged(0.9, nearer=0.98) == 0
    assert judged(0.75, nearer=0.98) is None


@pytest.mark.parametrize(
    ("std", "ratio_std", "vague"), [(1.6, 80.0, 0), (1.4, 80.0, None), (1.6, 70.0, None), (1.4, 70.0, None)]
)
def test_a_size_is_vague_where_it_is_so_by_itself_and_over_the_inertia(monkeypatch, std, ratio_std, vague):
    size = Estimate(2.0, std, "N·m", ratio=Ratio(100.0, ratio_std, "1/s²", "inertia_kg_m2"))
    monkeypatch.setattr(estimates, "estimates", lambda *_: {"size": size})
    effect = SimpleNamespace(id="0", supersedes="", neutral=0.0)
    found = SimpleNamespace(found=[(effect, None)])
    told = vague_effect(SimpleNamespace(explanation=found, record=replace(FOUND, nearer=0.98)))
    assert (told and int(told.id)) == vague


def test_what_stands_for_both_directions_is_no_size(judged):
    assert judged(0.9, 0.9, law="coulomb_friction") is None
