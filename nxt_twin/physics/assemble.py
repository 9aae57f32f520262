"""Write the source of a kernel from the declarations of a layout.

The source is plain Python that numba compiles. It holds all effects of the library, each behind its bit of the
active mask. So one compilation serves every combination that a diagnosis tries, with a user's effects.
"""

from __future__ import annotations

import hashlib
import inspect
import itertools
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType

from nxt_twin.physics import abreast as rewriting
from nxt_twin.physics import frame
from nxt_twin.physics.effect import Stage
from nxt_twin.physics.layout import Layout
from nxt_twin.physics.stages import STAGES
from nxt_twin.physics.template import COMPILED, FORMING, FRAME, LEAVING, MANY, RUN, STEP, STEPPING, TURNING
from nxt_twin.physics.terms import Call, calls

SETTLING = 6
"""How often a start's angle is corrected for what the encoder makes of it; each time it errs by a third at most."""

_MIDWAY: tuple[Stage, ...] = ("damping", "torque", "friction", "lean", "borne", "hold", "advance")
"""The stages whose `angle` is that of the middle of a step."""

_HELD = (
    "load_torque -= grasp",
    "damping += grip",
    "inverse = 1.0 / (momentum + coupling + damping)",
    "free = _free_speed(",
    "    momentum - coupling - damping, before, force + load_torque + inertia * disturbance, inverse",
    ")",
    "level = 0.0",
)

_FORMED = frozenset({"resistance", "supply_v"})
"""Parameters of a base that a step forms anew."""

_FRAME = (
    frame.room,
    frame.schedule,
    frame.log_scales,
    frame.anywhere,
    frame.same,
    frame.probes,
    frame.free_speed,
    frame.slowed,
    frame.scattered,
    frame.believed,
)
"""What a kernel calls whatever effects are in it."""

_FEWEST_GROUPED = 3  # lines of one stage that are worth a flag of their own

TRACE = ("angle", "speed", "current", "duty", "disturbance", "drive_torque")
"""Columns of a kernel's trace, one row a sample, after its correction; angle and speed as the encoder shows them."""


def source(plan: Layout) -> str:
    """The kernel's source text for `plan`."""
    return _source(plan, rewriting.abreast)


def source_outline(plan: Layout) -> str:
    """A text that differs wherever `source` would: it holds the code that rewrites a run, in place of what that writes.

    Rewriting takes longer than all the rest of a start, and a compiled kernel needs no more than its name.
    """
    return _source(plan, lambda _: inspect.getsource(rewriting))


def _source(plan: Layout, rewritten: Callable[[str], str]) -> str:
    step = _step(plan)
    states = [f"{effect.id}__{state}" for effect in plan.effects for state in effect.states]
    beginning = FRAME.format(
        kind=plan.base.kind,
        frame=plan.frame,
        imports="\n".join(_imports(plan)),
        unpack=_indent(_unpack(plan), 4),
        base_delay=f"base__{plan.base.delay}" if plan.base.delay else "0.0",
        delay=_indent(_stage(plan, "delay"), 4),
        pace=_indent(_stage(plan, "pace"), 4),
        lag=_indent(_stage(plan, "lag"), 8),
        commanded=_indent(_stage(plan, "commanded"), 8),
    )
    run = _run(plan, step, states)
    many = MANY.format(
        compiled=COMPILED,
        run=run.strip(),
        abreast=rewritten(run),
        lanes=rewriting.LANES,
        most=rewriting.MOST,
        fewest=rewriting.FEWEST,
    )
    stepping = STEPPING.format(
        unpack=_indent(_unpack(plan), 8),
        load=_indent((f"{state} = state[i, {3 + n}]" for n, state in enumerate(states)), 8),
        step=_indent(iter(step), 8),
        reading=_indent(_stage(plan, "reading"), 8),
        store=_indent((f"state[i, {3 + n}] = {state}" for n, state in enumerate(states)), 8),
    )
    return beginning + many + stepping


def _run(plan: Layout, step: list[str], states: list[str]) -> str:
    """The function that runs one parameter set."""
    carried = ["current", *states]
    return RUN.format(
        unpack=_indent(_unpack(plan), 4),
        states_zero_outer=_indent((f"{state} = 0.0" for state in states), 4),
        states_restart=_indent(_restart(plan), 16),
        states_known=_indent((f"{s} = restart_states[int(begun), {n}]" for n, s in enumerate(carried)), 20),
        states_traced=_indent((f"trace[k, {len(TRACE) + n}] = {s}" for n, s in enumerate(carried)), 16),
        others=_others(plan),
        # A loop of the device holds what it stands at until it is told a goal; nothing drives another motor.
        untold="home" if plan.base.control else "0.0",
        step=_indent(iter(step), 16),
        settling=SETTLING,
        settle=_indent(_stage(plan, "reading"), 24),
        reading=_indent(_stage(plan, "reading"), 12),
        scatter=_indent(_stage(plan, "scatter"), 20),
        outlier=_indent(_stage(plan, "outlier"), 20),
    )


def turning_source(plan: Layout) -> str:
    """The source text of what drives joints by plants of `plan`."""
    states = [f"{effect.id}__{state}" for effect in plan.effects for state in effect.states]
    return TURNING.format(
        kind=plan.base.kind,
        frame=plan.frame,
        imports="\n".join(_imports(plan)),
        unpack=_indent(_unpack(plan), 8),
        load=_indent((f"{state} = state[i, {3 + n}]" for n, state in enumerate(states)), 8),
        forming=_indent(iter(_step(plan, FORMING)), 12),
        settling=_indent(iter(_step(plan, LEAVING)), 16),
        store=_indent((f"state[i, {3 + n}] = {state}" for n, state in enumerate(states)), 8),
    )


def _step(plan: Layout, part: str = STEP) -> list[str]:
    """One step or a part of it, line by line, as it stands in each of the kernel's functions."""
    symbols = [parameter.symbol for parameter in plan.base.parameters]
    settle = plan.base.current_after
    current = _call(plan, "_current_after", settle) if settle else "0.0"
    lines = {stage: "\n".join(_stage(plan, stage)) for stage in STAGES}
    return part.format(
        **{stage: text for stage, text in lines.items() if stage not in ("inertia", "resistance")},
        inertia=_indent(_stage(plan, "inertia"), 4),
        resistance="base__resistance" if "resistance" in symbols else "0.0",
        resistance_terms=lines["resistance"],
        control=_call(plan, "_control", plan.base.control) if plan.base.control else "goal",
        drive=_call(plan, "_drive", plan.base.drive),
        current=current,
    ).splitlines()


def fingerprint(plan: Layout, text: str) -> str:
    """A hash of a source text written for `plan` and of the byte code of every function it calls."""
    digest = hashlib.sha256(text.encode())
    for function in [*_functions(plan), *_helpers(plan)]:
        code = function.__code__
        digest.update(code.co_code)
        digest.update(repr(code.co_names).encode())
        digest.update(repr([c for c in code.co_consts if not isinstance(c, CodeType)]).encode())
        constants = {name: function.__globals__.get(name) for name in code.co_names}
        digest.update(repr({k: v for k, v in constants.items() if isinstance(v, int | float)}).encode())
    return digest.hexdigest()[:16]


def _helpers(plan: Layout) -> list[FunctionType]:
    """The module-level functions that terms call in turn, which numba has to know as well."""
    found: dict[str, FunctionType] = {}
    waiting = list(_functions(plan))
    while waiting:
        function = waiting.pop()
        for name in function.__code__.co_names:
            helper = function.__globals__.get(name)
            if isinstance(helper, FunctionType) and (key := f"{helper.__module__}.{name}") not in found:
                found[key] = helper
                waiting.append(helper)
    return [found[key] for key in sorted(found)]


def _functions(plan: Layout) -> list[FunctionType]:
    terms = [effect.terms[stage] for effect in plan.effects for stage in effect.terms]
    own = [plan.base.drive, plan.base.current_after, plan.base.drawn_by_others, plan.base.control]
    return [function for function in [*_FRAME, *own, *terms] if isinstance(function, FunctionType)]


def _imports(plan: Layout) -> Iterator[str]:
    modules = sorted({function.__module__ for function in [*_functions(plan), *_helpers(plan)]})
    for module in modules:
        yield f"import {module}"
    yield ""
    for helper in _helpers(plan):
        yield f"register_jitable(forceinline=True)({helper.__module__}.{helper.__name__})"
    for function in _FRAME:
        yield f"_{function.__name__} = _framed({function.__module__}.{function.__name__})"
    yield f"_drive = njit({plan.base.drive.__module__}.{plan.base.drive.__name__})"
    if settle := plan.base.current_after:
        yield f"_current_after = njit({settle.__module__}.{settle.__name__})"
    if control := plan.base.control:
        yield f"_control = njit({control.__module__}.{control.__name__})"
    if others := plan.base.drawn_by_others:
        yield f"_drawn_by_others = njit({others.__module__}.{others.__name__})"
    for effect in plan.effects:
        for stage, term in effect.terms.items():
            yield f"_{effect.id}_{stage} = njit({term.__module__}.{term.__name__}, forceinline=True)"


def _unpack(plan: Layout) -> Iterator[str]:
    for i, slot in enumerate(plan.parameters):
        yield f"{slot.owner}__{slot.symbol} = values[{i}]"
    for i, effect in enumerate(plan.effects):
        yield f"with_{effect.id} = active[{i}]"
    for stage in STAGES:
        rarer = [f"with_{call.effect.id}" for call in calls(plan, stage) if not call.effect.plain]
        yield f"any_{stage} = {' or '.join(rarer) or 'False'}"


def _restart(plan: Layout) -> Iterator[str]:
    for effect in plan.effects:
        for state in effect.states:
            if state not in effect.lasting:
                moves = "speed" if state in effect.moving else "0.0"
                yield f"{effect.id}__{state} = {'angle' if state in effect.placed else moves}"


def _others(plan: Layout) -> str:
    """What the other motors draw, as long as nothing changes what they do."""
    others = plan.base.drawn_by_others
    return _call(plan, "_drawn_by_others", others, formed=frozenset()) if others else "(0.0, 0.0)"


def _call(plan: Layout, name: str, function: Callable[..., object], formed: frozenset[str] = _FORMED) -> str:
    """A call of one of the base's functions, each argument by its name in the kernel."""
    own = {parameter.symbol for parameter in plan.base.parameters}
    names = inspect.signature(function).parameters
    arguments = (f"base__{name}" if name in own - formed else name for name in names)
    return f"{name}({', '.join(arguments)})"


def _stage(plan: Layout, stage: Stage) -> Iterator[str]:
    """The terms of a stage, each behind its bit; runs of rarer ones behind one flag for all of them."""
    for plain, run in itertools.groupby(calls(plan, stage), key=lambda call: call.effect.plain):
        lines = [line for call in run for line in _guarded(call, stage)]
        grouped = not plain and len(lines) > _FEWEST_GROUPED
        if grouped:
            yield f"if any_{stage}:"
        for line in lines:
            yield f"    {line}" if grouped else line


def _guarded(call: Call, stage: Stage) -> Iterator[str]:
    yield f"if with_{call.effect.id}:"
    for line in _statements(call, stage):
        yield f"    {line}"


def _statements(call: Call, stage: Stage) -> Iterator[str]:
    effect = call.effect
    own = {parameter.symbol for parameter in effect.parameters} | set(effect.states)
    rename = {"predicted": "predicted_reading", "reading_std": "std"}
    if stage in _MIDWAY:
        rename["angle"] = "mid_angle"
    arguments = ", ".join(f"{effect.id}__{a}" if a in own else rename.get(a, a) for a in call.arguments)
    value = f"_{effect.id}_{stage}({arguments})"
    match STAGES[stage].combine:
        case "replace":
            yield f"{STAGES[stage].quantity} = {value}"
        case "states":
            yield f"{', '.join(f'{effect.id}__{state}' for state in effect.states)} = {value}"
        case "take":
            yield f"{STAGES[stage].quantity} -= {value}"
        case "motion":
            yield f"angle, speed = {value}"
        case "shift":
            yield f"moved, quickened = {value}"
            yield "shift += moved"
            yield "speed_shift += quickened"
        case "hold":
            yield f"grasp, grip = {value}"
            yield from _HELD
        case _:
            yield f"{STAGES[stage].quantity} += {value}"
    if stage == "outlier":
        yield f"share -= {effect.id}__{effect.parameters[0].symbol}"


def _indent(lines: Iterator[str], width: int) -> str:
    return "\n".join(" " * width + line for line in lines)
