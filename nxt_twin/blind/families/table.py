"""Every truth family: its name, its simulator, and what it can hide."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.effects.library import KNOWN_EFFECTS, UNKNOWN_EFFECTS, compatible
from nxt_twin.blind.families.driven import ELECTRICAL, MEASURED
from nxt_twin.blind.families.family import Family, Order
from nxt_twin.blind.families.foreign import Foreign, make_foreign, stand_together
from nxt_twin.blind.families.known import LOADS
from nxt_twin.blind.families.mujoco.machine import STRANGERS as MUJOCO_STRANGERS
from nxt_twin.blind.families.mujoco.machine import MuJoCo
from nxt_twin.blind.families.mujoco.machine import ready as mujoco_ready
from nxt_twin.blind.families.setting import Hideable
from nxt_twin.blind.families.stiff.machine import STRANGERS as STIFF_STRANGERS
from nxt_twin.blind.families.stiff.machine import Stiff
from nxt_twin.blind.families.workshop.machine import STRANGERS as WORKSHOP_STRANGERS
from nxt_twin.blind.families.workshop.machine import Workshop
from nxt_twin.blind.make import make_case

BRISTLE: Final = "bristle"
USUAL_DURATION_S: Final = 15.0
STIFF_STEPS_DEG: Final = (1.0, 1.0, 1.0, 0.5, 0.25)


def _bristle(order: Order) -> ConcealedCase:
    return make_case(
        order.plan.seed,
        effects=order.plan.effects,
        size=order.plan.size,
        link=order.link,
        duration_s=order.duration_s or USUAL_DURATION_S,
        name=order.plan.name,
    )


def _foreign(foreign: Foreign, simulator: str, ready: Callable[[], str] = str) -> Family:
    effects = {effect.id: effect for effect in foreign.effects}
    return Family(
        name=foreign.name,
        simulator=simulator,
        known=tuple(name for name, effect in effects.items() if effect.known),
        unknown=tuple(name for name, effect in effects.items() if not effect.known),
        compatible=lambda ids: len(set(ids)) == len(ids) and stand_together([effects[one] for one in ids]),
        make=lambda order: make_foreign(
            foreign,
            order.plan.seed,
            order.plan.effects,
            order.plan.size,
            name=order.plan.name,
            duration_s=order.duration_s,
        ),
        ready=ready,
    )


def _all(strangers: tuple[Hideable, ...], *without: str) -> tuple[Hideable, ...]:
    """All effects of the contract but some, and a family's strangers; the end stop last."""
    return tuple(
        effect for effect in (*ELECTRICAL, *MEASURED, *strangers, *LOADS) if effect.id not in without
    )


FOREIGN: Final[dict[str, Foreign]] = {
    foreign.name: foreign
    for foreign in (
        Foreign("mujoco", MuJoCo, _all(MUJOCO_STRANGERS), longest_s=90.0),
        Foreign(
            "stiff",
            Stiff,
            _all(STIFF_STRANGERS),
            longest_s=60.0,
            command_every_s=0.05,
            steps_deg=STIFF_STEPS_DEG,
        ),
        Foreign("workshop", Workshop, _all(WORKSHOP_STRANGERS), steps_deg=(1.0,)),
    )
}
"""What each foreign family brings."""

FAMILIES: Final[dict[str, Family]] = {
    family.name: family
    for family in (
        Family(
            BRISTLE,
            "Runge-Kutta steps of 25 µs, Dahl bristles, contact by penalty",
            tuple(KNOWN_EFFECTS),
            tuple(UNKNOWN_EFFECTS),
            compatible,
            _bristle,
            str,
        ),
        _foreign(
            FOREIGN["mujoco"],
            "MuJoCo's implicit steps, its solver for friction loss, limits and contacts; bodies on tendons",
            mujoco_ready,
        ),
        _foreign(
            FOREIGN["stiff"],
            "SciPy's Radau over two sets of LuGre bristles, rounded contacts, a stop as an event",
        ),
        _foreign(
            FOREIGN["workshop"],
            "implicit in current, a dead band of speed for sticking, Kelvin-Voigt contact; in every motor ripple, "
            "warm grease, a tired battery",
        ),
    )
}
"""In the order in which they are told."""
