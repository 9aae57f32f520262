"""Figures 11, 16 and 17 of the source paper, as our models of the sensors draw them."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from nxt_twin.paper import printed
from nxt_twin.recording.configs import configs_dir
from nxt_twin.recording.yaml_file import read_yaml
from nxt_twin.sensors import light, ultrasonic
from nxt_twin.sensors.errors import SensorError
from nxt_twin.view import palette
from nxt_twin.view.legends import name_all_curves
from nxt_twin.view.paper_axes import draw, pair

_SEED: Final = 0
_ROOM_LIGHT_RAW: Final = -80.0
"""By how much another room light moves the readings: for the picture."""
_A4_MM: Final = 297.0


def sensors_figure() -> Figure:
    """Figures 11 and 16: readings drawn from the models, along a gradient and against distance."""
    figure, (left, right) = pair()
    draw(left, "reading (raw, 0 to 1023)", "place along the gradient (mm)")
    sensor = light.LightParameters.from_config(_config("nxt_light_reflected"))
    place = np.arange(0.0, _A4_MM, 2.0)
    rng = np.random.default_rng(_SEED)
    for name, offset, colour in (
        ("one room light", 0.0, palette.IMPROVED),
        ("another", _ROOM_LIGHT_RAW, palette.BASELINE),
    ):
        lit = replace(sensor, zero_raw=sensor.zero_raw + offset)
        readings = light.simulate(lit, light.LightTruth(place), rng)
        left.plot(place, readings, ".", color=colour, markersize=3, label=name)
    draw(right, "reading less true distance (mm)", "distance (mm)")
    distance = np.arange(10.0, 1551.0, 1.0)
    readings = ultrasonic.simulate(_sensor(), ultrasonic.UltrasonicTruth(distance), rng)
    heard = readings < ultrasonic.NO_ECHO
    error_mm = 10.0 * readings - distance
    right.plot(distance[heard], error_mm[heard], ".", color=palette.IMPROVED, markersize=1.5, label="echo")
    silent = distance[~heard]
    right.plot(
        silent, np.zeros(silent.size), "|",
        color=palette.BASELINE, markersize=6, label="no echo (255)",
    )  # fmt: skip
    name_all_curves(figure)
    return figure


def beam_figure() -> Figure:
    """Figure 17: how far the sensor may be turned away, and the share of echoes at each distance and angle."""
    figure, (left, right) = pair()
    sensor = _sensor()
    draw(left, "widest angle with an echo (deg)", "distance (mm)")
    distance = np.array(printed.BEAM_DISTANCES_MM, dtype=np.float64)
    left.plot(distance, ultrasonic.beam_limit_deg(sensor, distance), "o-", color=palette.IMPROVED,
              markersize=3.5, linewidth=1.1, label="the model's")  # fmt: skip
    best_mm, best_deg = printed.BEAM_BEST
    left.plot(
        [best_mm], [best_deg], "o", color=palette.BASELINE, markersize=6, label="the text's 55° at 438 mm"
    )
    left.set_ylim(0.0, 65.0)
    draw(right, "valid echoes of 64 (%)", "angle (deg)")
    angle = np.arange(0.0, 71.0, 5.0)
    rng = np.random.default_rng(_SEED)
    colours = (palette.STALE, palette.IMPROVED, palette.BASELINE)
    for place_mm, colour in zip((138.0, best_mm, 1538.0), colours, strict=True):
        truth = ultrasonic.UltrasonicTruth(np.full(64 * angle.size, place_mm), np.repeat(angle, 64))
        heard = ultrasonic.simulate(sensor, truth, rng) < ultrasonic.NO_ECHO
        share = 100.0 * heard.reshape(angle.size, 64).mean(axis=1)
        right.plot(
            angle, share, "o-", color=colour, markersize=3.5, linewidth=1.1, label=f"{place_mm:.0f} mm"
        )
    name_all_curves(figure)
    return figure


def _sensor() -> ultrasonic.UltrasonicParameters:
    return ultrasonic.UltrasonicParameters.from_config(_config("nxt_ultrasonic"))


def _config(name: str) -> dict[str, object]:
    return read_yaml(configs_dir() / "sensors" / f"{name}.yaml", SensorError)
