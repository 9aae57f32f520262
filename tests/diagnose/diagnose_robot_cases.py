"""Robots that drive squares, with a pose from outside, by circular arcs alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nxt_twin.blind.robot import world
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

PLANT = {
    "kind": "differential_drive",
    "left": "b",
    "right": "c",
    "left_wheel_radius_m": 0.028,
    "right_wheel_radius_m": 0.028,
    "track_m": 0.12,
}
PERIOD_S = 0.05


def square_run(name, seed, *, way=1, radius_m=0.028, ratio=1.0, track_m=0.12, heading_deg=0.0, lag_s=0.0,
               slip=None, drift=0.0, off_centre=0.0, scale=1.0):  # fmt: skip
    """A square of 0.6 m with turns on the spot.

    `slip` is (start_s, end_s, ratio) of the left wheel, `off_centre` the share by which its radius changes over a turn,
    `scale` that of the camera.
    """
    rng = np.random.default_rng(seed)
    steps = []
    for _ in range(4):
        steps += [(0.2, 0.0)] * 60 + [(0.0, 0.0)] * 6 + [(0.0, way * np.pi / 4)] * 40 + [(0.0, 0.0)] * 6
    speed, rate = np.array(steps).T
    smooth = np.ones(6) / 6
    speed, rate = (np.convolve(one, smooth, "same") for one in (speed, rate))
    left_radius = 2.0 * radius_m / (1.0 + ratio)
    left_rate = (speed - 0.5 * 0.12 * rate) / 0.028
    right_rate = (speed + 0.5 * 0.12 * rate) / 0.028
    time_s = PERIOD_S * np.arange(speed.size + 1)
    kept = np.ones(speed.size)
    if slip:
        kept[(time_s[:-1] >= slip[0]) & (time_s[:-1] < slip[1])] = 1.0 - slip[2]
    left_m, right_m = left_radius * kept * left_rate * PERIOD_S, left_radius * ratio * right_rate * PERIOD_S
    left_m = left_m * (1.0 + off_centre * np.cos(np.cumsum(left_rate * PERIOD_S)))
    travel, turn = 0.5 * (left_m + right_m), (right_m - left_m) / track_m
    heading = np.concatenate([[0.0], np.cumsum(turn)])
    middle = heading[:-1] + 0.5 * turn
    step = travel * np.exp(1j * middle) + drift * np.abs(travel) * np.exp(0.7j)
    place = scale * np.concatenate([[0.0], np.cumsum(step)])
    then = time_s - lag_s
    place = np.interp(then, time_s, place.real) + 1j * np.interp(then, time_s, place.imag)
    heading = np.interp(then, time_s, heading)
    wheels = [
        np.degrees(np.concatenate([[0.0], np.cumsum(one * PERIOD_S)])) for one in (left_rate, right_rate)
    ]
    columns = {
        "time_s": time_s,
        "b_tacho_deg": np.floor(wheels[0]),
        "c_tacho_deg": np.floor(wheels[1]),
        "pose_x_m": place.real + 5e-4 * rng.standard_normal(time_s.size),
        "pose_y_m": place.imag + 5e-4 * rng.standard_normal(time_s.size),
        "pose_heading_deg": np.degrees(heading) + heading_deg + 0.2 * rng.standard_normal(time_s.size),
    }
    return Recording(name, columns)


def robot_case(runs=5, plant=PLANT, lags=(0.0,), slips=(), hold_out=0, **truth):
    """Squares both ways round; `lags` in turn, `slips` by number of the run."""
    slipping = dict(slips)
    recordings = tuple(
        square_run(
            f"r{n + 1}.csv",
            n,
            way=1 if n % 2 else -1,
            lag_s=lags[n % len(lags)],
            slip=slipping.get(n),
            **truth,
        )
        for n in range(runs)
    )
    return Case("robot", Path(), plant, recordings[: runs - hold_out], recordings[runs - hold_out :], None)


def robot_of_seed(seed):
    """A true robot without effects."""
    return world.drawn_robot(np.random.default_rng(seed))


def powered_case(name, robot, seed):
    """Three recordings of a true robot with powers."""
    rng = np.random.default_rng(seed)
    runs = tuple(world.recorded_run(f"{name}{n}.csv", robot, {}, 0.0, rng, powered=True) for n in range(3))
    return Case(name, Path(), world.nominal_robot(powered=True), runs, (), None)
