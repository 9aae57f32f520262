"""Sensor cases for the tests: made by mechanisms, thinned so that a diagnosis is quick."""

from functools import cache
from pathlib import Path

import numpy as np

from nxt_twin.blind.sensors.cases import make_sensor_case
from nxt_twin.diagnose.sensor.engine import diagnose_sensor
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording


def thinned(recording, every):
    return Recording(recording.name, {name: values[::every] for name, values in recording.columns.items()})


def sensor_case(kind, effects=(), seed=7, size="medium", every=1, hold_out=0):
    made = make_sensor_case(kind, effects, seed, size)
    recordings = tuple(thinned(recording, every) for recording in made.recordings)
    fitted = recordings[: len(recordings) - hold_out]
    case = Case("case", Path(), dict(made.content["plant"]), fitted, recordings[len(fitted) :], None)
    return case, made.effects


@cache
def sensor_diagnosis(kind, effects=(), seed=7, size="medium", every=1, hold_out=0):
    """The answer, and the true parameters by effect."""
    case, truth = sensor_case(kind, effects, seed, size, every, hold_out)
    return diagnose_sensor(case), truth


def own_case(kind, columns, plant=None, name="own"):
    arrays = {key: np.asarray(values, dtype=np.float64) for key, values in columns.items()}
    return Case(name, Path(), plant or {"kind": kind}, (Recording("r.csv", arrays),), (), None)
