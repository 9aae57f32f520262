"""Section III-C recomputed: what the ultrasonic sensor's line can mean."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from nxt_twin.paper import printed
from nxt_twin.paper.finding import Contradiction

UNITS_MM: Final[Mapping[str, float]] = MappingProxyType({"mm": 1.0, "cm": 10.0, "m": 1000.0})


def line_error_mm(distance_mm: float, unit: str) -> float:
    """By how much the printed line exceeds the true distance if its numbers are in `unit`, mm."""
    offset_mm = printed.ULTRASONIC_OFFSET * UNITS_MM[unit]
    return (printed.ULTRASONIC_SLOPE - 1.0) * distance_mm + offset_mm


def ultrasonic_contradictions() -> list[Contradiction]:
    """Where section III-C disagrees with itself."""
    near, far = printed.ULTRASONIC_LINE_MM
    errors = "; ".join(
        f"in {unit} they are +{line_error_mm(near, unit):.1f} mm at {near:.0f} mm and"
        f" +{line_error_mm(far, unit):.1f} mm at {far:.0f} mm"
        for unit in UNITS_MM
    )
    return [
        Contradiction(
            id="ultrasonic_line",
            title="The ultrasonic line has no unit, and none makes it correct",
            where="III-C",
            claim="between 250 and 1500 mm the sensor measures correctly, along y = 1.0055 x + 0.013",
            evidence=f"the line's unit is not given, and the errors that it means depend on it:"
            f" {errors}. In m, the error exceeds the sensor's"
            " step of 10 mm everywhere, and nearly joins the 20 mm error below 250 mm. In mm or"
            " cm, the error stays below one step, but jumps by 18 mm at 250 mm",
            cause="the figure's axes are probably in metres (SI, as in Table II), and 'correctly' means linearly",
            used="metres for the line, as a sensor's deviation from the ideal. A change of 3 °C in air temperature has"
            " nearly this slope, so the slope should be fitted anew in every room",
        )
    ]
