"""Plants and signals that several tests of the physics use."""

import numpy as np

from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, free_job
from nxt_twin.physics.start import at_rest

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


def rotary_plant():
    """A disc with friction on a known torque."""
    return plant_from_config(
        {"kind": "rigid_body", "inertia": 2e-3, "viscous_friction": 5e-3, "coulomb_friction": 0.02}, "torque_nm"
    )


def signals(*, seconds, kind="power_pct", size=1.0, regular=False, seed=3):
    """Steps of random level, polled about every 10 ms, no readings."""
    rng = np.random.default_rng(seed)
    steps = np.full(int(seconds * 100), 0.01) if regular else rng.uniform(0.006, 0.014, int(seconds * 100))
    time_s = np.concatenate([[0.0], np.cumsum(steps)])
    at = time_s[:: 37 if regular else 41]
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
    read = Signals(**{**run.__dict__, "measured": readings, "quantum": np.radians(1.0)})
    noise = Noise(5e-3, 5.0, 0.15, 26.0)
    return Job(read, observer(read, noise), at_rest(read), noise.disturbance_time_s)
