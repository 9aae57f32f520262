"""A twin fed with recordings of concealed motors, whose truth comes from a simulator that shares nothing with it."""

from typing import NamedTuple

import numpy as np

from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.monitor import MotorMonitor


class Fed(NamedTuple):
    events: list
    nats: np.ndarray
    twin: BrickTwin
    monitor: MotorMonitor

    def first(self, kind):
        return next((event for event in self.events if event.kind == kind), None)


def nxt_motor():
    return plant_from_config(load_plant_config("nxt_motor"), "power_pct")


def true_plant(case):
    """The motor of a case as it is, without what is concealed in it."""
    keys = load_plant_config("nxt_motor").keys() & case.answer["base"].keys()
    numbers = {key: case.answer["base"][key] for key in keys}
    return plant_from_config({**numbers, "kind": "dc_motor"}, "power_pct")


def feed(recording, plant, candidates=()):
    """Hand a recording to a twin and its monitor, poll by poll."""
    columns = recording.columns
    times = columns["time_s"].tolist()
    options = TwinOptions(candidates=candidates, bridge=plain_bridge, cells_ohm=0.0)
    twin = BrickTwin({"a": plant}, options, now_s=times[0])
    monitor = MotorMonitor("a", options.watch)
    modes = columns.get("a_mode", np.zeros(len(times)))
    events, nats = [], []
    for i, time_s in enumerate(times):
        if np.isfinite(columns["battery_v"][i]):
            twin.read_battery(float(columns["battery_v"][i]))
        evidence = twin.read_tacho("a", time_s, int(columns["a_tacho_deg"][i]))
        nats.append(evidence.nats)
        power = int(columns["a_power_pct"][i])
        for event in monitor.take(time_s, evidence, power, twin.motor("a").probabilities):
            events.append(event)
            if event.kind == "divergence":
                twin.forget_evidence("a")
        twin.command("a", power, DRIVE_MODES[int(modes[i])], time_s)
    return Fed(events, np.array(nats), twin, monitor)
