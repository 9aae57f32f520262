"""Small fleets on disk."""

from pathlib import Path

import numpy as np

from nxt_twin.api.files import load_plant
from nxt_twin.api.prediction import simulate
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording

POISON = "time_s,a_power_pct,a_tacho_deg\n0.0,50,0\n0.1,50,nonsense\n"


def write_motor(path: Path, *, load_nm: float = 0.0, seed: int = 1) -> None:
    """A recording of four seconds; with a load, which the baseline lacks."""
    random = np.random.default_rng(seed)
    time_s = np.arange(0.0, 4.0, 0.02)
    power = np.repeat(random.integers(-80, 80, 20), 20)[: time_s.size]
    motor = load_plant("nxt_motor")
    truth = motor.adding("constant_load", load_torque_nm=load_nm) if load_nm else motor
    run = simulate(truth, Recording(path.name, {"time_s": time_s, "a_power_pct": power}))
    path.parent.mkdir(parents=True, exist_ok=True)
    counts = np.floor(run.columns["a_tacho_deg"])
    write_recording(Recording(path.name, {**run.columns, "a_tacho_deg": counts}), path)


def write_poison(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(POISON, encoding="utf-8")
