"""How the wheels' angles answer to each number of motors and body: exact slopes along one simulation."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.machine_code import forget_outdated
from nxt_twin.physics.robot import dynamics
from nxt_twin.physics.robot.dynamics import (
    DROPS_V,
    GRAVITY,
    LEAST_BACK_M,
    LOAD_GYRATION,
    NAMES,
    STICK_RAD_PER_S,
    STILL_RAD_PER_S,
    accelerations,
    caster_share,
    crawl,
    drag_per_speed,
    driving,
    dropped,
    gravity,
    inertias,
    longest_step_s,
    share_left,
    smooth_sign,
    solved,
)

STARTS: Final = 2
"""The first columns are slopes by the starting travel and turning rate; those by `NAMES` follow."""
COLUMNS: Final = STARTS + len(NAMES)
_FORCES: Final = 14
_SHARES: Final = 16
"""Rows of the working room behind those of the balances: two for the motors' torques, one for the battery."""
_ROOM: Final = (17, 7)


@njit(cache=True, error_model="numpy")
def _bend(x: float) -> float:
    """The slope of the smooth sign."""
    grown = 1.0 + x * x
    return 1.0 / (grown * math.sqrt(grown))


@njit(cache=True, error_model="numpy")
def _of_force(
    rate: float,
    source: tuple[float, float],
    held: float,
    floats: float,
    p: FloatArray,
    k: int,
    out: FloatArray,
) -> tuple[float, float]:
    """Slopes of a wheel's torque by its motor's numbers into `out`; returned by its rate and by the share held."""
    across = held * source[0] - p[k] * rate
    above, below = (across + p[24 + k]) / DROPS_V, (across - p[24 + k]) / DROPS_V
    rises, falls = smooth_sign(above), smooth_sign(below)
    per_v = source[1] * p[k] / p[2 + k]
    if floats > 0.5 and across * held * source[0] <= 0.0:
        per_v = 0.0
    torque = per_v * (across - dropped(across, p[24 + k]))
    by_across = per_v * (1.0 - 0.5 * (rises - falls))
    way = smooth_sign(rate / STICK_RAD_PER_S)
    turns = _bend(rate / STICK_RAD_PER_S) / STICK_RAD_PER_S
    out[_FORCES + k, 0] = torque / p[k] - by_across * rate
    out[_FORCES + k, 1] = -torque / p[2 + k]
    out[_FORCES + k, 2] = -way
    out[_FORCES + k, 3] = -rate
    out[_FORCES + k, 4] = -way * way
    out[_FORCES + k, 5] = -abs(rate) * rate
    out[_FORCES + k, 6] = -0.5 * per_v * (rises + falls)
    friction = (p[4 + k] + 2.0 * p[20 + k] * way) * turns + p[6 + k] + 2.0 * p[22 + k] * abs(rate)
    return -by_across * p[k] - friction, by_across * source[0]


@njit(cache=True, error_model="numpy")
def _of_held(
    rates: tuple[float, float],
    sources: tuple[tuple[float, float], tuple[float, float]],
    open_v: float,
    p: FloatArray,
    out: FloatArray,
) -> None:
    """Slopes of the share of its voltage that the battery holds, into `out`, shape (7,).

    By both back-emf constants, both resistances, the battery's own, and both wheels' rates.
    """
    drawn_a, grows_per_ohm = 0.0, 0.0
    for k in range(2):
        duty = sources[k][1] * sources[k][0] / open_v
        drawn_a += duty * (sources[k][0] - p[k] * rates[k]) / p[2 + k]
        grows_per_ohm += duty * sources[k][0] / open_v / p[2 + k]
    wider, drawn_a = 1.0 + p[19] * grows_per_ohm, max(drawn_a, 0.0)
    by_drawn = -p[19] / (open_v * wider) if drawn_a > 0.0 else 0.0
    by_grows = p[19] * p[19] * drawn_a / (open_v * wider * wider)
    for k in range(2):
        source, ohm = sources[k][0], p[2 + k]
        duty = sources[k][1] * source / open_v
        out[_SHARES, k] = -by_drawn * duty * rates[k] / ohm
        out[_SHARES, 2 + k] = (
            -duty * (by_drawn * (source - p[k] * rates[k]) + by_grows * source / open_v) / (ohm * ohm)
        )
        out[_SHARES, 5 + k] = -by_drawn * duty * p[k] / ohm
    out[_SHARES, 4] = -drawn_a / (open_v * wider * wider)


@njit(cache=True, error_model="numpy")
def _by_parts(
    v: float,
    w: float,
    a: tuple[float, float],
    down: tuple[float, float],
    drag: float,
    p: FloatArray,
    shape: FloatArray,
    room: FloatArray,
) -> None:
    """How each part moves the balance of travel and of turn, into the first rows of `room`.

    The parts: force of the left and the right wheel, gravity along and to the left, drag per speed, mass, place of the
    centre of mass to the left and ahead, scrub, yaw inertia, both rotors as the floor feels them, travel, turning rate.
    """
    half, back, mass, aside, ahead = 0.5 * shape[2], shape[3], p[10] + p[17], p[15], p[16]
    high = caster_share(p, shape)
    swing, across = ahead * w * w - a[0], back * back * w
    held = high * swing - 1.0
    scrubs = p[18] * mass / p[10] * _bend(w / STILL_RAD_PER_S) / STILL_RAD_PER_S
    pulls, turns = high * drag * v, high * drag * across
    _put(room, 0, 1.0, -half)
    _put(room, 1, 1.0, half)
    _put(room, 2, 1.0, -aside)
    _put(room, 3, 0.0, ahead)
    _put(room, 4, v * held, across * held)
    spin = (ahead * ahead + aside * aside) * a[1]
    _put(room, 5, swing + aside * a[1], aside * a[0] - ahead * v * w - spin)
    _put(room, 6, mass * a[1], mass * a[0] - down[0] - 2.0 * mass * aside * a[1])
    loads = swing / ahead if -ahead > LEAST_BACK_M else 0.0  # the centre of mass also loads the caster
    leads = down[1] - mass * v * w - 2.0 * mass * ahead * a[1]
    _put(room, 7, mass * w * w + pulls * (w * w - loads), leads + turns * (w * w - loads))
    _put(room, 8, 0.0, -smooth_sign(w / STILL_RAD_PER_S))
    _put(room, 9, 0.0, -a[1])
    _put(room, 10, half * a[1] - a[0], half * (a[0] - half * a[1]))
    _put(room, 11, -half * a[1] - a[0], -half * (a[0] + half * a[1]))
    _put(room, 12, drag * held, -mass * ahead * w)
    slows = drag * back * back * held - mass * ahead * v - scrubs
    _put(room, 13, 2.0 * ahead * w * (mass + pulls), slows + 2.0 * ahead * w * turns)


@njit(cache=True, error_model="numpy")
def _put(room: FloatArray, part: int, along: float, about: float) -> None:
    room[part, 0], room[part, 1] = along, about


@njit(cache=True, error_model="numpy")
def _answers(
    v: float,
    w: float,
    a: tuple[float, float],
    way: tuple[float, float],
    volts: tuple[float, float],
    floats: tuple[float, float],
    open_v: float,
    p: FloatArray,
    shape: FloatArray,
    room: FloatArray,
    out: FloatArray,
) -> tuple[float, float, float, float]:
    """Slopes of both accelerations by `NAMES` into `out`; those by travel and turning rate returned.

    `a` holds the accelerations themselves.
    """
    half = 0.5 * shape[2]
    rates = ((v - half * w) / shape[0], (v + half * w) / shape[1])
    held = share_left(rates, volts, floats, open_v, p)
    sources = driving(volts[0], open_v, floats[0]), driving(volts[1], open_v, floats[1])
    _of_held(rates, sources, open_v, p, room)
    left = _of_force(rates[0], sources[0], held, floats[0], p, 0, room)
    right = _of_force(rates[1], sources[1], held, floats[1], p, 1, room)
    drag = drag_per_speed(v, w, p, shape)
    _by_parts(v, w, a, gravity(way, p), drag, p, shape, room)
    across2 = shape[3] * shape[3]
    slows = drag / crawl(v, w, shape) ** 2
    for row in range(2):
        pushes = room[0, row] / shape[0], room[1, row] / shape[1]
        share = pushes[0] * left[1] + pushes[1] * right[1]
        by_left = pushes[0] * left[0] + share * room[_SHARES, 5]
        by_right = pushes[1] * right[0] + share * room[_SHARES, 6]
        room[12, row] += by_left / shape[0] + by_right / shape[1] - room[4, row] * slows * v
        room[13, row] += (
            half * (by_right / shape[1] - by_left / shape[0]) - room[4, row] * slows * across2 * w
        )
        if out.shape[1] > STARTS:
            _of_motors(row, pushes, share, shape, room, out)
            _of_body(row, room, p, shape, (v, w), way, out)
    m = inertias(v, w, p, shape)
    whole = m[0] * m[3] - m[1] * m[2]
    for column in range(STARTS, out.shape[1]):
        along, about = out[0, column] / whole, out[1, column] / whole
        out[0, column], out[1, column] = m[3] * along - m[1] * about, m[0] * about - m[2] * along
    return solved(m, room[12, 0], room[12, 1]) + solved(m, room[13, 0], room[13, 1])


@njit(cache=True, error_model="numpy")
def _of_motors(
    row: int,
    pushes: tuple[float, float],
    share: float,
    shape: FloatArray,
    room: FloatArray,
    out: FloatArray,
) -> None:
    """Slopes of one balance by the numbers of motors and battery, into a row of `out`."""
    for k in range(2):
        first = STARTS + k
        out[row, first] = pushes[k] * room[_FORCES + k, 0] + share * room[_SHARES, k]
        out[row, first + 2] = pushes[k] * room[_FORCES + k, 1] + share * room[_SHARES, 2 + k]
        out[row, first + 4], out[row, first + 6] = (
            pushes[k] * room[_FORCES + k, 2],
            pushes[k] * room[_FORCES + k, 3],
        )
        out[row, first + 8] = room[10 + k, row] / (shape[k] * shape[k])
        for more in range(3):
            out[row, first + 20 + 2 * more] = pushes[k] * room[_FORCES + k, 4 + more]
    out[row, STARTS + 19] = share * room[_SHARES, 4]


@njit(cache=True, error_model="numpy")
def _of_body(
    row: int,
    room: FloatArray,
    p: FloatArray,
    shape: FloatArray,
    speeds: tuple[float, float],
    way: tuple[float, float],
    out: FloatArray,
) -> None:
    """Slopes of one balance by the numbers of body and floor, into a row of `out`."""
    mass = p[10] + p[17]
    rises = p[13] * way[0] + p[14] * way[1], p[14] * way[0] - p[13] * way[1]
    load = room[5, row] - GRAVITY * (room[2, row] * rises[0] + room[3, row] * rises[1])
    rolls = room[4, row] / crawl(speeds[0], speeds[1], shape)
    more = (rolls * shape[5] + room[8, row] * p[18] + room[9, row] * p[11] * LOAD_GYRATION) / p[10]
    out[row, STARTS + 10], out[row, STARTS + 17] = load - more * p[17] / p[10], load + more
    out[row, STARTS + 11] = room[9, row] * (1.0 + LOAD_GYRATION * p[17] / p[10])
    out[row, STARTS + 12] = rolls
    out[row, STARTS + 13] = -mass * GRAVITY * (room[2, row] * way[0] - room[3, row] * way[1])
    out[row, STARTS + 14] = -mass * GRAVITY * (room[2, row] * way[1] + room[3, row] * way[0])
    out[row, STARTS + 15], out[row, STARTS + 16] = room[6, row], room[7, row]
    out[row, STARTS + 18] = room[8, row] * mass / p[10]


@njit(cache=True, error_model="numpy")
def _moved(
    by: tuple[float, float, float, float], own: FloatArray, at: FloatArray, count: int, out: FloatArray
) -> None:
    """Slopes of the accelerations where the slopes of the speeds are `at`, into `out`, shape (2, columns)."""
    for column in range(count):
        out[0, column] = by[0] * at[0, column] + by[2] * at[1, column] + own[0, column]
        out[1, column] = by[1] * at[0, column] + by[3] * at[1, column] + own[1, column]


@njit(cache=True, error_model="numpy")
def _heun(
    h: float,
    speeds: tuple[float, float],
    way: tuple[float, float],
    volts: tuple[float, float],
    floats: tuple[float, float],
    open_v: float,
    p: FloatArray,
    shape: FloatArray,
    room: FloatArray,
    tracks: tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray],
    count: int,
) -> tuple[float, float, float, float]:
    """One step as `wheel_angles` takes it: travel and turn made, speeds after it; slopes in `tracks` go along."""
    rate, path, own, first, then, second = tracks
    v, w = speeds
    down = gravity(way, p)
    a = accelerations(v, w, down, volts, floats, open_v, p, shape)
    by = _answers(v, w, a, way, volts, floats, open_v, p, shape, room, own)
    _moved(by, own, rate, count, first)
    for row in range(2):
        for column in range(count):
            path[row, column] += h * (rate[row, column] + 0.5 * h * first[row, column])
            then[row, column] = rate[row, column] + h * first[row, column]
    b = accelerations(v + h * a[0], w + h * a[1], down, volts, floats, open_v, p, shape)
    by = _answers(v + h * a[0], w + h * a[1], b, way, volts, floats, open_v, p, shape, room, own)
    _moved(by, own, then, count, second)
    for row in range(2):
        for column in range(count):
            rate[row, column] += 0.5 * h * (first[row, column] + second[row, column])
    made = h * (v + 0.5 * h * a[0]), h * (w + 0.5 * h * a[1])
    return made[0], made[1], v + 0.5 * h * (a[0] + b[0]), w + 0.5 * h * (a[1] + b[1])


@njit(cache=True, error_model="numpy")
def wheel_slopes(
    p: FloatArray,
    shape: FloatArray,
    time_s: FloatArray,
    volts: FloatArray,
    heading_rad: FloatArray,
    begins: BoolArray,
    start: FloatArray,
    open_v: FloatArray,
    floats: FloatArray,
    count: int,
) -> tuple[FloatArray, FloatArray]:
    """Angles of both wheels along a run, and their slopes.

    All but the last argument are those of `wheel_angles`, which gives the angles too. `count` says how many slopes:
    `STARTS` for those by the starting speeds alone, `COLUMNS` for those by `NAMES` behind them.

    Returns:
        Angles, shape (rows, 2), and slopes, shape (rows, 2, count).
    """
    angles, slopes = np.zeros((time_s.size, 2)), np.zeros((time_s.size, 2, count))
    room = np.zeros(_ROOM)
    rate, path, own = np.zeros((2, count)), np.zeros((2, count)), np.zeros((2, count))
    tracks = (rate, path, own, np.zeros((2, count)), np.zeros((2, count)), np.zeros((2, count)))
    v, w, travel, turn, step_s, half = 0.0, 0.0, 0.0, 0.0, longest_step_s(p), 0.5 * shape[2]
    for row in range(time_s.size):
        if begins[row]:
            v, w, travel, turn = start[row, 0], start[row, 1], 0.0, 0.0
            rate[:], path[:] = 0.0, 0.0
            rate[0, 0] = rate[1, 1] = 1.0
        for k, side in ((0, -half), (1, half)):
            angles[row, k] = (travel + side * turn) / shape[k]
            for column in range(count):
                slopes[row, k, column] = (path[0, column] + side * path[1, column]) / shape[k]
        if row + 1 == time_s.size:
            break
        span = time_s[row + 1] - time_s[row]
        steps = max(1, math.ceil(span / step_s))
        both, open_off = (volts[row, 0], volts[row, 1]), (floats[row, 0], floats[row, 1])
        for step in range(steps):
            heading = heading_rad[row] + (step + 0.5) / steps * (heading_rad[row + 1] - heading_rad[row])
            way = math.cos(heading), math.sin(heading)
            went, turned, v, w = _heun(
                span / steps, (v, w), way, both, open_off, open_v[row], p, shape, room, tracks, count
            )
            travel, turn = travel + went, turn + turned
    return angles, slopes


forget_outdated(wheel_slopes, dynamics)
