"""What hangs on the axis: weights, arms, springs."""

from __future__ import annotations

import math
from collections.abc import Sequence

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.harmonic import harmonic
from nxt_twin.physics.inline import cosine, sine
from nxt_twin.physics.parameter import ANGLE, INERTIA, NUMBER, STIFFNESS, TORQUE, Parameter
from nxt_twin.physics.signals import Signals


def _constant(load: float) -> float:
    return load


CONSTANT_LOAD = Effect(
    id="constant_load",
    name="constant load",
    equation="τ = τ0",
    source="the weight of a mass on a drum: m·g·r",
    equation_of="torque_balance",
    shows=("direction", "low_speed"),
    notable=1e-3,
    parameters=(
        Parameter(
            "load_torque_nm",
            "load",
            "N·m",
            TORQUE,
            (0.02, -0.02),
            -3.0,
            3.0,
            elsewhere={"linear": ("load_force_n", "N")},
        ),
    ),
    terms={"torque": _constant},
    confusable_with={
        "asymmetric_friction": "a rest at small commands both ways: a load still pushes there, friction does not",
        "gravity_load": "a whole turn tells: gravity changes sign within it",
    },
)


def _gravity(angle: float, gravity: float, phase: float) -> float:
    return -gravity * sine(angle + phase)


GRAVITY_LOAD = Effect(
    id="gravity_load",
    name="gravity load of an unbalanced arm",
    equation="τ = -τg·sin(θ + φ)",
    source="the pendulum: m·g·l·sin",
    equation_of="torque_balance",
    shows=("angle",),
    notable=1.5e-3,
    parameters=(
        Parameter("gravity_torque_nm", "gravity", "N·m", TORQUE, (0.05,), 0.0, 3.0),
        Parameter(
            "phase_deg", "phase", "deg", NUMBER, (0.0, 90.0, 180.0, -90.0), -270.0, 270.0, si=math.pi / 180.0
        ),
    ),
    terms={"torque": _gravity},
    confusable_with={"spring_load": "several turns tell: a spring winds up, gravity comes round again"},
    frames=("motor", "rotary"),
    commoner_nats=5.0,  # assumed, not counted: of a hundred motors that are pulled back to one angle, one has a spring
)


NEVER_S = 1e6
"""When a payload that stays is taken off again, s of the session, which ends before."""


_MOST_ROWS = 28  # of recordings that a payload's search starts from: all of eight recordings


def _begun(elapsed_s: float, session_s: float, step_s: float, onset: float) -> float:
    """The share of a step that comes after the onset."""
    late = (session_s + elapsed_s + step_s - onset) / step_s
    return min(max(late, 0.0), 1.0)


def _there(elapsed_s: float, session_s: float, step_s: float, onset: float, removed: float) -> float:
    """The share of a step between the onset and the removal."""
    gone = _begun(elapsed_s, session_s, step_s, removed)
    return max(_begun(elapsed_s, session_s, step_s, onset) - gone, 0.0)


def _sets_in(recordings: Sequence[Signals]) -> list[float]:
    """When what sets in anew in each recording does so, s of the session; empty where nothing does."""
    return [recordings[0].sets_in_s] if math.isfinite(recordings[0].sets_in_s) else []


def _some_recordings(recordings: Sequence[Signals]) -> list[tuple[float, float]]:
    """Beginning and end, s of the session, of each row of recordings but those that last to the end, a few of many."""
    if _sets_in(recordings):
        return []
    begins = [signals.session_s for signals in recordings]
    rows = [(first, after) for n, first in enumerate(begins) for after in begins[n + 1 :] if after > first]
    return rows[:: math.ceil(len(rows) / _MOST_ROWS) or 1]


def _carried_in_some(recordings: Sequence[Signals]) -> list[dict[str, float]]:
    return [{"onset": first, "removed": after} for first, after in _some_recordings(recordings)]


def _hung_in_some(recordings: Sequence[Signals]) -> list[dict[str, float]]:
    return [{"hung_at": first, "taken_off_at": after} for first, after in _some_recordings(recordings)]


def _removed(symbol: str) -> Parameter:
    """When a payload is taken off again, s of the session; by default never. A search tries ends of recordings."""
    return Parameter(
        "removed_s", symbol, "s", NUMBER, (NEVER_S,), 0.0, NEVER_S, otherwise=NEVER_S, tried=True
    )


def _hanging(
    angle: float,
    elapsed_s: float,
    session_s: float,
    step_s: float,
    payload_gravity: float,
    payload_phase: float,
    hung_at: float,
    taken_off_at: float,
) -> float:
    share = _there(elapsed_s, session_s, step_s, hung_at, taken_off_at)
    return -payload_gravity * share * sine(angle + payload_phase) if share > 0.0 else 0.0


def _carried(
    elapsed_s: float,
    session_s: float,
    step_s: float,
    payload_inertia: float,
    hung_at: float,
    taken_off_at: float,
) -> float:
    return payload_inertia * _there(elapsed_s, session_s, step_s, hung_at, taken_off_at)


def _hung_on(recordings: Sequence[Signals]) -> list[float]:
    """Where a later recording begins; in a single one, three times within it.

    A payload that was there from the first reading on is an arm and an inertia, which have names of their own.
    """
    if anew := _sets_in(recordings):
        return anew
    later = [signals.session_s for signals in recordings if signals.session_s > 0.0]
    length_s = float(recordings[0].time_s[-1] - recordings[0].time_s[0])
    return later or [share * length_s for share in (0.25, 0.5, 0.75)]


HANGING_PAYLOAD = Effect(
    id="hanging_payload",
    name="hanging payload",
    equation="τ = -τg·sin(θ + φ), J = J0 + Ja, from t0 to t1; both as of a payload",
    source="the physical pendulum: m·g·l·sin, and m·l² with what the payload has about its own middle",
    equation_of="torque_balance",
    shows=("angle", "after_command"),
    notable=1.5e-3,
    parameters=(
        Parameter("gravity_torque_nm", "payload_gravity", "N·m", TORQUE, (0.05,), 0.0, 3.0),
        Parameter("added_inertia_kg_m2", "payload_inertia", "kg·m²", INERTIA, (1e-3,), 0.0, 0.2),
        Parameter(
            "phase_deg",
            "payload_phase",
            "deg",
            NUMBER,
            (0.0, 90.0, 180.0, -90.0),
            -270.0,
            270.0,
            si=math.pi / 180.0,
            otherwise=0.0,
        ),
        Parameter(
            "onset_s",
            "hung_at",
            "s",
            NUMBER,
            (5.0, 0.0),
            0.0,
            1e6,
            otherwise=0.0,
            hints=_hung_on,
        ),
        _removed("taken_off_at"),
    ),
    terms={"inertia": _carried, "torque": _hanging},
    further_starts=_hung_in_some,
    confusable_with={
        "gravity_load": "quick reversals tell: a payload adds inertia, an arm that was there all along does not",
        "payload_inertia": "slow turns tell: a payload on an arm pulls it down, a disc does not",
    },
    frames=("motor", "rotary"),
)


def _spring(angle: float, stiffness: float, rest: float) -> float:
    return -stiffness * (angle - rest)


SPRING_LOAD = Effect(
    id="spring_load",
    name="spring load",
    equation="τ = -k·(θ - θ0)",
    source="Hooke's law; a rubber band about its rest",
    equation_of="torque_balance",
    shows=("angle",),
    notable=1.5e-4,
    parameters=(
        Parameter(
            "stiffness_nm_per_rad",
            "stiffness",
            "N·m/rad",
            STIFFNESS,
            (4e-3, 4e-4),
            0.0,
            0.5,
            elsewhere={"linear": ("stiffness_n_per_m", "N/m")},
        ),
        Parameter(
            "rest_angle_deg",
            "rest",
            "deg",
            ANGLE,
            (0.0,),
            -36000.0,
            36000.0,
            si=math.pi / 180.0,
            elsewhere={"linear": ("rest_position_m", "m", 1.0)},
        ),
    ),
    terms={"torque": _spring},
    confusable_with={"gravity_load": "several turns tell: a spring winds up, gravity comes round again"},
)


def _ripple(
    angle: float, cogging: float, cycles: float, phase: float, in_phase: float, in_quadrature: float
) -> float:
    turn = cycles * angle + phase
    along, across = cosine(turn), sine(turn)
    return cogging * (
        along + in_phase * (along * along - across * across) + 2.0 * in_quadrature * along * across
    )


COGGING = Effect(
    id="cogging",
    name="cogging",
    equation="τ = τc·(cos x + a·cos 2x + b·sin 2x), x = n·θ + φ, n ≥ 2",
    source="Hanselman 2003; the first two harmonics of magnets, commutator or teeth",
    equation_of="torque_balance",
    shows=("angle", "low_speed"),
    notable=1.5e-3,
    parameters=(
        Parameter("cogging_torque_nm", "cogging", "N·m", TORQUE, (0.012,), 0.0, 3.0),
        Parameter(
            "cycles_per_turn",
            "cycles",
            "1",
            NUMBER,
            (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 16.0, 20.0, 24.0, 32.0, 48.0),
            1.5,
            100.0,
        ),
        Parameter(
            "phase_deg",
            "phase",
            "deg",
            NUMBER,
            (0.0, 120.0, -120.0),
            -360.0,
            360.0,
            si=math.pi / 180.0,
            otherwise=0.0,
        ),
        harmonic("harmonic_in_phase", "in_phase"),
        harmonic("harmonic_in_quadrature", "in_quadrature"),
    ),
    terms={"torque": _ripple},
    confusable_with={
        "gravity_load": "whole turns tell: gravity comes round once a turn, cogging at least twice",
        "angle_dependent_friction": "turning both ways tells: friction brakes both, cogging pushes one way",
        "encoder_eccentricity": "the same turns at several speeds tell: a torque fades with speed, a reading does not",
    },
    frames=("motor", "rotary"),
)


def _added(
    elapsed_s: float, session_s: float, step_s: float, added_inertia: float, onset: float, removed: float
) -> float:
    return added_inertia * _there(elapsed_s, session_s, step_s, onset, removed)


def _onsets(recordings: Sequence[Signals]) -> list[float]:
    """Times of the session: where a recording begins, and seven between; or when something sets in in each."""
    if anew := _sets_in(recordings):
        return anew
    at_s = []
    for signals in recordings:
        length_s = float(signals.time_s[-1] - signals.time_s[0])
        at_s += [
            signals.session_s + share * length_s for share in (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75)
        ]
    return [at for at in at_s if at > 0.0]


PAYLOAD_INERTIA = Effect(
    id="payload_inertia",
    name="payload inertia",
    equation="J = J0 + Ja from t0 to t1, from the beginning of the first recording, all laid end to end",
    source="rigid bodies: inertias on one axis add",
    equation_of="torque_balance",
    shows=("elapsed_time", "after_command"),
    notable=1e-4,
    parameters=(
        Parameter(
            "added_inertia_kg_m2",
            "added_inertia",
            "kg·m²",
            INERTIA,
            (1e-3,),
            0.0,
            0.2,
            elsewhere={"linear": ("added_mass_kg", "kg")},
        ),
        Parameter(
            "onset_s",
            "onset",
            "s",
            NUMBER,
            (5.0, 0.0, 10.0, 20.0, 40.0),
            0.0,
            1e6,
            otherwise=0.0,
            hints=_onsets,
        ),
        _removed("removed"),
    ),
    terms={"inertia": _added},
    further_starts=_carried_in_some,
    confusable_with={
        "friction_warmup": "steady speeds before and after tell: a payload leaves them alone, friction does not",
        "shaft_compliance": "a payload that is there all the time is inertia; only its coming, or a ringing, tells",
    },
)
