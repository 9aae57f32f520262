"""A sensor's parameters from a sweep, by the models of `nxt_twin.sensors`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from scipy.special import logsumexp

from nxt_twin.experiment import identify_touch
from nxt_twin.experiment.combine import combined
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified, Value, normal_value
from nxt_twin.experiment.plan import AngleSweep, DistanceSweep, GradientSweep, TouchCycles
from nxt_twin.experiment.posterior import weighed
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.recording.recording import FloatArray, Recording
from nxt_twin.sensors import light, ultrasonic
from nxt_twin.sensors.fitting import Fitted

_SUFFIXES: Final[Mapping[str, str]] = {
    "_raw_per_mm": "1/mm",
    "_mm": "mm",
    "_deg": "deg",
    "_g": "g",
    "_raw": "raw",
    "per_distance": "",
}
_NEAR_START_MM: Final = 250.0
_FAR_MM: Final = 400.0
"""Where the paper's near offset ends, and where a line is safe from it in any sensor."""
_NEAR_STEP_MM: Final = 8.0
_NEAR_OFFSETS_MM: Final = (-20.0, -10.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0)
_BEAM: Final = ("max_angle_deg", "best_distance_mm", "contact_angle_deg", "far_angle_deg", "beam_edge_deg")
_LINE: Final = ("noise_mm", "noise_per_distance", "zero_mm", "scale")
_NEAR: Final = ("near_offset_mm", "near_share")
_WEIGHED: Final[Mapping[str, str]] = {
    "blind_distance_mm": "blind_edge_mm",
    "near_below_mm": "near_edge_mm",
    "near_share": "",
}
"""Parameters that are not normal round their likeliest value, and the width of those that are borders."""
_REACH: Final = 5.0
_TRIED: Final = 121
_MOST_WIDER: Final = 2.0
_SHARPNESS: Final = np.geomspace(0.05, 2.0, 5)
_AIR_NOTE: Final = (
    "Scale and air temperature act alike: the scale is that of this run's air, 0.17 % a degree near 20 °C."
)


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
    return identified_from(experiment, recordings)


def identified_from(
    experiment: DistanceSweep | AngleSweep | GradientSweep | TouchCycles, recordings: Sequence[Recording]
) -> Identified:
    """The same from recordings in memory, in the order of the sweep's parts."""
    column = sweep_of(experiment).column
    match experiment:
        case DistanceSweep():
            return _distance(experiment, recordings, column)
        case AngleSweep():
            return _angle(experiment, recordings, column)
        case GradientSweep():
            return _gradient(experiment, recordings, column)
        case TouchCycles():
            return identify_touch.identified_from(experiment, recordings)


def _distance(experiment: DistanceSweep, recordings: Sequence[Recording], column: str) -> Identified:
    distance, readings = _joined(recordings, "rig_distance_mm", column)
    start, free = ultrasonic_start(distance, readings)
    truth = ultrasonic.UltrasonicTruth(distance)
    fitted = ultrasonic.fit(readings, truth, start=start, free=free)
    weighed_ones: dict[str, Value] = {
        name: _weighed(name, fitted, readings, truth) for name in _WEIGHED if name in free
    }
    values = tuple(weighed_ones.get(value.name, value) for value in _values(fitted))
    return Identified(experiment.kind, values, (), (_AIR_NOTE,), fitted.parameters.to_config())


def _weighed(
    name: str,
    fitted: Fitted[ultrasonic.UltrasonicParameters],
    readings: FloatArray,
    truth: ultrasonic.UltrasonicTruth,
) -> Value:
    """A border between two distances or a share, every value of which is weighed, and all sharpnesses of a border.

    Anywhere between two places a sharp border is as likely as anywhere else, and a share has an end at 1.
    """
    middle, edge = float(getattr(fitted.parameters, name)), _WEIGHED[name]
    reach = _REACH * fitted.std[name]
    if edge:
        reach = max(reach, 2.0 * float(np.diff(np.unique(truth.distance_mm)).max()))
    highest = np.inf if edge else 1.0
    tried = np.linspace(max(middle - reach, 0.0), min(middle + reach, highest), _TRIED)
    widths = _SHARPNESS * getattr(fitted.parameters, edge) if edge else np.zeros(1)
    chance = np.empty((widths.size, tried.size))
    for row, width in enumerate(widths):
        base = replace(fitted.parameters, **{edge: float(width)}) if edge else fitted.parameters
        for column, value in enumerate(tried):
            changed = replace(base, **{name: float(value)})
            chance[row, column] = ultrasonic.log_likelihood(changed, readings, truth)
    # What the other parameters leave open widens it as much as it would a normal one.
    index = fitted.names.index(name)
    wider = np.sqrt(fitted.covariance[index, index] * np.linalg.inv(fitted.covariance)[index, index])
    stretched = middle + np.clip(wider, 1.0, _MOST_WIDER) * (tried - middle)
    inside = (stretched >= 0.0) & (stretched <= highest)
    return weighed(name, stretched[inside], logsumexp(chance, axis=0)[inside], "mm" if edge else "")


def ultrasonic_start(
    distance_mm: FloatArray, readings: FloatArray
) -> tuple[ultrasonic.UltrasonicParameters, tuple[str, ...]]:
    """Where a fit of a distance sweep begins, and what it can find with these readings."""
    heard = readings < ultrasonic.NO_ECHO
    if np.count_nonzero(heard) < len(_LINE) + 1:
        mend = "check the sensor's port, and that the target is in front of it"
        raise ExperimentError("almost no reading has an echo", where="distance sweep", mend=mend)
    far = heard & (distance_mm > _FAR_MM)
    start = ultrasonic.UltrasonicParameters()
    free = list(_LINE)
    if np.count_nonzero(far) > len(_LINE):
        scale, zero = np.polyfit(distance_mm[far], 10.0 * readings[far], 1)
        left = 10.0 * readings[far] - scale * distance_mm[far] - zero
        start = replace(start, scale=float(scale), zero_mm=float(zero), noise_mm=float(np.std(left)))
        if np.count_nonzero(heard & (distance_mm < _NEAR_START_MM)) > 10:
            start = _near_start(start, distance_mm[heard], readings[heard])
            free += [*_NEAR, "near_below_mm"]
    if distance_mm.min() < 100.0 and not heard[distance_mm == distance_mm.min()].any():
        silent = distance_mm[~heard & (distance_mm < distance_mm[heard].min() + 1e-9)]
        start = replace(start, blind_distance_mm=float(silent.max() + distance_mm[heard].min()) / 2.0)
        free.append("blind_distance_mm")
    return start, tuple(free)


def _near_start(
    start: ultrasonic.UltrasonicParameters, distance_mm: FloatArray, readings: FloatArray
) -> ultrasonic.UltrasonicParameters:
    """With the likeliest of many near offsets: a fit that begins at another border may never get across."""
    near = distance_mm < _FAR_MM
    truth = ultrasonic.UltrasonicTruth(distance_mm[near])
    tried = (
        replace(start, near_offset_mm=float(offset), near_below_mm=float(below), near_share=0.8)
        for below in np.arange(distance_mm.min() + 20.0, _FAR_MM, _NEAR_STEP_MM)
        for offset in _NEAR_OFFSETS_MM
    )
    return max(tried, key=lambda each: ultrasonic.log_likelihood(each, readings[near], truth))


def _angle(experiment: AngleSweep, recordings: Sequence[Recording], column: str) -> Identified:
    """Distances from what was heard, the beam from what was not: the likelihood is the product of the two."""
    distance, readings = _joined(recordings, "rig_distance_mm", column)
    angle, _ = _joined(recordings, "rig_angle_deg", column)
    truth = ultrasonic.UltrasonicTruth(distance, angle)
    heard = readings < ultrasonic.NO_ECHO
    if heard.all() or not heard.any():
        what = "every reading has an echo" if heard.all() else "no reading has an echo"
        raise ExperimentError(what, where="angle sweep", mend="check the angles and the sensor's port")
    start = ultrasonic.UltrasonicParameters()
    free = list(_LINE)
    if (distance < _NEAR_START_MM).any():
        start = replace(start, near_offset_mm=15.0, near_share=0.8)
        free += _NEAR
    line = ultrasonic.fit(np.where(heard, readings, np.nan), truth, start=start, free=free)
    limits = [np.abs(angle[heard & (distance == d)]).max(initial=0.0) for d in np.unique(distance)]
    widest = int(np.argmax(limits))
    begin = replace(
        line.parameters,
        max_angle_deg=float(limits[widest]),
        best_distance_mm=float(np.unique(distance)[widest]),
        contact_angle_deg=float(limits[0]) - 5.0,
        far_angle_deg=float(limits[-1]),
    )
    beam = ultrasonic.fit(readings, truth, start=begin, free=_BEAM)
    notes = (
        "The beam is taken to be the same on both sides; turn the sensor the other way to check.",
        _AIR_NOTE,
    )
    return Identified(
        experiment.kind, (*_values(beam), *_values(line)), (), notes, beam.parameters.to_config()
    )


def _gradient(experiment: GradientSweep, recordings: Sequence[Recording], column: str) -> Identified:
    """One slope for all lights, an offset for each: each light is fitted alone, and then they are put together."""
    fits = []
    for recording in recordings:
        position, readings = _joined([recording], "rig_position_mm", column)
        fits.append(light.fit(readings, light.LightTruth(position)))
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


def _joined(recordings: Sequence[Recording], truth: str, column: str) -> tuple[FloatArray, FloatArray]:
    """The true values and the readings of all recordings, one after the other."""
    return (
        np.concatenate([recording.columns[truth] for recording in recordings]),
        np.concatenate([recording.columns[column] for recording in recordings]),
    )


def _values(fitted: Fitted[Any]) -> tuple[Value, ...]:
    return tuple(
        normal_value(name, float(getattr(fitted.parameters, name)), fitted.std[name], _unit(name))
        for name in fitted.names
    )


def _unit(name: str) -> str:
    return next((unit for suffix, unit in _SUFFIXES.items() if name.endswith(suffix)), "")
