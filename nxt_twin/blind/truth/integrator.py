"""The equations of motion, and classical fourth-order Runge-Kutta steps through them."""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.truth import friction, load, surprises, winding
from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.machine_code import forget_outdated

LONGEST_STEP_S = 25e-6
THETA, OMEGA, CURRENT, BEND, THETA_LOAD, OMEGA_LOAD, HEAT, MISCOUNT, MEMORY = range(9)
STATES = 9
MISCOUNT_ROUNDING_RAD_S = 0.1


@compiled
def _rates(
    motor: Motor, t: float, x: FloatArray, duty: float, mode: int, push: float, out: FloatArray
) -> None:
    theta, omega, current, memory = x[THETA], x[OMEGA], x[CURRENT], x[MEMORY]
    bridge_duty = surprises.duty_in_force(motor, duty, memory)
    inertia = motor.inertia_kg_m2
    if t >= motor.added_from_s:
        inertia += motor.added_inertia_kg_m2
    inertia += motor.arm_mass_kg * motor.arm_length_m**2

    drive = motor.torque_constant_nm_per_a * current * surprises.torque_ripple(motor, theta, current)
    outside = load.outside_torque(motor, theta) + load.stop_torque(motor, theta, omega)
    outside += push + surprises.hub_torque(motor, t, theta, omega, x[OMEGA_LOAD], memory)
    out[THETA_LOAD] = x[OMEGA_LOAD]
    out[OMEGA_LOAD] = 0.0
    if motor.load_inertia_kg_m2 != 0.0:
        pull = load.coupling_torque(motor, theta - x[THETA_LOAD], omega - x[OMEGA_LOAD])
        out[OMEGA_LOAD] = (pull - motor.load_drag_nm_s_per_rad * x[OMEGA_LOAD]) / motor.load_inertia_kg_m2
        outside -= pull
    elif int(motor.surprise) == surprises.BELT_SLIP:
        out[OMEGA_LOAD] = surprises.load_rate(motor, omega, x[OMEGA_LOAD])

    carried = 0.0
    if motor.friction_per_torque != 0.0:
        carried = math.sqrt(math.sqrt(drive**4 + outside**4))  # about the larger of the two
    film = surprises.film_torque(motor, memory)
    level = friction.sliding_level(motor, t, theta, omega, carried, film)
    stiffness = friction.bristle_stiffness(motor)
    out[BEND] = friction.bristle_rate(motor, stiffness, level, omega, x[BEND])
    held = friction.bristle_torque(motor, stiffness, inertia, omega, x[BEND], out[BEND])
    viscous = (motor.viscous_friction_nm_s_per_rad + motor.quadratic_drag_nm_s2_per_rad2 * abs(omega)) * omega

    out[THETA] = omega
    out[OMEGA] = (drive + outside - held - viscous) / inertia
    out[CURRENT] = winding.current_rate(motor, t, omega, current, x[HEAT], bridge_duty, mode)
    joule_w = motor.resistance_ohm * current * current
    out[HEAT] = motor.resistance_rise_per_joule * joule_w - x[HEAT] / motor.thermal_time_s
    out[MISCOUNT] = surprises.count_rate(motor, t, omega)
    if motor.lost_fraction != 0.0:
        fast = 0.5 * (1.0 + math.tanh((abs(omega) - motor.lost_above_rad_s) / MISCOUNT_ROUNDING_RAD_S))
        out[MISCOUNT] -= motor.lost_fraction * fast * omega
    out[MEMORY] = surprises.memory_rate(motor, omega, current, duty, memory, out[OMEGA])


@compiled
def integrate(
    motor: Motor,
    start: FloatArray,
    time_s: FloatArray,
    duty: FloatArray,
    mode: IntArray,
    push_nm: FloatArray,
    states: FloatArray,
    terminal_v: FloatArray,
) -> None:
    """Run the motor from one event to the next, in equal steps of at most 25 µs.

    Args:
        motor: the record of a `Motor`.
        start: the state at the first event, shape (9,), in the order THETA … MEMORY.
        time_s: the events, increasing, shape (n,).
        duty: the duty in force from each event to the next, -1…1, shape (n,).
        mode: the drive mode likewise (0 drive, 1 float, 2 coast, 3 brake).
        push_nm: an outside torque likewise, N·m.
        states: receives the state at each event, shape (n, 9).
        terminal_v: receives the battery's terminal voltage just after each event, V, shape (n,).
    """
    x = start.copy()
    k = np.zeros((4, STATES))
    y = np.zeros(STATES)
    for event in range(time_s.size):
        states[event, :] = x
        terminal_v[event] = winding.terminal_v(motor, time_s[event], duty[event], x[CURRENT], mode[event])
        if event + 1 == time_s.size:
            break
        span = time_s[event + 1] - time_s[event]
        steps = max(1, math.ceil(span / LONGEST_STEP_S - 1e-6))
        h = span / steps
        for step in range(steps):
            t = time_s[event] + step * h
            _rates(motor, t, x, duty[event], mode[event], push_nm[event], k[0])
            for j in range(STATES):
                y[j] = x[j] + 0.5 * h * k[0, j]
            _rates(motor, t + 0.5 * h, y, duty[event], mode[event], push_nm[event], k[1])
            for j in range(STATES):
                y[j] = x[j] + 0.5 * h * k[1, j]
            _rates(motor, t + 0.5 * h, y, duty[event], mode[event], push_nm[event], k[2])
            for j in range(STATES):
                y[j] = x[j] + h * k[2, j]
            _rates(motor, t + h, y, duty[event], mode[event], push_nm[event], k[3])
            for j in range(STATES):
                x[j] += h * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j]) / 6.0


forget_outdated(integrate, friction, load, surprises, winding)
