"""Write the source of a kernel from the declarations of a layout.

The source is plain Python that numba compiles. All effects of the library are in it, each behind its bit of the
active mask, so that one compilation serves every combination that a diagnosis tries, a user's effects included.
"""

from __future__ import annotations

import hashlib
import inspect
import itertools
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType

from nxt_twin.physics.effect import Stage
from nxt_twin.physics.layout import Layout
from nxt_twin.physics.stages import STAGES
from nxt_twin.physics.terms import Call, calls

_FRAME = '''"""The compiled step of a {kind} ({frame}), written by nxt_twin.physics.assemble; never edit."""

import math

from numba import njit
from numba.extending import register_jitable

{imports}

_SQRT_TAU = math.sqrt(2.0 * math.pi)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def run(
    values, active, step_max_s, command_time_s, command, command_mode, command_supply_v,
    out_time_s, measured, gains, reading_std, restart, restart_angle, restart_speed,
    disturbance_rate, observe_speed, predicted, weight, cost, trace,
):
{unpack}
    delay_s = 0.0
{delay}
    rows = out_time_s.shape[0]
    commands = command_time_s.shape[0]
    t = out_time_s[0]
    j = -1
    angle = 0.0
    speed = 0.0
    current = 0.0
    disturbance = 0.0
    duty = 0.0
    drive_torque = 0.0
    last_reading = 0.0
    inertia = base__inertia
{states_zero_outer}
    for k in range(rows):
        target = out_time_s[k]
        while t < target:
            while j + 1 < commands and command_time_s[j + 1] + delay_s <= t:
                j += 1
            stop = target
            if j + 1 < commands and command_time_s[j + 1] + delay_s < target:
                stop = command_time_s[j + 1] + delay_s
            held = command[j] if j >= 0 else 0.0
            mode = command_mode[j] if j >= 0 else command_mode[0]
            supply_v = command_supply_v[j] if j >= 0 else command_supply_v[0]
            pieces = max(1, int(math.ceil((stop - t) / step_max_s - 1e-9)))
            step_s = (stop - t) / pieces
            fading = math.exp(-step_s * disturbance_rate)
            momentum = 2.0 * inertia / step_s
            for piece in range(pieces):
                elapsed_s = t + piece * step_s - out_time_s[0]
{step}
            t = stop
        reading = measured[k]
        if restart[k]:
            angle = restart_angle[k]
            speed = restart_speed[k]
            current = 0.0
            disturbance = 0.0
            last_reading = speed if observe_speed else angle
{states_restart}
        predicted_reading = speed if observe_speed else angle
        predicted[k] = predicted_reading
        weight[k] = 0.0
        cost[k] = 0.0
        if reading == reading and not restart[k]:
            innovation = reading - predicted_reading
            std = reading_std[k]
            fresh = 1.0
            if std > 0.0:
                share = 1.0
                outlier = 0.0
{outlier}
                if share < 1.0:
                    ratio = innovation / std
                    density = share * math.exp(-0.5 * ratio * ratio) / (std * _SQRT_TAU)
                    total = density + outlier + 1e-300
                    fresh = density / total
                    cost[k] = -math.log(total)
                else:
                    cost[k] = 0.5 * (innovation / std) ** 2 + math.log(std * _SQRT_TAU)
            weight[k] = fresh
            angle += gains[k, 0] * fresh * innovation
            speed += gains[k, 1] * fresh * innovation
            disturbance += gains[k, 2] * fresh * innovation
            last_reading = reading
        if trace.shape[0] > 0:
            trace[k, 0] = angle
            trace[k, 1] = speed
            trace[k, 2] = current
            trace[k, 3] = duty
            trace[k, 4] = disturbance
            trace[k, 5] = drive_torque


@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def run_many(
    values, active, step_max_s, command_time_s, command, command_mode, command_supply_v,
    out_time_s, measured, gains, reading_std, restart, restart_angle, restart_speed,
    disturbance_rate, observe_speed, predicted, weight, cost, trace,
):
    for i in range(values.shape[0]):
        run(
            values[i], active[i], step_max_s, command_time_s, command, command_mode, command_supply_v,
            out_time_s, measured, gains, reading_std, restart, restart_angle, restart_speed,
            disturbance_rate, observe_speed, predicted[i], weight[i], cost[i], trace,
        )
'''

_STEP = """\
duty = held
{duty}
resistance = {resistance}
{resistance_terms}
inductance = 0.0
{inductance}
drop = 0.0
{drop}
limit = math.inf
{limit}
force, coupling = {drive}
drive_torque = force - coupling * speed
before = speed
mid_angle = angle + 0.5 * step_s * before
damping = 0.0
{damping}
load_torque = 0.0
{torque}
inverse = 1.0 / (momentum + coupling + damping)
free = (
    (momentum - coupling - damping) * before
    + 2.0 * (force + load_torque + inertia * disturbance)
) * inverse
direction = math.copysign(1.0, before if before != 0.0 else free)
level = 0.0
{friction}
bite = 2.0 * level * inverse
after = free - direction * bite
if after * direction < 0.0:
    push = direction * (before - free) - bite
    after = -direction * push * (1.0 - direction * before / (push + 2.0 * bite)) if push > 0.0 else 0.0
{advance}
current = {current}
angle += 0.5 * step_s * (before + after)
speed = after
disturbance *= fading
"""

_STEPPING = """

@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def step_many(values_of_all, active_of_all, state, commands, modes, supply_v, elapsed_s, step_s):
    disturbance = 0.0
    fading = 0.0
    for i in range(values_of_all.shape[0]):
        values = values_of_all[i]
        active = active_of_all[i]
{unpack}
        inertia = base__inertia
        momentum = 2.0 * inertia / step_s
        held = commands[i]
        mode = modes[i]
        angle = state[i, 0]
        speed = state[i, 1]
        current = state[i, 2]
{load}
{step}
        state[i, 0] = angle
        state[i, 1] = speed
        state[i, 2] = current
{store}
"""

_FEWEST_GROUPED = 3  # lines of one stage that are worth a flag of their own

TRACE = ("angle", "speed", "current", "duty", "disturbance", "drive_torque")
"""Columns of a kernel's trace, one row a sample, after the sample's correction."""


def source(plan: Layout) -> str:
    """The kernel's source text for `plan`."""
    step = _step(plan)
    states = [f"{effect.id}__{state}" for effect in plan.effects for state in effect.states]
    running = _FRAME.format(
        kind=plan.base.kind,
        frame=plan.frame,
        imports="\n".join(_imports(plan)),
        unpack=_indent(_unpack(plan), 4),
        delay=_indent(_stage(plan, "delay"), 4),
        states_zero_outer=_indent((f"{state} = 0.0" for state in states), 4),
        states_restart=_indent(_restart(plan), 12),
        step=_indent(iter(step), 16),
        outlier=_indent(_stage(plan, "outlier"), 16),
    )
    stepping = _STEPPING.format(
        unpack=_indent(_unpack(plan), 8),
        load=_indent((f"{state} = state[i, {3 + n}]" for n, state in enumerate(states)), 8),
        step=_indent(iter(step), 8),
        store=_indent((f"state[i, {3 + n}] = {state}" for n, state in enumerate(states)), 8),
    )
    return running + stepping


def _step(plan: Layout) -> list[str]:
    """One step, line by line, as it stands in both of the kernel's functions."""
    symbols = [parameter.symbol for parameter in plan.base.parameters]
    settle = plan.base.current_after
    current = _call(plan, "_current_after", settle) if settle else "0.0"
    return _STEP.format(
        duty="\n".join(_stage(plan, "duty")),
        resistance="base__resistance" if "resistance" in symbols else "0.0",
        resistance_terms="\n".join(_stage(plan, "resistance")),
        inductance="\n".join(_stage(plan, "inductance")),
        drop="\n".join(_stage(plan, "drop")),
        limit="\n".join(_stage(plan, "limit")),
        drive=_call(plan, "_drive", plan.base.drive),
        damping="\n".join(_stage(plan, "damping")),
        torque="\n".join(_stage(plan, "torque")),
        friction="\n".join(_stage(plan, "friction")),
        advance="\n".join(_stage(plan, "advance")),
        current=current,
    ).splitlines()


def fingerprint(plan: Layout) -> str:
    """A hash of the kernel's source and of the byte code of every function it calls."""
    digest = hashlib.sha256(source(plan).encode())
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
    own = [plan.base.drive, plan.base.current_after]
    return [function for function in [*own, *terms] if isinstance(function, FunctionType)]


def _imports(plan: Layout) -> Iterator[str]:
    modules = sorted({function.__module__ for function in [*_functions(plan), *_helpers(plan)]})
    for module in modules:
        yield f"import {module}"
    yield ""
    for helper in _helpers(plan):
        yield f"register_jitable({helper.__module__}.{helper.__name__})"
    yield f"_drive = njit({plan.base.drive.__module__}.{plan.base.drive.__name__})"
    if settle := plan.base.current_after:
        yield f"_current_after = njit({settle.__module__}.{settle.__name__})"
    for effect in plan.effects:
        for stage, term in effect.terms.items():
            yield f"_{effect.id}_{stage} = njit({term.__module__}.{term.__name__})"


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
            yield f"{effect.id}__{state} = {'speed' if state in effect.moving else '0.0'}"


def _call(plan: Layout, name: str, function: Callable[..., object]) -> str:
    """A call of one of the base's functions, each argument by its name in the kernel."""
    own = {parameter.symbol for parameter in plan.base.parameters}
    formed = {"resistance", "supply_v"}
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
    yield f"    {_statement(call, stage)}"
    if stage == "outlier":
        yield f"    share -= {call.effect.id}__{call.effect.parameters[0].symbol}"


def _statement(call: Call, stage: Stage) -> str:
    effect = call.effect
    own = {parameter.symbol for parameter in effect.parameters} | set(effect.states)
    rename = {"angle": "mid_angle", "predicted": "predicted_reading", "reading_std": "std"}
    arguments = ", ".join(f"{effect.id}__{a}" if a in own else rename.get(a, a) for a in call.arguments)
    value = f"_{effect.id}_{stage}({arguments})"
    match stage:
        case "duty" | "limit":
            return f"{stage} = {value}"
        case "friction":
            return f"level = {value}"
        case "torque":
            return f"load_torque += {value}"
        case "delay":
            return f"delay_s += {value}"
        case "advance":
            return f"{', '.join(f'{effect.id}__{state}' for state in effect.states)} = {value}"
        case _:
            return f"{stage} += {value}"


def _indent(lines: Iterator[str], width: int) -> str:
    return "\n".join(" " * width + line for line in lines)
