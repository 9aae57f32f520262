"""An arm beside an inertia that has surely risen is a payload, if a motor carries one on such a lever."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose import inquiry
from nxt_twin.diagnose.diagnosis import Confusion, Estimate, FoundEffect, Moved
from nxt_twin.diagnose.telling import payload
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
GIVEN_KG_M2 = 1e-3
GRAVITY_NM = 0.05


@dataclass(frozen=True)
class Bare:
    """What of a record a size changes."""

    moved: float = 1.0
    loose: bool = False
    given_is_a_fit: bool = False


@dataclass(frozen=True)
class MadeUp:
    """Evidence of an answer, without what its sizes do not need."""

    explanation: Any
    final: Any
    record: Bare


def told(
    monkeypatch, rise, std=0.1, *, effect_id="gravity_load", gravity=GRAVITY_NM, plant=PLAIN, record=None
):
    """How an arm is told beside an inertia that rose by that share of the given one, with its deviation."""
    inertia = Moved(GIVEN_KG_M2, GIVEN_KG_M2 * (1.0 + rise), GIVEN_KG_M2 * std, "kg·m²")
    monkeypatch.setattr(payload, "refitted", lambda _: {"inertia_kg_m2": inertia})
    params = {"gravity_torque_nm": Estimate(gravity, 0.001, "N·m"), "phase_deg": Estimate(10.0, 1.0, "deg")}
    near = (Confusion("spring_load", "…"), Confusion("hanging_payload", "…"))
    found = FoundEffect(effect_id, "arm", "…", params, 0.9, near)
    evidence = SimpleNamespace(final=SimpleNamespace(plant=plant), record=record or Bare())
    return payload.as_a_payload(evidence, found)


@pytest.mark.parametrize(
    ("rise", "std", "effect_id"),
    [
        (0.41, 0.1, "hanging_payload"),
        (0.39, 0.1, "gravity_load"),
        (0.6, 0.26, "gravity_load"),
        (0.6, 0.24, "hanging_payload"),
    ],
)
def test_an_arm_is_a_payload_where_the_inertia_surely_rose(monkeypatch, rise, std, effect_id):
    found = told(monkeypatch, rise, std)
    assert found.id == effect_id
    other = {"hanging_payload": "gravity_load", "gravity_load": "hanging_payload"}[effect_id]
    assert sorted(one.id for one in found.confusable_with) == sorted([other, "spring_load"])


@pytest.mark.parametrize(
    ("beside", "effect_id"),
    [("backlash", "gravity_load"), ("shaft_compliance", "gravity_load"), ("presliding", "hanging_payload")],
)
def test_an_arm_behind_play_or_a_soft_shaft_stays_an_arm_that_may_be_a_payload(
    monkeypatch, beside, effect_id
):
    parameters = PLAIN.layout.effect(beside).parameters
    plant = PLAIN.with_effect(beside, {p.symbol: p.starts[0] * p.si for p in parameters})
    found = told(monkeypatch, 0.6, plant=plant)
    assert found.id == effect_id
    assert {found.id, found.confusable_with[0].id, found.confusable_with[-1].id} >= {
        "gravity_load",
        "hanging_payload",
    }


def test_an_inertia_that_was_fitted_without_the_arm_has_not_risen(monkeypatch):
    found = told(monkeypatch, 0.6, record=Bare(given_is_a_fit=True))
    assert (found.id, found.confusable_with[-1].id) == ("gravity_load", "hanging_payload")


def test_a_payload_tells_the_inertia_that_it_adds_with_an_interval(monkeypatch):
    found = told(monkeypatch, 0.6)
    assert set(found.params) == {"gravity_torque_nm", "added_inertia_kg_m2", "phase_deg"}
    added = found.params["added_inertia_kg_m2"]
    assert added.value == pytest.approx(0.6 * GIVEN_KG_M2)
    assert added.interval_95 == pytest.approx((0.4 * GIVEN_KG_M2, 0.8 * GIVEN_KG_M2))


@pytest.mark.parametrize(
    ("rise", "gravity", "effect_id"),
    [(0.05, GRAVITY_NM, "gravity_load"), (0.6, 5.0, "gravity_load"), (0.6, 0.002, "gravity_load")],
)
def test_an_arm_whose_lever_no_motor_carries_stays_an_arm(monkeypatch, rise, gravity, effect_id):
    assert told(monkeypatch, rise, gravity=gravity).id == effect_id


@pytest.mark.parametrize(
    ("rise", "gravity", "found", "carried"),
    [
        (3.2, 0.2, "gravity_load", True),
        (0.05, 0.2, "gravity_load", False),
        (3.2, 0.0001, "gravity_load", False),
        (3.2, 0.2, "stiction", False),
    ],
)
def test_a_rise_beside_an_arm_is_no_number_of_the_motor_that_moved(
    monkeypatch, rise, gravity, found, carried
):
    inertia = Moved(GIVEN_KG_M2, GIVEN_KG_M2 * (1.0 + rise), 0.1 * GIVEN_KG_M2, "kg·m²", (3e-3, 5e-3))
    for module in (payload, inquiry):
        monkeypatch.setattr(module, "refitted", lambda _: {"inertia_kg_m2": inertia})
    monkeypatch.setattr(inquiry, "has_loose_size", lambda _: False)
    plant = PLAIN.with_effect("gravity_load", {"gravity": gravity, "phase": 0.0})
    explanation = SimpleNamespace(found=[(plant.layout.effect(found), None)])
    evidence = MadeUp(explanation, SimpleNamespace(plant=plant), Bare())
    assert inquiry._with_sizes(evidence).record.moved == pytest.approx(1.0 if carried else 3.0)


def test_other_effects_stay_as_they_are(monkeypatch):
    assert told(monkeypatch, 0.9, effect_id="stiction").id == "stiction"
