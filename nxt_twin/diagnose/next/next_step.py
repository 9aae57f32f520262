"""What to record next: between two rivals by the evidence to expect, for the unknown and the unseen by rule."""

from __future__ import annotations

import math

from numpy.random import Generator

from nxt_twin.diagnose.diagnosis import Excitation, Fit, NextExperiment, Verdict
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.judging.run_outs import unfitted_run_outs
from nxt_twin.diagnose.judging.verdict import is_in_vain, is_stalled
from nxt_twin.diagnose.next.inputs import Pattern, family
from nxt_twin.diagnose.next.next_experiment import LONGEST_S, Proposal, bounded_reach, most_pct, propose
from nxt_twin.diagnose.telling import words
from nxt_twin.diagnose.telling.findings import near_rivals
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.columns import PORTS
from nxt_twin.recording.program import MotorProgram, Run, Segment

_SETTLING_S = 0.3  # without power before a proposed input
_RUN_OUT_S = 1.0  # without power after it


def next_experiment(
    simulator: Simulator,
    evidence: Evidence,
    verdict: Verdict,
    excitation: Excitation,
    fit: Fit,
    rng: Generator,
) -> NextExperiment | None:
    """What to record next, None where nothing is open."""
    problem = evidence.problem
    if verdict == "unexplained" and is_stalled(evidence.record):
        return words.experiment_for_stalled()
    pairs = near_rivals(evidence)
    if pairs:
        effect, rival = pairs[0]
        proposal = propose(simulator, problem, evidence.explanation.best, rival.structure, rng)
        hint = words.experiment_between(effect, rival.effect)
        return hint if proposal is None else _between(problem, hint, proposal, effect.id, rival.effect.id)
    run_outs = unfitted_run_outs(problem, fit)
    # What no fitted recording shows, no effect could explain.
    only_there = run_outs and is_in_vain(evidence.record)
    if verdict == "unexplained" and not only_there:
        return _with_program(
            problem, words.experiment_for_unknown(), "what-repeats", _twice_and_half(problem)
        )
    if verdict == "adequate" and not excitation.enough:
        hint = words.experiment_for_unseen(excitation)
        return _with_program(problem, hint, "livelier", _lively(problem))
    if run_outs:
        hint = words.experiment_for_run_outs([run_out.recording for run_out in run_outs])
        return _with_program(problem, hint, "coast-downs", _run_outs(problem))
    return None


def _between(
    problem: Problem, hint: NextExperiment, proposal: Proposal, one: str, other: str
) -> NextExperiment:
    unit = "%" if problem.signals[0].input_kind == "power_pct" else "% of the largest command so far"
    told = words.proposed(proposal.pattern.words.format(unit=unit), proposal.seconds, proposal.expected_nats)
    seconds = min(proposal.seconds, LONGEST_S)
    segments = (_rest(_SETTLING_S), *proposal.pattern.lasting(seconds), _rest(_RUN_OUT_S))
    program = _program(problem, f"{one}-or-{other}", hint.why, {"told-apart": segments})
    return NextExperiment(
        why=f"{hint.why}; {hint.input}" if hint.input else hint.why,
        input=told,
        expected_nats=proposal.expected_nats,
        seconds=math.ceil(seconds),
        program=program,
    )


def _with_program(
    problem: Problem, hint: NextExperiment, name: str, runs: dict[str, tuple[Segment, ...]]
) -> NextExperiment:
    return NextExperiment(hint.why, hint.input, program=_program(problem, name, hint.why, runs))


def _twice_and_half(problem: Problem) -> dict[str, tuple[Segment, ...]]:
    """The same steps twice, then at half the size."""
    most = most_pct(problem)
    patterns = {"first": most, "again": most, "half": max(most // 2, 10)}
    return {name: next(family(power)).lasting(12.0) for name, power in patterns.items()}


def _lively(problem: Problem) -> dict[str, tuple[Segment, ...]]:
    """Steps of several sizes, slow ramps through zero, coast-downs and reversals: a little of everything."""
    wanted = ("steps both ways", "slow ramps", "spin up", "reversals")
    chosen: dict[str, Pattern] = {}
    for pattern in family(most_pct(problem)):
        for start in wanted:
            if pattern.words.startswith(start):
                chosen.setdefault(start.replace(" ", "-"), pattern)
    return {name: pattern.lasting(12.0) for name, pattern in chosen.items()}


def _run_outs(problem: Problem) -> dict[str, tuple[Segment, ...]]:
    """The patterns that let the motor run out without current."""
    patterns = [p for p in family(most_pct(problem)) if any(s.mode == "coast" for s in p.segments)]
    return {f"coast-down-{n}": pattern.lasting(8.0) for n, pattern in enumerate(patterns, 1)}


def _program(
    problem: Problem, name: str, why: str, runs: dict[str, tuple[Segment, ...]]
) -> MotorProgram | None:
    """The runs as a file for a brick's motor; None where a brick cannot drive the plant."""
    first = problem.signals[0]
    if first.input_kind != "power_pct" or problem.plant.layout.frame != "motor":
        return None
    port = next((port for port in PORTS if first.channel.startswith(f"{port}_")), PORTS[0])
    return MotorProgram(
        name=name[:64],
        why=why,
        ports=(port,),
        runs=tuple(Run(name=run_name, segments=segments) for run_name, segments in runs.items()),
        most_turn_deg=_most_turn_deg(problem),
    )


def _most_turn_deg(problem: Problem) -> float | None:
    """The reach of the recordings where it seems to be bounded, None for a motor that turns freely."""
    reach = bounded_reach(problem)
    return None if math.isinf(reach) else math.ceil(math.degrees(reach))


def _rest(duration_s: float) -> Segment:
    return Segment(duration_s=duration_s)
