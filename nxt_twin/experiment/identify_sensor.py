"""A sensor's parameters from a sweep, by the models of `nxt_twin.sensors`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment import identify_touch, identify_ultrasonic
from nxt_twin.experiment.combine import combined
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified, normal_value
from nxt_twin.experiment.plan import AngleSweep, DistanceSweep, GradientSweep, TouchCycles
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.recording.recording import Recording
from nxt_twin.sensors import light


def identify_sensor(
    experiment: DistanceSweep | AngleSweep | GradientSweep | TouchCycles, folder: RunFolder
) -> Identified:
    """Fit the sensor's model to the run's recordings.

    Raises:
        ExperimentError: the recordings do not hold what the fit needs.
        SensorError: likewise.
    """
    sweep = sweep_of(experiment)
    recordings = [folder.read(part.name) for part in sweep.parts]
    files = tuple(f"recordings/{recording.name}" for recording in recordings)
    return replace(identified_from(experiment, recordings), recordings=files)


def identified_from(
    experiment: DistanceSweep | AngleSweep | GradientSweep | TouchCycles, recordings: Sequence[Recording]
) -> Identified:
    """The same from recordings in memory, in the order of the sweep's parts."""
    column = sweep_of(experiment).column
    match experiment:
        case DistanceSweep():
            distance = _joined(recordings, "rig_distance_mm")
            return identify_ultrasonic.from_distances(experiment.kind, distance, _joined(recordings, column))
        case AngleSweep():
            distance, angle = (_joined(recordings, f"rig_{axis}") for axis in ("distance_mm", "angle_deg"))
            return identify_ultrasonic.from_angles(
                experiment.kind, distance, angle, _joined(recordings, column)
            )
        case GradientSweep():
            return _gradient(experiment, recordings, column)
        case TouchCycles():
            return identify_touch.identified_from(experiment, recordings)


def _gradient(experiment: GradientSweep, recordings: Sequence[Recording], column: str) -> Identified:
    """One slope for all lights, an offset for each: each light is fitted alone, and then they are put together."""
    fits = []
    for recording in recordings:
        position = recording.columns["rig_position_mm"]
        fits.append(light.fit(recording.columns[column], light.LightTruth(position)))
    count = len(fits)
    measured = np.concatenate([[getattr(fit.parameters, name) for name in fit.names] for fit in fits])
    covariance = np.zeros((3 * count, 3 * count))
    for n, fit in enumerate(fits):
        covariance[3 * n : 3 * n + 3, 3 * n : 3 * n + 3] = fit.covariance

    def model(x: FloatArray) -> FloatArray:
        return np.concatenate([[x[0], x[1 + n], x[1 + count]] for n in range(count)])

    begin = np.array([measured[0], *measured[1::3], measured[2]])
    x, spread, left = combined(measured, covariance, model, begin)
    stds = np.sqrt(np.diag(spread))
    values = [normal_value("slope_raw_per_mm", float(x[0]), float(stds[0]), "1/mm")]
    for n, name in enumerate(experiment.lightings):
        values.append(normal_value(f"zero_raw[{name}]", float(x[1 + n]), float(stds[1 + n]), "raw"))
    values.append(normal_value("noise_raw", float(x[-1]), float(stds[-1]), "raw"))
    first = f"sensor.yaml holds the zero of the light '{experiment.lightings[0]}'."
    notes = (_lights_note(left, count), first) if count > 1 else ()
    config = _light_config(experiment, x)
    return Identified(experiment.kind, tuple(values), (), notes, config)


def _light_config(experiment: GradientSweep, x: FloatArray) -> dict[str, Any]:
    slope, zero, noise = float(x[0]), float(x[1]), float(x[-1])
    parameters = (
        light.LightParameters(slope, zero, noise)
        if experiment.lamp
        else light.LightParameters(0.0, zero, noise, unlit_slope_raw_per_mm=slope, lamp=0.0)
    )
    return parameters.to_config()


def _lights_note(left: float, count: int) -> str:
    """The paper's finding, tested: the slope stays, only the offset goes with the room's light."""
    degrees = 2 * (count - 1)
    # Wilson and Hilferty: the cube root of chi square over its degrees of freedom is nearly normal.
    odd = ((left / degrees) ** (1.0 / 3.0) - 1.0 + 2.0 / (9.0 * degrees)) / np.sqrt(2.0 / (9.0 * degrees))
    verdict = "agree on" if odd < 2.33 else "do NOT agree on"
    return (
        f"The {count} room lights {verdict} one slope and one noise (chi square {left:.1f} with {degrees})."
    )


def _joined(recordings: Sequence[Recording], column: str) -> FloatArray:
    """A column of all recordings, one after the other."""
    return np.concatenate([recording.columns[column] for recording in recordings])
