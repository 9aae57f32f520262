"""The effects that come with the tool, one declaration each, in the order in which their terms act."""

from __future__ import annotations

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.binding import ANGLE_DEPENDENT_FRICTION, PRESLIDING
from nxt_twin.physics.effects.electrical import (
    BATTERY_DRAIN,
    BATTERY_SAG,
    CURRENT_LIMIT,
    INDUCTANCE,
    POWER_CURVE,
    VOLTAGE_DROP,
    WINDING_HEATING,
)
from nxt_twin.physics.effects.encoder import ENCODER_ECCENTRICITY, MISSED_COUNTS
from nxt_twin.physics.effects.friction import (
    ASYMMETRIC_FRICTION,
    ASYMMETRIC_VISCOUS_FRICTION,
    COULOMB_FRICTION,
    FRICTION_CREEP,
    FRICTION_WARMUP,
    LOAD_DEPENDENT_FRICTION,
    QUADRATIC_DRAG,
    STICTION,
    VISCOUS_FRICTION,
)
from nxt_twin.physics.effects.load import (
    COGGING,
    CONSTANT_LOAD,
    GRAVITY_LOAD,
    HANGING_PAYLOAD,
    PAYLOAD_INERTIA,
    SPRING_LOAD,
)
from nxt_twin.physics.effects.magnetic import COMMUTATION_RIPPLE, TORQUE_SATURATION
from nxt_twin.physics.effects.regulation import FIRMWARE_REGULATION
from nxt_twin.physics.effects.servo import GOAL_RATE_LIMIT, INTEGRAL_ACTION, LOOP_DEAD_BAND, POWER_LIMIT
from nxt_twin.physics.effects.stop import END_STOP
from nxt_twin.physics.effects.timing import CLOCK_SKEW, COMMAND_DELAY, SAMPLE_HOLD, STALE_SAMPLES
from nxt_twin.physics.effects.transmission import BACKLASH, SHAFT_COMPLIANCE

BUILT_IN: tuple[Effect, ...] = (
    COULOMB_FRICTION,
    VISCOUS_FRICTION,
    INDUCTANCE,
    CURRENT_LIMIT,
    ASYMMETRIC_FRICTION,
    ASYMMETRIC_VISCOUS_FRICTION,
    PRESLIDING,
    FRICTION_CREEP,
    STICTION,
    LOAD_DEPENDENT_FRICTION,
    FRICTION_WARMUP,
    ANGLE_DEPENDENT_FRICTION,
    QUADRATIC_DRAG,
    CONSTANT_LOAD,
    GRAVITY_LOAD,
    SPRING_LOAD,
    COGGING,
    COMMUTATION_RIPPLE,
    PAYLOAD_INERTIA,
    HANGING_PAYLOAD,
    END_STOP,
    BACKLASH,
    SHAFT_COMPLIANCE,
    TORQUE_SATURATION,
    WINDING_HEATING,
    BATTERY_SAG,
    BATTERY_DRAIN,
    VOLTAGE_DROP,
    POWER_LIMIT,
    POWER_CURVE,
    GOAL_RATE_LIMIT,
    INTEGRAL_ACTION,
    LOOP_DEAD_BAND,
    FIRMWARE_REGULATION,
    COMMAND_DELAY,
    CLOCK_SKEW,
    SAMPLE_HOLD,
    STALE_SAMPLES,
    MISSED_COUNTS,
    ENCODER_ECCENTRICITY,
)
