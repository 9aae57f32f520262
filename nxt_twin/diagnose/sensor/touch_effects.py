"""Effects of a touch sensor beyond switching at one force."""

from __future__ import annotations

from nxt_twin.diagnose.sensor.declaration import SensorEffect, SensorParameter

_EQUATION = (
    "closes where the force rises past F_press, opens where it falls past F_release (Gonçalves et al. III.B)"
)


def hysteresis(stroke: str) -> SensorEffect:
    """Hysteresis by `force_g` or by `travel_mm`, whichever the rig has measured."""
    top, scale = (1000.0, 1.0) if stroke == "force_g" else (10.0, 0.05)
    unit = "g" if stroke == "force_g" else "mm"
    return SensorEffect(
        id="touch_hysteresis",
        name="hysteresis",
        equation=_EQUATION
        if stroke == "force_g"
        else _EQUATION.replace("force", "travel").replace("F_", "s_"),
        shows=("rising", "falling"),
        replaces=(f"switch_{stroke}",),
        parameters=tuple(
            SensorParameter(f"{way}_{stroke}", f"{way}_{stroke}", unit, 0.0, top, scale, None)
            for way in ("press", "release")
        ),
    )
