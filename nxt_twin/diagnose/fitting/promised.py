"""The gain that plants promise over a structure, by one run each, once the rest has been re-fitted: a score test."""

from __future__ import annotations

from collections.abc import Sequence

from nxt_twin.diagnose.fitting.fitter import DRAFTED, Fitter
from nxt_twin.diagnose.fitting.nuisance import Nuisance
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.plant import Plant


def promised(fitter: Fitter, structure: Structure, plants: Sequence[Plant]) -> list[tuple[int, float, float]]:
    """The place of each of `plants`, the gain that it promises, nats, and stretched by how much; by their steps.

    One run a plant gives the signature: the change of all predictions in standard deviations. A score test
    with nuisance parameters projects out all that a re-fit of the structure's own variables could imitate.
    The rest is scaled, since a start has only the order of magnitude. A start promises at least what it gains outright,
    as it stands: a soft shaft moves a motor so far that no line leads there.
    """
    steps_s = [DRAFTED.step_for(plant) for plant in plants]
    found = []
    for step_s in sorted(set(steps_s)):
        places = [place for place, own_s in enumerate(steps_s) if own_s == step_s]
        nuisance = Nuisance(fitter, structure, fitter.tuned(structure.noise, step_s).telling())
        gains = nuisance.gains([plants[place] for place in places])
        found += [(place, *promise) for place, promise in zip(places, gains, strict=True)]
    return found
