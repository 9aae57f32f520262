"""The effects that come with the tool, one declaration each, in the order in which their terms act."""

from __future__ import annotations

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.electrical import (
    BATTERY_SAG,
    CURRENT_LIMIT,
    INDUCTANCE,
    POWER_CURVE,
    VOLTAGE_DROP,
)
from nxt_twin.physics.effects.friction import (
    ASYMMETRIC_FRICTION,
    ASYMMETRIC_VISCOUS_FRICTION,
    COULOMB_FRICTION,
    FRICTION_WARMUP,
    LOAD_DEPENDENT_FRICTION,
    QUADRATIC_DRAG,
    STICTION,
    VISCOUS_FRICTION,
)
from nxt_twin.physics.effects.load import CONSTANT_LOAD, GRAVITY_LOAD, SPRING_LOAD
from nxt_twin.physics.effects.timing import COMMAND_DELAY, STALE_SAMPLES
from nxt_twin.physics.effects.transmission import BACKLASH, SHAFT_COMPLIANCE

BUILT_IN: tuple[Effect, ...] = (
    COULOMB_FRICTION,
    VISCOUS_FRICTION,
    INDUCTANCE,
    CURRENT_LIMIT,
    ASYMMETRIC_FRICTION,
    ASYMMETRIC_VISCOUS_FRICTION,
    STICTION,
    LOAD_DEPENDENT_FRICTION,
    FRICTION_WARMUP,
    QUADRATIC_DRAG,
    CONSTANT_LOAD,
    GRAVITY_LOAD,
    SPRING_LOAD,
    BACKLASH,
    SHAFT_COMPLIANCE,
    BATTERY_SAG,
    VOLTAGE_DROP,
    POWER_CURVE,
    COMMAND_DELAY,
    STALE_SAMPLES,
)
