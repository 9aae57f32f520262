"""Where the baseline fails, put together: when, in which regime, in which equation, and what set in at a moment."""

from __future__ import annotations

from nxt_twin.diagnose.diagnosis import Mismatch, Onset, SourceFinding, Verdict
from nxt_twin.diagnose.fitting.linear import signatures, trials_of
from nxt_twin.diagnose.judging.confusion import trace_of, without
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.where.locate import regimes, spells
from nxt_twin.diagnose.where.moment import moments
from nxt_twin.diagnose.where.onset import Direction, onsets
from nxt_twin.diagnose.where.sources import SOURCE_OF, sources
from nxt_twin.physics.effect import Equation
from nxt_twin.physics.layout import BASE_OWNER
from nxt_twin.physics.simulate import Simulator

_STEADY = "constant_load"
_PLAIN = ("inertia", "coulomb", "viscous")


def mismatch_of(simulator: Simulator, evidence: Evidence, verdict: Verdict, seed: int) -> Mismatch:
    """All that is known of where the baseline fails; where it does not, how little each equation asks for."""
    names = [signals.name for signals in evidence.problem.signals]
    channel = evidence.problem.signals[0].channel
    strengths = sources(simulator, evidence.problem, evidence.baseline)
    if verdict == "adequate":
        return Mismatch(channel, (), (), None, sources=strengths)
    equation = _equation(evidence, strengths, verdict)
    return Mismatch(
        channel=channel,
        when=spells(evidence.before, names),
        regimes=regimes(evidence.before, seed),
        equation=equation,
        source=SOURCE_OF[equation],
        sources=strengths,
        onsets=_onsets(simulator, evidence),
    )


def _equation(evidence: Evidence, strengths: tuple[SourceFinding, ...], verdict: Verdict) -> Equation:
    """That of the weightiest effect that explains; else the equation that asks for noise the loudest."""
    found = evidence.explanation.found
    return found[0][0].equation_of if found and verdict == "explained" else strengths[0].equation


def _onsets(simulator: Simulator, evidence: Evidence) -> tuple[Onset, ...]:
    """When each found effect set in; where none was found, when a parameter became another."""
    linear, problem = evidence.linear, evidence.problem
    plant = evidence.final.plant
    told = moments(simulator, linear)
    if told:
        return told
    directions = [
        Direction(
            effect.id, trace_of(simulator, linear, without(plant, effect.id, problem.plant)), found=True
        )
        for effect, _ in evidence.explanation.found
        if "outlier" not in effect.terms
    ]
    if not directions:
        for number, variable in enumerate(linear.variables):
            slot = variable.slots[0]
            if slot.symbol in _PLAIN and (slot.owner == BASE_OWNER or slot.owner in plant.active):
                name = plant.layout.parameters[slot].name
                directions.append(Direction(name, linear.slopes[number], found=False))
        if _STEADY not in plant.active:
            effect = plant.layout.effect(_STEADY)
            trial = trials_of(effect, problem.scale)[0]
            directions.append(
                Direction(_STEADY, signatures(simulator, linear, plant, [trial])[0], found=False)
            )
    return onsets(linear, directions, evidence.clean)
