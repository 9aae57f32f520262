"""Fit a sensor as it stands, looking for nothing else; without a ruler, tell its step, its pace and its noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from nxt_twin.diagnose.sensor.engine import problem_of, sensor_kind
from nxt_twin.diagnose.sensor.problem import standard_errors
from nxt_twin.diagnose.sensor.runs import channel_of, has_truth, unit_of
from nxt_twin.diagnose.sensor.structure import SensorFitter
from nxt_twin.recording.case import Case
from nxt_twin.sensors.sampling import sampling_of
from nxt_twin.sensors.ultrasonic import NO_ECHO, UltrasonicParameters


@final
@dataclass(frozen=True)
class FittedValue:
    """One fitted number with its doubt."""

    name: str
    value: float
    std: float
    unit: str


@final
@dataclass(frozen=True)
class SensorFit:
    """The numbers, and the sensor's keys where they make a model."""

    values: tuple[FittedValue, ...]
    config: Mapping[str, Any] | None


def fit_sensor(case: Case) -> SensorFit:
    """Fit the ideal sensor to a case's readings; without the rig's truth, only step, pace and noise.

    Raises:
        DiagnosisError, SensorError: too few readings, or none.
    """
    if not has_truth(case, sensor_kind(case)):
        return _without_truth(case)
    problem, _ = problem_of(case)
    fitter = SensorFitter(problem, 0)
    fitted = fitter.on_everything(fitter.baseline())
    stds = standard_errors(fitted.names, fitter.covariance(fitted))
    values = [FittedValue(name, fitted.values[name], stds[name], unit_of(name)) for name in fitted.names]
    return SensorFit(tuple(values), problem.to_config(fitted.values, frozenset()))


def _without_truth(case: Case) -> SensorFit:
    """Step, pace and noise of the longest recording."""
    kind = sensor_kind(case)
    channel = channel_of(case, kind)
    run = max(case.recordings, key=lambda recording: recording.rows)
    ultrasonic = kind == "ultrasonic_sensor"
    found = sampling_of(run.time_s, run.columns[channel], NO_ECHO if ultrasonic else None)
    unit = "cm" if ultrasonic else "raw"
    values = (
        FittedValue("quantum", found.quantum, 0.0, unit),
        FittedValue("period_s", found.period_s, found.period_std_s, "s"),
        FittedValue("jitter_s", found.jitter_s, found.jitter_s / float(np.sqrt(2.0 * run.rows)), "s"),
        FittedValue("noise", found.noise, found.noise_std, unit),
        FittedValue("held_share", found.held_share, 0.0, ""),
    )
    if not ultrasonic:
        return SensorFit(values, None)
    sensor = UltrasonicParameters(
        quantum_mm=10.0 * found.quantum,
        noise_mm=max(10.0 * found.noise, 0.5),
        update_period_s=found.period_s,
    )
    return SensorFit(values, sensor.to_config())
