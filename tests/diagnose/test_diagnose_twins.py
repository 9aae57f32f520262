"""Friction by direction and a load that friction hides move a motor alike. A load may have any size: friction wins."""

from types import SimpleNamespace

import pytest
from diagnose_limits import effect_named, search, structure

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.notable import is_notable, is_too_small
from nxt_twin.diagnose.search.rivals import likelier_structure
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config

HEAVY = plant_from_config({"kind": "dc_motor", **NOMINAL, "coulomb_friction_nm": 0.04}, "power_pct")


def rival(monkeypatch, behind, *, found, twins=True, worse=False):
    """The other of two twins in the place of the found one, which is likelier by `behind`."""
    against = {"load": LIMITS.coincidence_nats, "friction": 0.0}
    other = next(name for name in against if name != found)
    monkeypatch.setattr(explaining, "weigh", lambda *_: Weight(behind, 0.0, 1.0, runs_worse=False))
    monkeypatch.setattr(explaining, "are_twins", lambda *_: twins)
    monkeypatch.setattr(explaining, "simulates_worse", lambda *_: worse)
    monkeypatch.setattr(explaining, "coincidence_nats", lambda _, effect: against[effect.id])
    own = search(_standard=SimpleNamespace(leaning=lambda _: 0.0))
    return own._rival(structure(), effect_named(found), effect_named(other), structure())


@pytest.mark.parametrize("behind", [-148.0, 0.0, 148.0])
@pytest.mark.parametrize("worse", [False, True])
def test_a_hidden_load_gives_way_to_friction_whatever_likelihood_says(monkeypatch, behind, worse):
    assert likelier_structure({"load": (rival(monkeypatch, behind, found="load", worse=worse),)})
    assert not likelier_structure({"friction": (rival(monkeypatch, behind, found="friction"),)})


def test_what_is_no_twin_or_clearly_likelier_stays(monkeypatch):
    assert not likelier_structure({"load": (rival(monkeypatch, 148.0, found="load", twins=False),)})
    assert not likelier_structure({"load": (rival(monkeypatch, 152.0, found="load"),)})
    assert not likelier_structure({"load": (rival(monkeypatch, 0.0, found="load", twins=False, worse=True),)})


@pytest.mark.parametrize(("apart", "named"), [(0.052, True), (0.048, False)])
def test_friction_has_directions_from_a_twentieth_apart_on(apart, named):
    effect = HEAVY.layout.effect("asymmetric_friction")
    plant = HEAVY.with_effect(effect.id, {"forward": 0.06 * (1.0 + apart), "reverse": 0.06 * (1.0 - apart)})
    assert is_notable(plant, effect, NXT_SCALE) is named
    assert is_too_small(plant, effect, NXT_SCALE) is not named


@pytest.mark.parametrize(("share", "named"), [(0.052, True), (-0.052, True), (0.048, False)])
def test_a_load_has_a_name_from_a_twentieth_of_friction_on(share, named):
    effect = HEAVY.layout.effect("constant_load")
    plant = HEAVY.with_effect(effect.id, {"load": share * 0.04})
    assert is_notable(plant, effect, NXT_SCALE) is named
