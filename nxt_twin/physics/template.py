"""The text of a kernel, into which `assemble` puts the terms of its effects; decision 0023 says why it is text."""

from __future__ import annotations

FRAME = '''"""The compiled step of a {kind} ({frame}), written by nxt_twin.physics.assemble; never edit."""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

_framed = njit(error_model="numpy", fastmath={{"contract", "arcp"}})

{imports}


@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def _timing(values, active, out_time_s, ages, target_s, command_time_s, command_moments, acts_s, clock_s):
{unpack}
    delay_s = {base_delay}
{delay}
    pace = 1.0
{pace}
    for k in range(out_time_s.shape[0]):
        target = out_time_s[k]
        stamp_s = target - out_time_s[0] + clock_s
        shown_s, unseen_s, late = ages[k, 0], ages[k, 1], ages[k, 2]
{lag}
        target_s[k] = target
    for k in range(command_time_s.shape[0]):
        acts = command_time_s[k]
        stamp_s = acts - out_time_s[0] + clock_s
        late, longer_after_s, longer_before_s = command_moments[k, 0], command_moments[k, 1], command_moments[k, 2]
{commanded}
        acts_s[k] = acts
    return delay_s, pace, any_lag or any_commanded
'''

RUN = """
def run(
    values, active, span, steps, first, ages,
    measured, judged, anew, gains, reading_std, log_scale, restart, restart_angle, restart_speed, restart_states,
    observe_speed, session_s, predicted, weight, cost, trace, stop,
):
{unpack}
    rows = measured.shape[0]
    home = restart_angle[0]
    angle = 0.0
    speed = 0.0
    current = 0.0
    disturbance = 0.0
    duty = 0.0
    drive_torque = 0.0
    last_reading = 0.0
    begun = 0.0
    inertia = base__inertia
{states_zero_outer}
    for k in range(rows):
        if stop[0]:
            return
        for n in range(first[k], first[k + 1]):
            piece_s = span[n, 0]
            step_s = span[n, 1]
            fading = span[n, 2]
            held = span[n, 4] if span[n, 4] == span[n, 4] else {untold}
            open_circuit_v = span[n, 5]
            others_share = span[n, 6]
            others_speed = span[n, 7]
            others_a, others_s = {others} if others_share > 0.0 else (0.0, 0.0)
            mode = steps[n, 1]
            momentum = 2.0 * inertia / step_s
            for piece in range(steps[n, 0]):
                elapsed_s = span[n, 3] + piece * piece_s
{step}
        reading = measured[k]
        if anew[k]:
            if restart[k]:
                angle = restart_angle[k]
                speed = restart_speed[k]
                current = 0.0
                disturbance = 0.0
                last_reading = speed if observe_speed else angle
{states_restart}
                if restart_states.shape[-1] > 0:
{states_known}
                begun += 1.0
                if any_reading:
                    for _ in range({settling}):
                        shift = 0.0
                        speed_shift = 0.0
{settle}
                        angle = restart_angle[k] - shift
                        speed = restart_speed[k] - speed_shift
        predicted_reading = speed if observe_speed else angle
        if any_reading:
            shift = 0.0
            speed_shift = 0.0
{reading}
            predicted_reading += speed_shift if observe_speed else shift
        predicted[k] = predicted_reading
        weight[k] = 0.0
        cost[k] = 0.0
        if reading == reading:
            counts = 0.0 if restart[k] else 1.0
            innovation = reading - predicted_reading
            fresh = 1.0
            if judged:
                std = reading_std[k]
                log_std = log_scale[k]
                trust = 1.0
                if any_scatter:
                    scatter = 0.0
                    unseen_s, late_open = ages[k, 1], ages[k, 3]
{scatter}
                    trust, std, log_std = _scattered(std, log_std, scatter)
                ratio = innovation / std
                if any_outlier:
                    share = 1.0
                    outlier = 0.0
{outlier}
                    fresh, cost[k] = _believed(ratio, log_std, share, outlier)
                else:
                    cost[k] = 0.5 * ratio * ratio + log_std
                fresh *= trust
            fresh *= counts
            cost[k] *= counts
            weight[k] = fresh
            angle += gains[k, 0] * fresh * innovation
            speed += gains[k, 1] * fresh * innovation
            disturbance += gains[k, 2] * fresh * innovation
            last_reading = reading if counts > 0.0 else last_reading
        if trace.shape[0] > 0:
            shift = 0.0
            speed_shift = 0.0
{reading}
            trace[k, 0] = angle + shift
            trace[k, 1] = speed + speed_shift
            trace[k, 2] = current
            trace[k, 3] = duty
            trace[k, 4] = disturbance
            trace[k, 5] = drive_torque
            if trace.shape[1] > 6:
{states_traced}
"""
"""One parameter set over one recording."""

MANY = """

{compiled}
{run}


{compiled}
def run_many(
    values, active, of, step_max_s, command_time_s, command_moments, command, command_mode, command_supply_v,
    others_time_s, others_load, out_time_s, ages, measured, gains, reading_std, restart, restart_angle, restart_speed,
    restart_states, disturbance_rate, observe_speed, session_s, clock_s, predicted, weight, cost, trace, stop,
):
    target_s, acts_s = np.empty(out_time_s.shape[0]), np.empty(command_time_s.shape[0])
    commands = (acts_s, command, command_mode, command_supply_v)
    others = (others_time_s, others_load)
    span, steps, first = _room(out_time_s, command_time_s, others_time_s)
    log_scale = _log_scales(reading_std)
    judged = reading_std[0, 0] > 0.0
    delay_s, pace, lagged = math.nan, math.nan, False
    for i in range(values.shape[0]):
        before = (delay_s, pace, lagged)
        delay_s, pace, lagged = _timing(
            values[i], active[i], out_time_s, ages, target_s, command_time_s, command_moments, acts_s, clock_s
        )
        if lagged or before != (delay_s, pace, False):
            clock = (delay_s, pace, step_max_s, disturbance_rate)
            _schedule(target_s, commands, others, clock, (span, steps, first))
        v = of[i]
        run(
            values[i], active[i], span, steps, first, ages, measured, judged, restart[v],
            gains[v], reading_std[v], log_scale[v], restart[v], restart_angle[v], restart_speed[v], restart_states[v],
            observe_speed, session_s, predicted[i], weight[i], cost[i], trace, stop,
        )


{compiled}
{abreast}


{compiled}
def run_together(
    values, active, of, step_max_s, command_time_s, command_moments, command, command_mode, command_supply_v,
    others_time_s, others_load, out_time_s, ages, measured, gains, reading_std, restart, restart_angle, restart_speed,
    restart_states, disturbance_rate, observe_speed, session_s, clock_s, predicted, weight, cost, trace, stop,
):
    sets, rows = values.shape[0], out_time_s.shape[0]
    target_s, other_s = np.empty(rows), np.empty(rows)
    acts_s, other_acts_s = np.empty(command_time_s.shape[0]), np.empty(command_time_s.shape[0])
    probe_s, probe_ages = _probes(out_time_s), _probes(ages)
    probe_command_s, probe_moments = _probes(command_time_s), _probes(command_moments)
    probed_s, other_probed_s = np.empty(probe_s.shape[0]), np.empty(probe_s.shape[0])
    probed_acts_s, other_probed_acts_s = np.empty(probe_command_s.shape[0]), np.empty(probe_command_s.shape[0])
    span, steps, first = _room(out_time_s, command_time_s, others_time_s)
    log_scale = _log_scales(reading_std)
    judged = reading_std[0, 0] > 0.0
    anew = _anywhere(restart)
    left = np.ones(sets, np.bool_)
    row = np.empty({most}, np.uint32)
    for i in range(sets):
        if not left[i]:
            continue
        timing = _timing(
            values[i], active[i], out_time_s, ages, target_s, command_time_s, command_moments, acts_s, clock_s
        )
        _timing(
            values[i], active[i], probe_s, probe_ages, probed_s, probe_command_s, probe_moments, probed_acts_s, clock_s
        )
        alike = 0
        for j in range(i, sets):
            if alike < {most} and left[j] and _same(active[i], active[j]):
                # A lag at a few stamps tells most sets apart; without one the rest says all.
                other = _timing(
                    values[j], active[j], probe_s, probe_ages, other_probed_s, probe_command_s, probe_moments,
                    other_probed_acts_s, clock_s,
                )
                equal = other == timing
                if equal and timing[2]:
                    equal = _same(probed_s, other_probed_s) and _same(probed_acts_s, other_probed_acts_s)
                    if equal:
                        _timing(
                            values[j], active[j], out_time_s, ages, other_s, command_time_s, command_moments,
                            other_acts_s, clock_s,
                        )
                        equal = _same(target_s, other_s) and _same(acts_s, other_acts_s)
                if equal:
                    left[j] = False
                    row[alike] = j
                    alike += 1
        if alike < {fewest}:
            for j in row[:alike]:
                run_many(
                    values[j:j + 1], active[j:j + 1], of[j:j + 1], step_max_s, command_time_s, command_moments, command,
                    command_mode, command_supply_v, others_time_s, others_load, out_time_s, ages, measured, gains,
                    reading_std, restart, restart_angle, restart_speed, restart_states, disturbance_rate,
                    observe_speed, session_s, clock_s, predicted[j:j + 1], weight[j:j + 1], cost[j:j + 1], trace, stop,
                )
            continue
        _schedule(
            target_s, (acts_s, command, command_mode, command_supply_v), (others_time_s, others_load),
            (timing[0], timing[1], step_max_s, disturbance_rate), (span, steps, first),
        )
        row[alike:] = row[alike - 1]
        run_abreast(
            (alike + {lanes} - 1) // {lanes}, row, of[row], values, active[i], span, steps, first, ages, measured,
            judged, anew, gains, reading_std, log_scale, restart, restart_angle, restart_speed, restart_states,
            observe_speed, session_s, predicted, weight, cost, stop,
        )
"""
"""Many parameter sets over one recording, each by itself; and those abreast that take the same steps. `of` tells under
which gains and from which starts each set runs, the first index of those arrays."""

COMPILED = '@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp"})'

FORMING = """\
goal = held
supply_v = open_circuit_v
resistance = {resistance}
inductance = 0.0
drop = 0.0
knee = 0.0
limit = math.inf
damping = 0.0
load_torque = 0.0
level = 0.0
borne = 0.0
{goal}
duty = {control}
{duty}
{supply}
if any_inertia:
    inertia = base__inertia
{inertia}
    momentum = 2.0 * inertia / step_s
{resistance_terms}
{inductance}
{drop}
{knee}
{limit}
force, coupling = {drive}
drive_torque = force - coupling * speed
before = speed
mid_angle = angle + 0.5 * step_s * before
{damping}
{torque}
inverse = 1.0 / (momentum + coupling + damping)
free = _free_speed(momentum - coupling - damping, before, force + load_torque + inertia * disturbance, inverse)
direction = math.copysign(1.0, before if before != 0.0 else free)
{friction}
{lean}
dry = level
{borne}
level = max(dry - borne, 0.0)
{hold}
"""
"""What acts in a step: drive, loads, damping, dry friction's level."""

SOLVING = """\
bite = 2.0 * level * inverse
after = _slowed(before, free, direction, bite)
{creep}
"""
"""The speed at the step's end, where the plant is the whole world."""

LEAVING = """\
{advance}
current = {current}
disturbance *= fading
angle += 0.5 * step_s * (before + after)
speed = after
{stop}
"""
"""What the step left behind."""

STEP = FORMING + SOLVING + LEAVING

STEPPING = """

@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def step_many(values_of_all, active_of_all, state, commands, modes, open_circuit_v, elapsed_s, step_s):
    session_s = 0.0
    home = 0.0
    disturbance = 0.0
    fading = 0.0
    others_a, others_s = 0.0, 0.0
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


@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def read_many(values_of_all, active_of_all, state, shown):
    for i in range(values_of_all.shape[0]):
        values = values_of_all[i]
        active = active_of_all[i]
{unpack}
        angle = state[i, 0]
        speed = state[i, 1]
        shift = 0.0
        speed_shift = 0.0
{load}
{reading}
        shown[i, 0] = angle + shift
        shown[i, 1] = speed + speed_shift
"""

TURNING = '''"""What drives joints by {kind} plants ({frame}), written by nxt_twin.physics.assemble; never edit."""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

_framed = njit(error_model="numpy", fastmath={{"contract", "arcp"}})

{imports}


@njit(cache=True, nogil=True, error_model="numpy", fastmath={{"contract", "arcp"}})
def turn_many(
    values_of_all, active_of_all, state, commands, modes, open_circuit_of_both, elapsed_of_both, step_s, joint,
    exerted,
):
    session_s = 0.0
    home = 0.0
    disturbance = 0.0
    fading = 0.0
    others_a, others_s = 0.0, 0.0
    for i in range(values_of_all.shape[0]):
        values = values_of_all[i]
        active = active_of_all[i]
{unpack}
        inertia = base__inertia
        momentum = 2.0 * inertia / step_s
        angle = state[i, 0]
        speed = state[i, 1]
        current = state[i, 2]
{load}
        midway = 0.0
        for phase in range(2):
            held = commands[phase, i]
            mode = modes[phase, i]
            open_circuit_v = open_circuit_of_both[phase]
            elapsed_s = elapsed_of_both[phase]
{forming}
            if phase == 0:
                after = joint[i, 1]
{settling}
                midway = 1.5 * after - 0.5 * before
                angle = joint[i, 0]
                speed = after
        state[i, 0] = angle
        state[i, 1] = speed
        state[i, 2] = current
{store}
        exerted[i, 0] = force + load_torque - (coupling + damping) * midway
        exerted[i, 1] = max(level, 0.0)
'''
"""Plants whose inertia is somebody else's. Phase 0 settles the step that has ended, whose speed the joint now has;
phase 1 forms what acts in the next. That torque falls with speed, so it is that of the step's middle, at which the
speed is foretold by the last step's change: wrong by second order, whatever hangs on the joint."""
