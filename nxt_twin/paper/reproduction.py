"""Everything in the paper that its text allows to recompute, in one value."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import final

from nxt_twin.paper import printed
from nxt_twin.paper.finding import Comparison, Contradiction
from nxt_twin.paper.motor import MotorNumbers, compare_motor, motor_contradictions, motor_numbers
from nxt_twin.paper.touch import TABLES, compare_touch, means, sensor_deviations, touch_contradictions
from nxt_twin.paper.ultrasonic import UNITS_MM, line_error_mm, ultrasonic_contradictions

FROM_FIGURES_ONLY = (
    "Figure 11 (light sensor across a gradient): the text only says that the slope is constant and that room light"
    " adds an offset. Slope, offset and noise in configs/sensors are not from the paper.",
    "Figure 16 (ultrasonic sensor against distance): modelled from the text's 40, 250 and 1500 mm, the 20 mm error and"
    " the line. The text says that noise grows with distance, without a number.",
    "Figure 17 (beam pattern): modelled from the text's 55 degrees at 438 mm. The beam grows from 138 mm and shrinks"
    " towards 1538 mm; the angles at the ends are not printed.",
)
"""What exists only as a figure, and what stands in for it."""


@final
@dataclass(frozen=True)
class Reproduction:
    """The paper's numbers beside ours."""

    motor: MotorNumbers
    comparisons: tuple[Comparison, ...]
    contradictions: tuple[Contradiction, ...]


def reproduce() -> Reproduction:
    """Recompute the paper."""
    motor = motor_numbers()
    return Reproduction(
        motor=motor,
        comparisons=(*compare_motor(motor), *compare_touch()),
        contradictions=(
            *motor_contradictions(motor),
            *touch_contradictions(),
            *ultrasonic_contradictions(),
        ),
    )


def to_json(reproduction: Reproduction) -> str:
    """The reproduction as JSON, schema `nxt-twin/reproduction/1`."""
    motor = reproduction.motor
    document = {
        "schema": "nxt-twin/reproduction/1",
        "motor": {
            "ks_v_s_per_rad": motor.ks,
            "ks_with_offset_v_s_per_rad": motor.ks_slope,
            "ks_offset_v": motor.ks_offset_v,
            "stall_v": motor.stall_v,
            "static_friction_nm": motor.static_friction_nm,
            "viscous_friction_nm_s_per_rad": motor.viscous,
            "viscous_friction_with_printed_static_nm_s_per_rad": motor.viscous_with_printed,
        },
        "touch": [
            {
                "table": table.number,
                "change": "off to on" if table.pressing else "on to off",
                "unit": table.unit,
                "mean": means(table).tolist(),
                "std": sensor_deviations(table).tolist(),
            }
            for table in TABLES
        ],
        "ultrasonic": {
            "slope": printed.ULTRASONIC_SLOPE,
            "offset": printed.ULTRASONIC_OFFSET,
            "error_mm_if_the_unit_is": {
                unit: [line_error_mm(distance, unit) for distance in printed.ULTRASONIC_LINE_MM]
                for unit in UNITS_MM
            },
        },
        "comparisons": [asdict(comparison) for comparison in reproduction.comparisons],
        "contradictions": [asdict(contradiction) for contradiction in reproduction.contradictions],
        "from_figures_only": list(FROM_FIGURES_ONLY),
    }
    return json.dumps(document, ensure_ascii=False, indent=2)
