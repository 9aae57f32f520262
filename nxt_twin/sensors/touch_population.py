"""Touch sensors differ from one to the next: the eight of the paper, and new ones drawn from the same population.

Source: Gonçalves et al., tables III to VI, eight switchings of each of eight sensors. Their own means are used, since
two printed ones do not agree with their rows. The population is a normal distribution of four numbers: √ of the
force's hysteresis, release force, √ of the travel's hysteresis, release travel. So no sensor opens above its closing
point. The scatter of a sensor's own switchings is the quadratic mean of the eight.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.touch import TouchParameters
from nxt_twin.sensors.touch_tables import (
    PRESS_FORCE_G,
    PRESS_TRAVEL_MM,
    RELEASE_FORCE_G,
    RELEASE_TRAVEL_MM,
)

_TABLES = (PRESS_FORCE_G, RELEASE_FORCE_G, PRESS_TRAVEL_MM, RELEASE_TRAVEL_MM)
_RESOLUTION_G = 1.0


@final
@dataclass(frozen=True)
class TouchPopulation:
    """Touch sensors as they leave the factory.

    Attributes:
        mean: of √(force hysteresis, g), release force (g), √(travel hysteresis, mm), release travel (mm).
        covariance: of these four numbers, shape (4, 4).
        force_noise_g, travel_noise_mm: scatter of one sensor's own switchings.
    """

    mean: FloatArray
    covariance: FloatArray
    force_noise_g: float
    travel_noise_mm: float

    def draw(self, rng: Generator) -> TouchParameters:
        """A new sensor."""
        root_g, release_g, root_mm, release_mm = rng.multivariate_normal(self.mean, self.covariance)
        return _sensor(
            float(root_g) ** 2, float(release_g), float(root_mm) ** 2, float(release_mm),
            self.force_noise_g, self.travel_noise_mm,
        )  # fmt: skip


def measured_units() -> tuple[TouchParameters, ...]:
    """The paper's eight sensors, each with the means and the scatter of its own switchings."""
    units = []
    for press_g, release_g, press_mm, release_mm in zip(*_TABLES, strict=True):
        noise_g = float(np.sqrt(0.5 * (press_g.var() + release_g.var()) + _RESOLUTION_G**2 / 12.0))
        noise_mm = float(np.sqrt(0.5 * (press_mm.var() + release_mm.var()) + 1e-4 / 12.0))
        gap_g, gap_mm = press_g.mean() - release_g.mean(), press_mm.mean() - release_mm.mean()
        units.append(_sensor(gap_g, release_g.mean(), gap_mm, release_mm.mean(), noise_g, noise_mm))
    return tuple(units)


def fit_population(units: tuple[TouchParameters, ...] | None = None) -> TouchPopulation:
    """The population from which these sensors (the paper's eight by default) may come."""
    known = units or measured_units()
    rows = []
    for unit in known:
        press_g, release_g, _ = unit.thresholds("force_g")
        press_mm, release_mm, _ = unit.thresholds("travel_mm")
        gaps = np.sqrt(np.maximum([press_g - release_g, press_mm - release_mm], 0.0))
        rows.append([gaps[0], release_g, gaps[1], release_mm])
    table = np.array(rows)
    return TouchPopulation(
        mean=table.mean(axis=0),
        covariance=np.cov(table.T),
        force_noise_g=float(np.sqrt(np.mean([unit.force_noise_g**2 for unit in known]))),
        travel_noise_mm=float(np.sqrt(np.mean([unit.travel_noise_mm**2 for unit in known]))),
    )


def _sensor(
    gap_g: float, release_g: float, gap_mm: float, release_mm: float, noise_g: float, noise_mm: float
) -> TouchParameters:
    return TouchParameters(
        switch_force_g=float(release_g + 0.5 * gap_g),
        switch_travel_mm=float(release_mm + 0.5 * gap_mm),
        force_noise_g=noise_g,
        travel_noise_mm=noise_mm,
        press_force_g=float(release_g + gap_g),
        release_force_g=float(release_g),
        press_travel_mm=float(release_mm + gap_mm),
        release_travel_mm=float(release_mm),
    )
