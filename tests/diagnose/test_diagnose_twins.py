"""Friction by direction and a load that friction hides move a motor alike. A load may have any size: friction wins."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_limits import effect_named, search, structure

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search.coincidence import as_twin
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.notable import is_notable, is_too_small
from nxt_twin.diagnose.search.rivals import likelier_structure
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest

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


@pytest.mark.parametrize("worse", [False, True])
def test_what_hardly_differs_is_told_by_likelihood_as_no_way_of_sticking_costs_as_little(monkeypatch, worse):
    assert not likelier_structure({"load": (rival(monkeypatch, 3.0, found="load", worse=worse),)})
    assert likelier_structure({"friction": (rival(monkeypatch, -3.0, found="friction", worse=worse),)})
    assert not likelier_structure({"friction": (rival(monkeypatch, -1.5, found="friction", worse=worse),)})


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


def simulated(plant):
    """The angle that `plant` turns to under a duty that goes back and forth, rad."""
    time_s = np.arange(0.0, 4.0, 0.01)
    signals = Signals(
        name="back and forth",
        channel="output",
        input_kind="power_pct",
        command_time_s=np.array([0.0, 0.2, 1.4, 2.5, 3.0]),
        command=np.array([0.0, 0.6, -0.5, 0.0, 0.4]),
        command_mode=np.zeros(5, dtype=np.int64),
        command_supply_v=np.full(5, NOMINAL["supply_v"]),
        time_s=time_s,
        measured=np.where(time_s == 0.0, 0.0, np.nan),
        is_speed=False,
        quantum=0.0,
    )
    with Simulator(plant.layout) as simulator:
        return simulator.trace(plant, free_job(signals, at_rest(signals)))["predicted"]


@pytest.mark.parametrize(
    ("found", "values"),
    [
        ("constant_load", {"load": 0.03}),
        ("constant_load", {"load": -0.01}),
        ("asymmetric_friction", {"forward": 0.02, "reverse": 0.05}),
    ],
)
def test_what_is_put_in_the_place_of_its_twin_moves_a_motor_alike(found, values):
    other = {"constant_load": "asymmetric_friction", "asymmetric_friction": "constant_load"}[found]
    effect = HEAVY.layout.effect
    plant = HEAVY.with_effect(found, values)
    twin = as_twin(plant, effect(found), effect(other))
    assert other in twin.active
    assert found not in twin.active
    assert simulated(twin) == pytest.approx(simulated(plant), abs=1e-3)
    assert np.ptp(simulated(plant)) > 1.0
    back = as_twin(twin, effect(other), effect(found))
    assert back.values == pytest.approx(plant.values)


def test_a_load_that_turns_a_resting_motor_has_no_twin():
    effect = HEAVY.layout.effect
    heavier = HEAVY.with_effect("constant_load", {"load": 0.041})
    assert as_twin(heavier, effect("constant_load"), effect("asymmetric_friction")) is None
    assert as_twin(heavier, effect("constant_load"), effect("stiction")) is None


@pytest.mark.parametrize(("behind", "settled"), [(None, True), (8.1, True), (7.9, False)])
def test_the_twin_of_what_was_found_is_settled_unless_it_has_come_as_far(behind, settled):
    effect = HEAVY.layout.effect
    plant = HEAVY.with_effect("asymmetric_friction", {"forward": 0.02, "reverse": 0.05})
    known = None if behind is None else SimpleNamespace(fitted_cost=behind)
    tried = []
    kept = SimpleNamespace(like=lambda _: known, settle=lambda twin, _: tried.append(twin))
    best = SimpleNamespace(plant=plant, fitted_cost=0.0, noise=None)
    others = [effect("stiction"), effect("constant_load")]
    search(_settled=kept)._settle_twins(best, effect("asymmetric_friction"), others)
    assert [one.active - HEAVY.active for one in tried] == ([{"constant_load"}] if settled else [])
