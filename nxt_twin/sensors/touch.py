"""The touch sensor: a switch on a spring, by force or by travel, with hysteresis.

Source: Gonçalves et al., section III.B and tables III to VI. At each press the switch closes at a force of its
own, normal round `press_force_g`, and opens again at one round `release_force_g`; likewise by travel.
Default parameters are the ideal sensor: it switches at one force.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.random import Generator
from scipy.special import log_ndtr, ndtr

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.config import Configured, SensorLayout
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.expected import Expected
from nxt_twin.sensors.fitting import FittedSensor, Free, chosen, fit_free
from nxt_twin.sensors.intervals import log_interval_probability

Stroke = Literal["force_g", "travel_mm"]

LAYOUT = SensorLayout(
    "touch_sensor",
    {
        "touch_hysteresis": {
            "press_force_g": "press_force_g",
            "release_force_g": "release_force_g",
            "press_travel_mm": "press_travel_mm",
            "release_travel_mm": "release_travel_mm",
        },
    },
)


@final
@dataclass(frozen=True)
class TouchParameters(Configured):
    """A touch sensor.

    Attributes:
        switch_force_g: the force at which the ideal sensor switches both ways, in grams of weight.
        switch_travel_mm: its travel there.
        force_noise_g: standard deviation of the force from one switching to the next.
        travel_noise_mm: the same of the travel.
        misread_probability: of a reading that is not what the switch is.
        press_force_g, release_force_g: hysteresis by force; None is off, both ways at `switch_force_g`.
        press_travel_mm, release_travel_mm: hysteresis by travel; None is off.
    """

    layout: ClassVar[SensorLayout] = LAYOUT

    switch_force_g: float = 60.0
    switch_travel_mm: float = 2.0
    force_noise_g: float = 0.5
    travel_noise_mm: float = 0.005
    misread_probability: float = 0.0
    press_force_g: float | None = None
    release_force_g: float | None = None
    press_travel_mm: float | None = None
    release_travel_mm: float | None = None

    def thresholds(self, stroke: Stroke) -> tuple[float, float, float]:
        """Where it closes, where it opens, and the standard deviation of both, in the stroke's unit."""
        if stroke == "force_g":
            single, press, release = self.switch_force_g, self.press_force_g, self.release_force_g
            noise = self.force_noise_g
        else:
            single, press, release = self.switch_travel_mm, self.press_travel_mm, self.release_travel_mm
            noise = self.travel_noise_mm
        return (single if press is None else press, single if release is None else release, noise)


@final
@dataclass(frozen=True)
class TouchTruth:
    """What pressed the button at each poll, as its force or as its travel; the array has shape (polls,)."""

    values: FloatArray
    stroke: Stroke = "force_g"


FREE: tuple[Free, ...] = (
    Free("switch_force_g", 0.0, 1000.0, 1.0),
    Free("switch_travel_mm", 0.0, 10.0, 0.05),
    Free("force_noise_g", 0.01, 100.0, 0.2),
    Free("travel_noise_mm", 1e-4, 2.0, 0.01),
    Free("misread_probability", 0.0, 0.4, 0.005),
    Free("press_force_g", 0.0, 1000.0, 1.0),
    Free("release_force_g", 0.0, 1000.0, 1.0),
    Free("press_travel_mm", 0.0, 10.0, 0.05),
    Free("release_travel_mm", 0.0, 10.0, 0.05),
)
"""The parameters that can be fitted, with their bounds."""

_LEAST = 1e-12
_ANYWHERE = 0.01
"""The share of a stroke's polls at any one of which a misreading may end it: about one in a hundred."""


@final
@dataclass(frozen=True)
class Strokes:
    """What readings say about each switching: somewhere between `low` and `high` of the force (or travel).

    Arrays have shape (strokes,). `begin` is the value at which it began, so that the threshold was known to lie
    beyond it. `closes` is 1 for a press and 0 for a release; `high` is inf where a press was
    not reached before the run ended, and `low` is -inf likewise for a release; `at` is the poll that ends it.
    """

    begin: FloatArray
    low: FloatArray
    high: FloatArray
    closes: FloatArray
    at: FloatArray


def strokes_of(readings: FloatArray, values: FloatArray) -> Strokes:
    """Cut a run into strokes: from one switching to the next the threshold is passed once.

    While open, the largest value so far did not close the switch; the value at the first closed reading did.
    """
    seen = np.flatnonzero(~np.isnan(readings))
    rows: list[tuple[float, ...]] = []
    closed, begin, extreme = False, np.nan, np.nan
    for count, index in enumerate(seen.tolist()):
        value, now = float(values[index]), bool(readings[index] >= 0.5)
        if count == 0:
            closed, begin, extreme = now, value, value
        elif now == closed:
            extreme = min(extreme, value) if closed else max(extreme, value)
        else:
            ends = (value, extreme, 0.0) if closed else (extreme, value, 1.0)
            rows.append((begin, *ends, float(index)))
            closed, begin, extreme = now, value, value
    if seen.size:
        ends = (-np.inf, extreme, 0.0) if closed else (extreme, np.inf, 1.0)
        rows.append((begin, *ends, float(seen[-1])))
    return Strokes(*np.array(rows, dtype=np.float64).reshape(-1, 5).T)


def log_likelihood_strokes(parameters: TouchParameters, strokes: Strokes, stroke: Stroke) -> FloatArray:
    """The logarithm of each stroke's probability, nats: that its threshold fell where the readings say.

    Given that it lay beyond the stroke's beginning. A switching may happen although the value went the other way
    (high ≤ low). The threshold then lay between the two if the rig's own value scatters; otherwise only a
    misreading explains it.
    """
    press, release, noise = parameters.thresholds(stroke)
    presses = strokes.closes > 0.5
    middle = np.where(presses, press, release)
    low, high, begin = ((value - middle) / noise for value in (strokes.low, strokes.high, strokes.begin))
    misread = max(parameters.misread_probability, _LEAST)
    astray = np.log(misread * _ANYWHERE)
    known = log_ndtr(np.where(presses, -begin, begin))
    first, last = np.minimum(low, high), np.maximum(low, high)
    proper = np.minimum(log_interval_probability(first, last) - known, 0.0)
    proper = np.where(strokes.high != strokes.low, proper, -np.inf)
    chance = np.logaddexp(np.log1p(-misread) + proper, astray)
    return np.asarray(chance, dtype=np.float64)


def log_likelihood(parameters: TouchParameters, readings: FloatArray, truth: TouchTruth) -> float:
    """The log-likelihood of the readings (0, 1), nats, given the first; exact for thresholds between polls."""
    if readings.shape != truth.values.shape:
        raise SensorError("readings and truth differ in length", where="touch sensor")
    strokes = strokes_of(readings, truth.values)
    return float(np.sum(log_likelihood_strokes(parameters, strokes, truth.stroke)))


def simulate(parameters: TouchParameters, truth: TouchTruth, rng: Generator) -> FloatArray:
    """Readings 0 or 1, shape (polls,), drawn from the model; it starts open unless pressed past its threshold.

    Each stroke draws a threshold of its own. A threshold below the stroke's beginning is drawn again.
    """
    press, release, noise = parameters.thresholds(truth.stroke)
    closed, threshold = False, press + noise * rng.standard_normal()
    out = np.zeros(truth.values.size)
    for index, value in enumerate(truth.values):
        passed = value >= threshold if not closed else value <= threshold
        if passed:
            closed = not closed
            threshold = _beyond(release if closed else press, noise, float(value), rng, below=closed)
        out[index] = closed
    if parameters.misread_probability:
        wrong = rng.random(out.size) < parameters.misread_probability
        out = np.where(wrong, 1.0 - out, out)
    return out


def _beyond(middle: float, noise: float, value: float, rng: Generator, *, below: bool) -> float:
    """A threshold that is not passed yet: normal, cut off at the present value."""
    for _ in range(1000):
        drawn = middle + noise * rng.standard_normal()
        if drawn < value if below else drawn > value:
            return float(drawn)
    return value


def expected(
    parameters: TouchParameters, value: float, was_closed: bool, stroke: Stroke = "force_g"
) -> Expected:
    """The probability of a closed switch at this force (or travel), given what it was a moment ago."""
    press, release, noise = parameters.thresholds(stroke)
    closed = float(ndtr((value - (release if was_closed else press)) / noise))
    misread = parameters.misread_probability
    closed = closed * (1.0 - misread) + (1.0 - closed) * misread
    return Expected(closed, closed * (1.0 - closed), 0.0)


def predict(parameters: TouchParameters, truth: TouchTruth) -> FloatArray:
    """The readings without noise, run freely from an open switch, shape (polls,)."""
    press, release, _ = parameters.thresholds(truth.stroke)
    closed = False
    out = np.zeros(truth.values.size)
    for index, value in enumerate(truth.values):
        closed = value > release if closed else value >= press
        out[index] = closed
    return out


def fit(
    readings: FloatArray,
    truth: TouchTruth,
    *,
    start: TouchParameters | None = None,
    free: Sequence[str] | None = None,
) -> FittedSensor[TouchParameters]:
    """Fit the parameters named in `free` by maximum likelihood; all others stay as in `start`.

    Args:
        readings: 0 or 1, shape (polls,), NaN where not sampled.
        truth: what pressed the button at each poll.
        start: where to begin; from the readings' own switchings by default.
        free: names out of `FREE`; press, release and noise of the truth's stroke by default.

    Raises:
        SensorError: a name that cannot be fitted, or the switch never both closed and opened.
    """
    by_force = truth.stroke == "force_g"
    if free is None:
        free = (
            ("press_force_g", "release_force_g", "force_noise_g")
            if by_force
            else ("press_travel_mm", "release_travel_mm", "travel_noise_mm")
        )
    wanted = chosen(FREE, free, readings, "touch sensor")
    strokes = strokes_of(readings, truth.values)
    begin = start or first_guess(strokes, truth.stroke)
    fitted = fit_free(
        lambda parameters: float(np.sum(log_likelihood_strokes(parameters, strokes, truth.stroke))),
        begin,
        wanted,
    )
    return _unbiased(fitted, strokes, "force_noise_g" if by_force else "travel_noise_mm")


def _unbiased(
    fitted: FittedSensor[TouchParameters], strokes: Strokes, noise: str
) -> FittedSensor[TouchParameters]:
    """The fit with its noise widened by √(n / (n - m)) for the m thresholds taken from the same n switchings."""
    if noise not in fitted.names:
        return fitted
    whole = int(np.count_nonzero(np.isfinite(strokes.low) & np.isfinite(strokes.high)))
    taken = len(fitted.names) - 1
    widen = float(np.sqrt(whole / max(whole - taken, 1)))
    changed: dict[str, Any] = {noise: getattr(fitted.parameters, noise) * widen}
    return replace(
        fitted,
        parameters=replace(fitted.parameters, **changed),
        std={name: std * widen for name, std in fitted.std.items()},
        covariance=fitted.covariance * widen**2,
    )


def first_guess(strokes: Strokes, stroke: Stroke) -> TouchParameters:
    """Thresholds halfway between the polls at which the switch was seen to change.

    Raises:
        SensorError: the switch never both closed and opened.
    """
    whole = np.isfinite(strokes.low) & np.isfinite(strokes.high)
    presses, releases = whole & (strokes.closes > 0.5), whole & (strokes.closes < 0.5)
    if not (presses.any() and releases.any()):
        mend = "press and release it at least once"
        raise SensorError("the switch never both closed and opened", where="touch sensor", mend=mend)
    middle = 0.5 * (strokes.low + strokes.high)
    press, release = float(np.median(middle[presses])), float(np.median(middle[releases]))
    gap = float(np.median(np.abs(strokes.high - strokes.low)[whole]))
    spread = float(np.std(middle[presses] - press)) + 0.25 * gap
    if stroke == "force_g":
        noise = max(spread, 0.05)
        return TouchParameters(
            0.5 * (press + release), force_noise_g=noise, press_force_g=press, release_force_g=release
        )
    noise = max(spread, 1e-3)
    return TouchParameters(
        switch_travel_mm=0.5 * (press + release),
        travel_noise_mm=noise,
        press_travel_mm=press,
        release_travel_mm=release,
    )
