"""Plants and signals that several tests of the physics use."""

from dataclasses import replace

import numpy as np

from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, free_job
from nxt_twin.physics.start import Start, at_rest

NXT = {
    "kind": "dc_motor",
    "resistance_ohm": 7.6,
    "inductance_h": 4.88e-3,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "supply_v": 8.0,
}


def nxt(*, without=(), **changes):
    """The plain motor with some keys changed or added (`effects` among them) and some left out."""
    kept = {key: value for key, value in {**NXT, **changes}.items() if key not in without}
    return plant_from_config(kept, "power_pct")


def disc(**keys):
    """A disc on a known torque, without friction unless given."""
    return plant_from_config({"kind": "rigid_body", "inertia": 2e-3, **keys}, "torque_nm")


def rotary_plant():
    """A disc with friction on a known torque."""
    return disc(viscous_friction=5e-3, coulomb_friction=0.02)


def commanded(steps, *, seconds, kind="power_pct", mode=0, every_s=0.01, stamps=None):
    """Commands as (time, level) and stamps at which to look, every 10 ms unless given; no readings."""
    time_s = np.arange(round(seconds / every_s) + 1) * every_s if stamps is None else stamps
    at, levels = (np.array(column, dtype=float) for column in zip(*steps, strict=True))
    return Signals(
        name="commanded",
        channel="output",
        input_kind=kind,
        command_time_s=at,
        command=levels,
        command_mode=np.full(at.size, mode, dtype=np.int64),
        command_supply_v=np.full(at.size, NXT["supply_v"]),
        time_s=time_s,
        measured=np.where(np.arange(time_s.size) == 0, 0.0, np.nan),
        is_speed=False,
        quantum=0.0,
    )


def moving(run, *, angle=0.0, speed=0.0):
    """A start of `run` at this angle and speed."""
    return Start(
        np.arange(run.time_s.size) == 0, np.full(run.time_s.size, angle), np.full(run.time_s.size, speed)
    )


def motion(simulator, plant, run, **start):
    """What a free run does: arrays of `angle`, `speed`, `current` and more at the stamps."""
    return simulator.trace(plant, free_job(run, moving(run, **start)))


def signals(*, seconds, kind="power_pct", size=1.0, regular=False, seed=3):
    """Steps of random level, polled about every 10 ms, no readings."""
    rng = np.random.default_rng(seed)
    steps = np.full(int(seconds * 100), 0.01) if regular else rng.uniform(0.006, 0.014, int(seconds * 100))
    time_s = np.concatenate([[0.0], np.cumsum(steps)])
    at = time_s[:: 37 if regular else 41].copy()  # contiguous: a stride would be one more kernel to compile
    return Signals(
        name="steps",
        channel="output",
        input_kind=kind,
        command_time_s=at,
        command=size * rng.uniform(-1.0, 1.0, at.size),
        command_mode=np.zeros(at.size, dtype=np.int64),
        command_supply_v=np.full(at.size, NXT["supply_v"]),
        time_s=time_s,
        measured=np.where(np.arange(time_s.size) == 0, 0.0, np.nan),
        is_speed=False,
        quantum=0.0,
    )


def job_with_readings(simulator, *, seconds):
    """A run with whole-degree readings of the plain motor, and the gains that suit them."""
    run = signals(seconds=seconds)
    angle = simulator.trace(plant_from_config(NXT, "power_pct"), free_job(run, at_rest(run)))["predicted"]
    readings = np.radians(np.floor(np.degrees(angle)))
    readings[::7] = np.nan
    readings[0] = 0.0
    read = replace(run, measured=readings, quantum=np.radians(1.0))
    noise = Noise(5e-3, 5.0, 0.15, 26.0)
    return Job(read, observer(read, noise), at_rest(read), noise.disturbance_time_s)
