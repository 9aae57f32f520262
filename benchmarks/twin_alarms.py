"""How often the live monitor calls a divergence where none is: recordings of motors that lack nothing."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nxt_twin.blind.make import make_case
from nxt_twin.blind.polling import Link
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import DRIVE_MODES, Recording
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.monitor import MotorMonitor

FIRST_SEED = 9100
RECORDINGS = 30
DURATION_S = 60.0
TORQUE_NOISE_NM = 2e-3


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    for link in ("usb", "bluetooth"):
        alarms, highest, seconds = 0, 0.0, 0.0
        for seed in range(FIRST_SEED, FIRST_SEED + RECORDINGS):
            called, nats = watched(seed, link)
            alarms, highest, seconds = alarms + called, max(highest, nats), seconds + DURATION_S
        yield (
            f"{link}: {alarms} alarms in {seconds / 3600.0:.2f} h of motors that lack nothing; "
            f"the evidence never rose beyond {highest:.1f} nats"
        )


def watched(seed: int, link: Link) -> tuple[int, float]:
    """Alarms on one recording of a motor with its true parameters, and the most evidence that came together, nats."""
    case = make_case(
        seed,
        effects=(),
        duration_s=DURATION_S,
        recordings=1,
        torque_noise_nm=TORQUE_NOISE_NM,
        link=link,
    )
    base = case.answer["base"]
    keys = load_plant_config("nxt_motor").keys() & base.keys()
    plant = plant_from_config({**{key: base[key] for key in keys}, "kind": "dc_motor"}, "power_pct")
    recording = case.recordings[0]
    options = TwinOptions(candidates=(), bridge=plain_bridge, cells_ohm=0.0)
    twin = BrickTwin({"a": plant}, options, now_s=float(recording.time_s[0]))
    return _alarms(twin, recording)


def _alarms(twin: BrickTwin, recording: Recording) -> tuple[int, float]:
    columns = recording.columns
    monitor = MotorMonitor("a", twin.options.watch)
    modes = columns.get("a_mode", np.zeros(recording.rows))
    alarms, nats, highest = 0, 0.0, 0.0
    for row, time_s in enumerate(recording.time_s.tolist()):
        if np.isfinite(columns["battery_v"][row]):
            twin.read_battery(float(columns["battery_v"][row]))
        evidence = twin.read_tacho("a", time_s, int(columns["a_tacho_deg"][row]))
        nats = max(0.0, nats + evidence.nats)
        highest = max(highest, nats)
        power = int(columns["a_power_pct"][row])
        alarms += sum(event.kind == "divergence" for event in monitor.take(time_s, evidence, power, {}))
        twin.command("a", power, DRIVE_MODES[int(modes[row])], time_s)
    return alarms, highest
