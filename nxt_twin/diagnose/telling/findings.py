"""The findings with their uncertainty: effects, effects that look alike, and alternatives."""

from __future__ import annotations

from collections.abc import Sequence

from nxt_twin.diagnose.diagnosis import Alternative, Confusion, FoundEffect, Nearest, Verdict
from nxt_twin.diagnose.judging.confusion import alike, without
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.judging.judge import FreeRun, free_runs, overall
from nxt_twin.diagnose.judging.verdict import Record, is_in_vain, is_loose, is_patchwork, is_stalled
from nxt_twin.diagnose.search.explain import Ranked
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.rivals import Rival, share_of_belief
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.diagnose.telling import words
from nxt_twin.diagnose.telling.calibration import LEFT_OUT, told_probability
from nxt_twin.diagnose.telling.estimates import estimates
from nxt_twin.diagnose.telling.payload import as_a_payload
from nxt_twin.diagnose.where.moment import with_bounds
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_SHOWN_ALTERNATIVES = 3  # structures that are listed, at most


def found_effects(simulator: Simulator, evidence: Evidence) -> tuple[FoundEffect, ...]:
    """The effects that the data call for, the weightiest first."""
    listed = []
    for effect, _ in evidence.explanation.found:
        rivals = evidence.explanation.rivals.get(effect.id, ())
        found = FoundEffect(
            id=effect.id,
            name=effect.name,
            equation=effect.equation,
            params=with_bounds(simulator, evidence.linear, effect, estimates(evidence, effect)),
            probability=told_probability(share_of_belief(0.0, [rival.doubt_nats for rival in rivals])),
            confusable_with=_confusions(simulator, evidence, effect, rivals),
        )
        listed.append(as_a_payload(evidence, found))
    return tuple(listed)


def near_rivals(evidence: Evidence) -> list[tuple[Effect, Rival]]:
    """Found effects with the rivals that these recordings cannot tell from them, the nearest first."""
    pairs = [
        (effect, rival)
        for effect, _ in evidence.explanation.found
        for rival in evidence.explanation.rivals.get(effect.id, ())
        if rival.doubt_nats < LIMITS.rival_nats
    ]
    return sorted(pairs, key=lambda pair: pair[1].doubt_nats)


def _confusions(
    simulator: Simulator, evidence: Evidence, effect: Effect, rivals: Sequence[Rival]
) -> tuple[Confusion, ...]:
    """The rivals that do nearly as well when fitted in the effect's place, with how alike their traces are here."""
    near = [rival for rival in rivals if rival.doubt_nats < LIMITS.rival_nats]
    if not near:
        return ()
    bare = without(evidence.final.plant, effect.id, evidence.problem.plant)
    others = [rival.effect for rival in near]
    found = alike(simulator, evidence.problem.scale, evidence.linear, effect, bare, others)
    traces = {one.effect.id: one for one in found}
    return tuple(
        Confusion(
            rival.effect.id,
            words.why_confusable(effect, rival, traces.get(rival.effect.id)),
        )
        for rival in near
    )


def alternatives(simulator: Simulator, evidence: Evidence, verdict: Verdict) -> tuple[Alternative, ...]:
    """The structures with one effect exchanged that came nearest; where nothing is missing, what was left out.

    Each stands with its own error on held-out readings.
    """
    if verdict != "adequate":
        return _exchanged(simulator, evidence)
    factor = evidence.units.reading_factor
    left = [Alternative(one.effect.id, LEFT_OUT, one.rms * factor) for one in evidence.needless]
    for effect, _, structure in too_weak(evidence, verdict):
        runs = _runs(simulator, evidence, structure.plant)
        left.append(Alternative(effect.id, LEFT_OUT, overall(runs) * factor))
    return tuple(left)


def too_weak(evidence: Evidence, verdict: Verdict) -> list[Ranked]:
    """Effects that the search refused though fitted and checking readings speak for them, where nothing is missing.

    Beside found effects such a gain may come from equations that are a little off.
    """
    if verdict != "adequate":
        return []
    dropped = {one.effect.id for one in evidence.needless}
    return [
        (effect, weight, structure)
        for effect, weight, structure in evidence.explanation.refused
        if weight.gain > LIMITS.gain_nats and weight.borne_out(LIMITS.check_nats) and effect.id not in dropped
    ]


def _runs(simulator: Simulator, evidence: Evidence, plant: Plant) -> list[FreeRun]:
    return free_runs(simulator, evidence.problem, plant, evidence.final.plant, evidence.final.noise)


def _exchanged(simulator: Simulator, evidence: Evidence) -> tuple[Alternative, ...]:
    rivals = [rival for near in evidence.explanation.rivals.values() for rival in near]
    listed = []
    for rival in sorted(rivals, key=lambda rival: rival.doubt_nats)[:_SHOWN_ALTERNATIVES]:
        runs = _runs(simulator, evidence, rival.structure.plant)
        behind = [0.0, *(other.doubt_nats for other in rivals if other is not rival)]
        rmse = overall(runs) * evidence.units.reading_factor
        share = share_of_belief(rival.doubt_nats, behind)
        listed.append(Alternative(rival.effect.id, told_probability(share), rmse))
    return tuple(listed)


def nearest_effect(evidence: Evidence, verdict: Verdict) -> Nearest | None:
    """The known effect that comes nearest to what is left unexplained, and why it was not accepted."""
    refused, found = evidence.explanation.refused, evidence.explanation.found
    if verdict != "unexplained" or not (refused or found):
        return None
    if not refused:
        return Nearest(found[0][0].id, found[0][0].name, _why_not_enough(evidence.record))
    effect, weight, _ = max(refused, key=lambda one: one[1].total)
    return Nearest(effect.id, effect.name, _why_refused(weight))


def _why_not_enough(record: Record) -> str:
    if is_patchwork(record):
        return f"it takes {record.named} effects together, more than are likely to be missing at once"
    if is_stalled(record):
        return f"host or link stood still for {100.0 * record.stalled_share:.0f} % of a recording"
    if is_loose(record):
        return "readings fix the size of an effect to no better than itself"
    if is_in_vain(record):
        return "it leaves most of the error on held-out readings"
    return "what it leaves is more than noise"


def _why_refused(weight: Weight) -> str:
    reasons = []
    if weight.gain <= LIMITS.gain_nats:
        reasons.append(f"it gains {weight.gain:.1f} nats where {LIMITS.gain_nats:g} are asked for")
    if not weight.borne_out(LIMITS.check_nats):
        reasons.append(f"readings that were not fitted do not bear it out ({weight.check_gain:+.1f} nats)")
    if weight.runs_worse:
        more = 100.0 * (weight.free_run_ratio - 1.0)
        reasons.append(
            f"free runs get worse with it ({more:+.0f} %)"
            if more > 0.0
            else "one kind of free run gets worse with it"
        )
    return (
        ", and ".join(reasons)
        or "beside what was found it gains too little, or is too small to be worth a name"
    )
