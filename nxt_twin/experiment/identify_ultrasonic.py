"""An ultrasonic sensor's parameters from a sweep of distances, and of angles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.experiment.borders import blind_border, near_offset
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.identified import Identified, Value, normal_value
from nxt_twin.experiment.posterior import weighed
from nxt_twin.sensors import ultrasonic
from nxt_twin.sensors.beam import Beam
from nxt_twin.sensors.fitting import FittedSensor
from nxt_twin.sensors.walk import walked

_UNITS: Final[Mapping[str, str]] = {
    "noise_mm": "mm",
    "noise_per_distance": "",
    "zero_mm": "mm",
    "scale": "",
    "near_offset_mm": "mm",
    "near_share": "",
}
_LINE: Final[tuple[str, ...]] = ("noise_mm", "noise_per_distance", "zero_mm", "scale")
_NEAR: Final[tuple[str, ...]] = ("near_offset_mm", "near_share")
_NEAR_MM: Final = 250.0
_FAR_MM: Final = 400.0
"""Where the paper's near offset ends, and where a line is safe from it in any sensor."""
_BLIND_MM: Final = 100.0
_FEWEST_NEAR: Final = 3
_WORTH_NATS: Final = 6.0
"""Places nearer than the paper's border, and what readings have to gain, for a near offset to be looked for."""
_BEAM: Final = {
    "max_angle_deg": (0.0, 120.0, "deg"),
    "best_distance_mm": (30.0, 2400.0, "mm"),
    "contact_angle_deg": (-60.0, 120.0, "deg"),
    "far_angle_deg": (-90.0, 120.0, "deg"),
    "beam_edge_deg": (0.05, 15.0, "deg"),
}
"""The beam's parameters, between which values they are weighed, and their units."""
_BEAM_SPREAD: Final = np.array([1.0, 20.0, 2.0, 1.0, 0.2])
_AIR_NOTE: Final = (
    "Scale and air temperature act alike: the scale is that of this run's air, 0.17 % a degree near 20 °C."
)
_SIDE_NOTE: Final = "The beam is taken to be the same on both sides; turn the sensor the other way to check."


def from_distances(kind: str, distance_mm: FloatArray, readings: FloatArray) -> Identified:
    """Line, noise, blind zone and near offset.

    Args:
        kind: of the experiment.
        distance_mm: of the target, shape (readings,).
        readings: cm, 255 without echo, shape (readings,).

    Raises:
        ExperimentError: hardly any echo.
        SensorError: too few readings.
    """
    heard = readings < ultrasonic.NO_ECHO
    start, free, silent = _start(distance_mm, readings)
    line = ultrasonic.fit(readings, ultrasonic.UltrasonicTruth(distance_mm), start=start, free=free)
    found = {value.name: value for value in _values(line)}
    if "near_share" in free:
        offset = near_offset(line.parameters, distance_mm[heard], readings[heard], _FAR_MM)
        found |= {value.name: value for value in offset.values()}
    if silent:
        blind = blind_border(line.parameters, distance_mm, readings)
        found[blind.name] = blind
    parameters = replace(line.parameters, **{name: value.value for name, value in found.items()})
    return Identified(kind, tuple(found.values()), (), (_AIR_NOTE,), parameters.to_config())


def _start(
    distance_mm: FloatArray, readings: FloatArray
) -> tuple[ultrasonic.UltrasonicParameters, tuple[str, ...], bool]:
    """Where the fit begins, what it can find with these readings, and whether there is a blind zone."""
    heard = readings < ultrasonic.NO_ECHO
    if np.count_nonzero(heard) < len(_LINE) + 1:
        mend = "check the sensor's port, and that the target is in front of it"
        raise ExperimentError("almost no reading has an echo", where="distance sweep", mend=mend)
    start, free = ultrasonic.UltrasonicParameters(), _LINE
    far = heard & (distance_mm > _FAR_MM)
    if np.count_nonzero(far) > len(_LINE):
        scale, zero = np.polyfit(distance_mm[far], 10.0 * readings[far], 1)
        left = 10.0 * readings[far] - scale * distance_mm[far] - zero
        start = replace(start, scale=float(scale), zero_mm=float(zero), noise_mm=float(np.std(left)))
        if np.unique(distance_mm[heard & (distance_mm < _NEAR_MM)]).size > _FEWEST_NEAR:
            near = near_offset(start, distance_mm[heard], readings[heard], _FAR_MM)
            if near.gained.max() > _WORTH_NATS:
                start, free = near.likeliest(start), (*_LINE, *_NEAR)
    nearest_heard = distance_mm[heard].min()
    silent = distance_mm[~heard & (distance_mm < nearest_heard)]
    blind = bool(silent.size) and distance_mm.min() < _BLIND_MM
    if blind:
        start = replace(start, blind_distance_mm=float(silent.max() + nearest_heard) / 2.0)
    return start, free, blind


def from_angles(
    kind: str, distance_mm: FloatArray, angle_deg: FloatArray, readings: FloatArray
) -> Identified:
    """Distances from what was heard, the beam from what was not: the likelihood is the product of the two.

    Args:
        kind: of the experiment.
        distance_mm: of the target, shape (readings,).
        angle_deg: of incidence, shape (readings,).
        readings: cm, 255 without echo, shape (readings,).

    Raises:
        ExperimentError: every reading has an echo, or none.
        SensorError: too few readings.
    """
    heard = readings < ultrasonic.NO_ECHO
    if heard.all() or not heard.any():
        what = "every reading has an echo" if heard.all() else "no reading has an echo"
        raise ExperimentError(what, where="angle sweep", mend="check the angles and the sensor's port")
    start, free = ultrasonic.UltrasonicParameters(), _LINE
    if (distance_mm < _NEAR_MM).any():
        start, free = replace(start, near_offset_mm=15.0, near_share=0.8), (*_LINE, *_NEAR)
    truth = ultrasonic.UltrasonicTruth(distance_mm, angle_deg)
    line = ultrasonic.fit(np.where(heard, readings, np.nan), truth, start=start, free=free)
    beam = _beam(_Echoes.counted(distance_mm, np.abs(angle_deg), heard), line.parameters.far_mm)
    parameters = replace(line.parameters, **{value.name: value.value for value in beam})
    values = (*beam, *_values(line))
    return Identified(kind, values, (), (_SIDE_NOTE, _AIR_NOTE), parameters.to_config())


@final
@dataclass(frozen=True)
class _Echoes:
    """How many readings had an echo at each place, shape (places,) each."""

    distance_mm: FloatArray
    angle_deg: FloatArray
    heard: FloatArray
    lost: FloatArray

    @classmethod
    def counted(cls, distance_mm: FloatArray, angle_deg: FloatArray, heard: BoolArray) -> _Echoes:
        places, which = np.unique(np.column_stack([distance_mm, angle_deg]), axis=0, return_inverse=True)
        counts = [np.bincount(which, weights=each.astype(np.float64)) for each in (heard, ~heard)]
        echoes, silences = (np.asarray(count, dtype=np.float64) for count in counts)
        return cls(places[:, 0], places[:, 1], echoes, silences)

    def widest(self) -> tuple[FloatArray, FloatArray]:
        """Each distance, and the largest angle at which there was an echo."""
        distances = np.unique(self.distance_mm)
        angles = [
            self.angle_deg[(self.distance_mm == d) & (self.heard > 0)].max(initial=0.0) for d in distances
        ]
        return distances, np.array(angles)


def _beam(echoes: _Echoes, far_mm: float) -> tuple[Value, ...]:
    """The beam's parameters, from a walk: angles tried in steps make their likelihood one of corners and ridges."""

    def log_likelihood(values: FloatArray) -> FloatArray:
        widest, best, contact, far, edge = values.T[:, :, None]
        limit = Beam(widest, best, contact, far, far_mm).limit_deg(echoes.distance_mm)
        beyond = (echoes.angle_deg - limit) / edge
        heard_nats = -np.logaddexp(0.0, beyond)
        lost_nats = heard_nats + beyond
        return np.asarray(heard_nats @ echoes.heard + lost_nats @ echoes.lost, dtype=np.float64)

    distances, limits = echoes.widest()
    best = int(np.argmax(limits))
    start = np.array([limits[best], distances[best], limits[0] - 5.0, limits[-1], 2.0])
    low, high = (np.array([bounds[end] for bounds in _BEAM.values()]) for end in (0, 1))
    draws = walked(log_likelihood, start, _BEAM_SPREAD, (low, high), np.random.default_rng(0))
    return tuple(
        weighed(name, column, np.zeros(column.size), unit)
        for (name, (_, _, unit)), column in zip(_BEAM.items(), draws.T, strict=True)
    )


def _values(fitted: FittedSensor[Any]) -> tuple[Value, ...]:
    return tuple(
        normal_value(name, float(getattr(fitted.parameters, name)), fitted.std[name], _UNITS[name])
        for name in fitted.names
    )
