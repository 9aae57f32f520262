"""A number of cycles a turn that came to rest beside a whole one is settled from that, too."""

from types import SimpleNamespace

import pytest

import nxt_twin as nt
from nxt_twin.diagnose.search.cycles import at_whole_cycles
from nxt_twin.physics.layout import Slot

PLAIN = nt.load_plant("nxt_motor")
CYCLES = Slot("cogging", "cycles")


class Settled:
    """Settles a plant as it is, at the cost told; keeps what it was asked."""

    def __init__(self, cost):
        self.asked = []
        self._cost = cost

    def settle(self, plant, _noise):
        self.asked.append(plant.values[CYCLES])
        return SimpleNamespace(plant=plant, noise=None, fitted_cost=self._cost)


def ended_at(cycles):
    cogging = {"cogging": 0.03, "cycles": cycles, "phase": 1.0}
    return SimpleNamespace(plant=PLAIN.with_effect("cogging", cogging), noise=None, fitted_cost=-100.0)


@pytest.mark.parametrize(
    ("cycles", "asked"),
    [(11.92, [12.0]), (12.08, [12.0]), (11.81, [12.0]), (11.79, []), (11.9991, []), (11.9989, [12.0])],
)
def test_a_fit_beside_a_whole_number_is_settled_from_it(cycles, asked):
    settled = Settled(cost=-500.0)
    found = at_whole_cycles(settled, ended_at(cycles), PLAIN.layout.effect("cogging"))
    assert settled.asked == asked
    assert found.plant.values[CYCLES] == (12.0 if asked else cycles)


def test_a_whole_number_that_is_no_likelier_is_left_alone():
    trial = ended_at(11.92)
    assert at_whole_cycles(Settled(cost=-99.0), trial, PLAIN.layout.effect("cogging")) is trial


def test_an_effect_without_cycles_stays_as_it_is():
    settled = Settled(cost=-500.0)
    trial = SimpleNamespace(plant=PLAIN, noise=None, fitted_cost=-100.0)
    assert at_whole_cycles(settled, trial, PLAIN.layout.effect("stiction")) is trial
    assert settled.asked == []
