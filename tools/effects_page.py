"""Write docs/effects.md and its pictures from the declarations of the effects."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple, final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects import BUILT_IN
from nxt_twin.physics.library import library
from nxt_twin.physics.parameter import FRAMES, Parameter
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.recording.recording import InputKind
from nxt_twin.view import palette
from nxt_twin.view.legends import name_curves

DOCS: Final = Path(__file__).resolve().parents[1] / "docs"
PAGE: Final = DOCS / "effects.md"
PICTURES: Final = DOCS / "effects"
_DPI: Final = 150

NXT: Final = {
    "kind": "dc_motor",
    "resistance_ohm": 7.6,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "supply_v": 8.0,
}
SERVO: Final = {**NXT, "kind": "servo", "position_gain_pct_per_deg": 0.4}
COAST: Final = 2

OF: Final = {
    "torque_balance": "Friction, loads and the gear train",
    "electrical": "Battery, bridge and winding",
    "measurement": "The encoder",
    "timing": "Stamps and commands",
}
SHOWS: Final = {
    "low_speed": "at low speed",
    "reversal": "where the motion turns back",
    "high_speed": "at high speed",
    "high_current": "at high current",
    "direction": "as a difference between the directions",
    "angle": "at places of the turn",
    "elapsed_time": "as a change with time",
    "after_command": "after a change of the command",
    "after_gap": "after a reading that came late",
}
OTHER_FRAMES: Final = {"rotary": "another rotary plant", "linear": "a linear plant"}

Steps = tuple[tuple[float, float], ...]


@final
@dataclass(frozen=True)
class Scene:
    """An input that shows an effect, and what is drawn of it.

    Attributes:
        params: the effect's values, by name.
        steps: duty (-1 to 1) from each time, s, on; for a servo its goal, in units of 100 deg.
        seconds: how long.
        shown: `speed` in deg/s, `angle` in deg, `current` in A, or `error`: reading less angle, deg.
        coast_after_s: from when on the bridge is open.
        from_s: from when on it is drawn.
    """

    params: dict[str, float]
    steps: Steps
    seconds: float
    shown: str = "speed"
    coast_after_s: float = math.inf
    from_s: float = 0.0


def _stairs(*levels: float, each_s: float) -> Steps:
    return tuple((each_s * i, level) for i, level in enumerate(levels))


_BOTH_WAYS: Final = _stairs(0.4, 0.0, -0.4, 0.0, each_s=0.5)
_SQUARE: Final = _stairs(*(0.6, -0.6) * 4, each_s=0.5)
_GOALS: Final = ((0.0, 0.0), (0.2, 0.9), (1.6, 0.2))
_SLOW: Final = ((0.0, 0.15),)
_RAMP: Final = tuple((0.02 * i, 0.12 * i / 100.0) for i in range(100))

SCENES: Final[dict[str, Scene]] = {
    "coulomb_friction": Scene({"coulomb_friction_nm": 0.03}, _RAMP, 2.0),
    "viscous_friction": Scene(
        {"viscous_friction_nm_s_per_rad": 6e-3}, ((0.0, 1.0), (0.6, 0.0)), 2.0, coast_after_s=0.6
    ),
    "inductance": Scene({"inductance_h": 0.15}, ((0.0, 0.0), (0.02, 1.0), (0.12, 0.0)), 0.2, "current"),
    "current_limit": Scene({"current_limit_a": 0.4}, _SQUARE, 4.0),
    "asymmetric_friction": Scene({"coulomb_forward_nm": 0.06, "coulomb_reverse_nm": 0.01}, _BOTH_WAYS, 2.0),
    "asymmetric_viscous_friction": Scene(
        {"viscous_forward_nm_s_per_rad": 0.012, "viscous_reverse_nm_s_per_rad": 2e-3}, _BOTH_WAYS, 2.0
    ),
    "stiction": Scene({"breakaway_torque_nm": 0.04, "stribeck_speed_rad_s": 1.0}, _RAMP, 2.0),
    "load_dependent_friction": Scene(
        {"friction_per_torque": 0.3}, _stairs(0.0, 0.3, 0.6, 1.0, each_s=0.4), 1.6
    ),
    "friction_warmup": Scene({"cold_extra_torque_nm": 0.04, "time_constant_s": 3.0}, ((0.0, 0.4),), 12.0),
    "angle_dependent_friction": Scene(
        {"binding_torque_nm": 0.06, "cycles_per_turn": 1.0, "phase_deg": 180.0, "sharpness": 4.0},
        ((0.0, 0.25),),
        6.0,
    ),
    "presliding": Scene({"presliding_deg": 6.0}, ((0.0, 0.013), (0.7, 0.0)), 1.4, "angle"),
    "friction_creep": Scene({"creep_speed_rad_s": 0.3}, ((0.0, 0.013), (1.5, 0.0)), 2.5, "angle"),
    "quadratic_drag": Scene(
        {"quadratic_drag_nm_s2_per_rad2": 1e-3}, _stairs(0.25, 0.5, 0.75, 1.0, each_s=0.5), 2.0
    ),
    "constant_load": Scene({"load_torque_nm": 0.03}, _BOTH_WAYS, 2.0),
    "gravity_load": Scene({"gravity_torque_nm": 0.05, "phase_deg": 0.0}, _SLOW, 8.0),
    "spring_load": Scene(
        {"stiffness_nm_per_rad": 0.02, "rest_angle_deg": 0.0}, ((0.0, 0.4), (1.5, 0.0)), 3.0, "angle"
    ),
    "cogging": Scene(
        {"cogging_torque_nm": 0.03, "cycles_per_turn": 6.0, "phase_deg": 0.0}, ((0.0, 0.2),), 3.0
    ),
    "payload_inertia": Scene({"added_inertia_kg_m2": 3e-3, "onset_s": 2.0}, _SQUARE, 4.0),
    "hanging_payload": Scene(
        {"gravity_torque_nm": 0.05, "added_inertia_kg_m2": 3e-3, "phase_deg": 0.0},
        ((0.0, 0.3), (2.0, -0.3)),
        4.0,
    ),
    "commutation_ripple": Scene(
        {"ripple_fraction": 0.4, "cycles_per_turn": 6.0, "phase_deg": 0.0}, _stairs(0.1, 1.0, each_s=1.5), 3.0
    ),
    "end_stop": Scene({"limit_deg": 200.0, "restitution": 0.4}, ((0.0, 0.5), (1.2, -0.5)), 2.0, "angle"),
    "backlash": Scene({"gap_deg": 12.0, "load_inertia_kg_m2": 1.5e-3}, ((0.0, 0.5), (0.4, -0.5)), 0.8),
    "shaft_compliance": Scene(
        {"stiffness_nm_per_rad": 1.0, "load_inertia_kg_m2": 1.5e-3}, ((0.0, 0.5), (0.6, 0.0)), 1.2
    ),
    "torque_saturation": Scene({"torque_yield_per_a": 1.5}, _SQUARE, 2.0),
    "winding_heating": Scene(
        {"resistance_rise_per_joule": 0.1, "thermal_time_constant_s": 20.0},
        _stairs(*(0.7, -0.7) * 20, each_s=0.4),
        16.0,
        from_s=14.4,
    ),
    "battery_sag": Scene({"internal_resistance_ohm": 3.0}, _stairs(0.0, 1.0, -1.0, 0.3, each_s=0.4), 1.6),
    "battery_drain": Scene({"drain_v_per_s": 0.1}, ((0.0, 0.6),), 15.0),
    "voltage_drop": Scene({"drop_v": 0.9}, _stairs(0.0, 0.15, 0.3, 0.6, each_s=0.4), 1.6),
    "power_curve": Scene({"exponent": 1.5}, _stairs(0.25, 0.5, 0.75, 1.0, each_s=0.5), 2.0),
    "goal_rate_limit": Scene({"goal_rate_limit_deg_per_s": 120.0}, _GOALS, 3.0, "angle"),
    "integral_action": Scene({"integral_rate_per_s": 0.7}, _GOALS, 3.0, "angle"),
    "power_limit": Scene({"limit_pct": 25.0}, _GOALS, 3.0, "angle"),
    "loop_dead_band": Scene({"width_deg": 12.0}, _GOALS, 3.0, "angle"),
    "firmware_regulation": Scene(
        {"regulation_p": 96.0},
        tuple((0.1 * n, 0.06 * min(n, 15) + 1e-9 * (n % 2)) for n in range(25)),
        2.5,
        "angle",
    ),
    "command_delay": Scene({"delay_s": 0.06}, ((0.0, 0.0), (0.1, 0.6), (0.5, -0.6)), 0.9),
    "clock_skew": Scene(
        {"lag_span_s": 0.04, "lag_mean": 0.5, "rate_error": 2e-3, "lag_period_s": 3.0, "lag_phase": 0.0},
        ((0.0, 0.5),),
        8.0,
        "error",
    ),
    "sample_hold": Scene({"refresh_period_s": 0.08}, ((0.0, 0.0), (0.1, 0.6), (0.5, -0.6)), 0.9, "angle"),
    "missed_counts": Scene(
        {"loss_fraction": 0.15, "speed_threshold_rad_s": 6.0},
        _stairs(0.25, 0.5, 0.75, 1.0, each_s=0.5),
        2.0,
        "error",
    ),
    "encoder_eccentricity": Scene(
        {"amplitude_deg": 3.0, "cycles_per_turn": 1.0, "phase_deg": 0.0},
        ((0.0, 0.3), (3.0, 0.9)),
        5.0,
        "error",
    ),
}
"""Of every effect but stale samples, which change no motion: their picture is the likelihood of a reading."""


class Drawn(NamedTuple):
    """Two curves over time and the input under them."""

    time_s: np.ndarray
    without: np.ndarray
    having: np.ndarray
    unit: str


def main() -> None:
    """Write the page and the pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for effect in BUILT_IN:
        draw(effect.id)
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE.name}, {len(BUILT_IN)} pictures")


def page() -> str:
    """The text of the page."""
    lines = [_HEAD]
    known = library()
    for equation, title in OF.items():
        lines.append(f"## {title}\n")
        for effect in BUILT_IN:
            if effect.equation_of == equation:
                lines.extend(_section(known[effect.id]))
    return "\n".join(lines)


_HEAD: Final = """\
# The effects

Every effect that a diagnosis can find missing, that a plant file can hold, and that the mock brick and the live twin
can have. This page is written by `tools/effects_page.py` from the declarations in `nxt_twin/physics/effects/`;
change those, not this page. Another package can add its own: see [`examples/user_effect`](../examples/user_effect).

In the pictures the same NXT motor does the same thing twice: in orange without the effect, in blue with it.
The thin line below is the power that is commanded. The sizes are chosen to be seen, not to be typical.

Values are those at the output hub of an NXT motor. On another plant, starts and bounds are scaled with its own torque
and speed. *Starts* are where a fit begins; *prior* is the standard deviation of the weak prior round the first of them,
as a share of it; without one, only the bounds hold. Of a parameter that can only be positive it is of its logarithm.
A value that a baseline file gives has a prior of its own (*given*), of 50% at most.
*If left out*: the value where a plant file does not give the parameter; without one it has to.

Motors of one make differ by a little friction, load and ripple. A diagnosis therefore names an effect only from its
*notable size* on; other plants scale it with torque and speed.
"""


def _section(effect: Effect) -> Iterator[str]:
    yield f"### `{effect.id}`: {effect.name}\n"
    yield f"![with and without {effect.name}](effects/{effect.id}.png)\n"
    yield f"    {effect.equation}\n"
    yield f"Source: {effect.source}.\n"
    yield f"Shows {_listed([SHOWS[regime] for regime in effect.shows])}.\n"
    yield "| parameter | unit | starts | bounds | prior | if left out |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for parameter in effect.parameters:
        yield _row(parameter)
    yield ""
    yield from _notable(effect)
    yield from _remarks(effect)
    yield "Easily taken for:\n"
    built_in = {other.id for other in BUILT_IN}
    for other, why in effect.confusable_with.items():
        if other in built_in:
            yield f"- [`{other}`](#{_anchor(library()[other])}): {why}"
    yield ""


def _notable(effect: Effect) -> Iterator[str]:
    main = effect.parameters[0]
    unit = "" if main.unit == "1" else f" {main.unit}"
    if effect.supersedes:
        measure = f", as half the difference between `{main.name}` and `{effect.parameters[1].name}`"
    else:
        measure = f" more than `{main.above[0]}`" if main.above else ""
    if effect.neutral > main.starts[0]:
        measure = f" below {effect.neutral:g}{unit}"
    if effect.notable > 0.0:
        yield f"Notable size: {effect.notable:g}{unit}{measure}.\n"
    if math.isfinite(effect.notable_most):
        yield f"Notable size: {effect.notable_most:g}{unit} or less.\n"


def _row(parameter: Parameter) -> str:
    starts = ", ".join(f"{start:.4g}" for start in parameter.starts)
    if parameter.hints:
        starts += "; from the recordings"
    prior = [] if math.isinf(parameter.spread) else [f"{parameter.spread:.0%}"]
    prior += [] if math.isinf(parameter.doubt) else [f"given {parameter.doubt:.0%}"]
    prior += ["not fitted where given"] if parameter.frozen else []
    bounds = f"{parameter.lower:.4g} … {parameter.upper:.4g}"
    left_out = "" if parameter.otherwise is None else f"{parameter.otherwise:.4g}"
    cells = (f"`{parameter.name}`", parameter.unit, starts, bounds, ", ".join(prior) or "none", left_out)
    return f"| {' | '.join(cells)} |"


def _remarks(effect: Effect) -> Iterator[str]:
    if effect.states:
        kept = " (kept over a restart)" if effect.lasting else ""
        yield f"Extra states: {_listed([f'`{state}`' for state in effect.states])}{kept}.\n"
    if effect.plain:
        yield "Its parameters are keys of the plant itself, not of an entry under `effects:`.\n"
    if effect.fault:
        yield "A fault of the recording rather than physics of the plant.\n"
    if effect.supersedes:
        yield f"Replaces {_listed([f'`{other}`' for other in effect.supersedes])} while it is in the plant.\n"
    if effect.kinds:
        yield f"Only for plants of kind {_listed([f'`{kind}`' for kind in effect.kinds])}.\n"
    lacking = [OTHER_FRAMES[frame] for frame in FRAMES if frame not in effect.frames]
    if lacking:
        yield f"Not for {_listed(lacking)}.\n"
    for frame in ("rotary", "linear"):
        if frame not in effect.frames:
            continue
        renamed = [p.in_frame(frame) for p in effect.parameters if frame in p.elsewhere]
        if any(
            p.name != q.name
            for p, q in zip([p.in_frame(frame) for p in effect.parameters], effect.parameters, strict=True)
        ):
            names = _listed([f"`{p.name}` ({p.unit})" for p in renamed])
            yield f"On {OTHER_FRAMES[frame]}: {names}.\n"


def _listed(items: list[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _anchor(effect: Effect) -> str:
    """The anchor that a forge makes of a section's heading."""
    kept = "".join(c for c in f"{effect.id}: {effect.name}".lower() if c.isalnum() or c in " -_")
    return kept.replace(" ", "-")


def draw(effect_id: str) -> None:
    """Write an effect's picture."""
    figure_of(effect_id).savefig(PICTURES / f"{effect_id}.png", dpi=_DPI, metadata={"Software": None})


def figure_of(effect_id: str) -> Figure:
    """An effect's picture, to be drawn."""
    figure = Figure(figsize=(5.2, 2.3), layout="constrained")
    if effect_id in SCENES:
        _draw_scene(figure, effect_id, SCENES[effect_id])
    else:
        _draw_likelihood(figure.subplots(), library()[effect_id])
    return figure


def _draw_scene(figure: Figure, effect_id: str, scene: Scene) -> None:
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    drawn = _played(effect_id, scene)
    above.plot(drawn.time_s, drawn.without, color=palette.BASELINE, linewidth=1.3, label="without")
    above.plot(drawn.time_s, drawn.having, color=palette.IMPROVED, linewidth=1.3, label="with")
    palette.dress(above, drawn.unit)
    name_curves(above)
    time_s, power = (list(column) for column in zip(*scene.steps, strict=True))
    below.step(
        [*time_s, scene.seconds],
        [100 * level for level in [*power, power[-1]]],
        where="post",
        color=palette.MUTED,
        linewidth=1,
    )
    palette.dress(below, "goal (deg)" if _is_loop_s(effect_id) else "power (%)", ticks=2)
    palette.name_abscissa(below, "time (s)")
    low, high = min(0.0, *power), max(0.0, *power)
    below.set_ylim(100 * low - 8, 100 * high + 8)
    below.set_xlim(scene.from_s, scene.seconds)


def _played(effect_id: str, scene: Scene) -> Drawn:
    keys = {parameter.name for parameter in library()[effect_id].parameters}
    kind: InputKind = "goal_position_rad" if _is_loop_s(effect_id) else "power_pct"
    bare = {k: value for k, value in (SERVO if _is_loop_s(effect_id) else NXT).items() if k not in keys}
    if effect_id == "integral_action":
        bare["coulomb_friction_nm"] = 0.04  # which leaves an error standing
    plain = plant_from_config(bare, kind)
    nested = {"effects": {effect_id: scene.params}}
    whole = plant_from_config({**bare, **(scene.params if library()[effect_id].plain else nested)}, kind)
    run = _signals(scene, kind)
    without, having = _traces(plain, whole, run)
    match scene.shown:
        case "error":
            true = np.degrees(without["predicted"])
            return Drawn(
                run.time_s,
                0.0 * true,
                np.degrees(having["predicted"]) - true,
                "reading less true angle (deg)",
            )
        case "current":
            return Drawn(run.time_s, without["current"], having["current"], "current (A)")
        case "angle":
            return Drawn(run.time_s, np.degrees(without["angle"]), np.degrees(having["angle"]), "angle (deg)")
        case _:
            return Drawn(
                run.time_s, np.degrees(without["speed"]), np.degrees(having["speed"]), "speed (deg/s)"
            )


def _traces(plain: Plant, whole: Plant, run: Signals) -> list[dict[str, np.ndarray]]:
    with Simulator(plain.layout, workers=1) as simulator:
        return [simulator.trace(plant, free_job(run, at_rest(run))) for plant in (plain, whole)]


def _is_loop_s(effect_id: str) -> bool:
    """Whether the effect is one of a servo's loop."""
    return "servo" in library()[effect_id].kinds


def _signals(scene: Scene, kind: InputKind) -> Signals:
    time_s = np.concatenate([[0.0], np.linspace(max(scene.from_s, 1e-3), scene.seconds, 400)])
    at, level = (np.array(column) for column in zip(*scene.steps, strict=True))
    return Signals(
        name="scene",
        channel="a_tacho_deg",
        input_kind=kind,
        command_time_s=at,
        command=level if kind == "power_pct" else np.radians(100.0 * level),
        command_mode=np.where(at >= scene.coast_after_s, COAST, 0),
        command_supply_v=np.full(at.size, NXT["supply_v"]),
        time_s=time_s,
        measured=np.where(time_s == 0.0, 0.0, np.nan),
        is_speed=False,
        quantum=0.0,
    )


def _draw_likelihood(axes: Axes, effect: Effect) -> None:
    """The density of a reading between the last one, at 0, and the prediction, at 10 deg, with a share of 10 %."""
    reading = np.linspace(-3.0, 13.0, 400)
    fresh = np.exp(-0.5 * (reading - 10.0) ** 2) / math.sqrt(math.tau)
    density = effect.terms["outlier"]
    stale = np.array([float(density(x, 10.0, 0.0, 1.0, 0.1)) for x in reading])  # type: ignore[arg-type]
    axes.plot(reading, fresh, color=palette.BASELINE, linewidth=1.3, label="without")
    axes.plot(reading, 0.9 * fresh + stale, color=palette.IMPROVED, linewidth=1.3, label="with")
    palette.dress(axes, "density of a reading (1/deg)")
    name_curves(axes)
    palette.name_abscissa(axes, "reading (deg)")


if __name__ == "__main__":
    main()
