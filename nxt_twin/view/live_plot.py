"""The pictures of a live session: each motor, the sensors, and the link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.library import name_of
from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.twin.records import Event, Innovation, Tick
from nxt_twin.view import palette
from nxt_twin.view.legends import name_curves
from nxt_twin.view.thinning import envelope, some, trend
from nxt_twin.view.wording import quantity

BAND_STD: Final = 2.0
NIS_BOUND: Final = 3.84
"""95 % of normalised innovation squares are below, while the model holds: chi squared, one degree of freedom."""

_COLUMNS: Final = 420
_MOST_DOTS: Final = 1500
_NIS_MEMORY: Final = 50
_MARKED: Final = ("divergence", "effect_named", "adopted", "stall", "slip", "link_lost")
_LEAST_TOLD: Final = 0.05
_MOST_TOLD: Final = 4
_EFFECTS: Final = ("#56616c", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a6a00")


def motor_figure(port: Port, ticks: Sequence[Tick], events: Sequence[Event]) -> Figure:
    """Measured against predicted, innovations, their squares, unknown torque, and what may explain it."""
    figure = Figure(figsize=(10.4, 7.2))
    grid = figure.add_gridspec(
        3,
        2,
        left=0.06,
        right=0.985,
        top=0.955,
        bottom=0.07,
        hspace=0.42,
        wspace=0.17,
        width_ratios=(1.25, 1.0),
    )
    readings = readings_of(tacho_column(port), ticks)
    angle = figure.add_subplot(grid[0, 0])
    draw_reading(angle, readings, "angle (deg)")
    innovation = figure.add_subplot(grid[1, 0], sharex=angle)
    draw_innovation(innovation, readings, "innovation and the bounds ± 2 σ (deg)")
    squares = figure.add_subplot(grid[2, 0], sharex=angle)
    _draw_squares(squares, readings)
    states = _States(port, ticks)
    adopted_s = [event.time_s for event in events if event.port == port and event.kind == "adopted"]
    _draw_cloud(figure.add_subplot(grid[0, 1]), states, adopted_s)
    torque = figure.add_subplot(grid[1, 1], sharex=angle)
    _draw_torque(torque, states)
    effects = figure.add_subplot(grid[2, 1], sharex=angle)
    _draw_effects(effects, port, ticks)
    for axes in (angle, innovation, squares, torque, effects):
        _mark(axes, [event for event in events if event.port == port])
    for axes in (squares, effects):
        palette.name_abscissa(axes, "time (s)")
    return figure


def sensors_figure(channels: Sequence[str], ticks: Sequence[Tick]) -> Figure:
    """Each sensor beside its model, and what is between them."""
    height_in = 1.75 * len(channels) + 0.55
    figure = Figure(figsize=(10.4, height_in))
    grid = figure.add_gridspec(
        len(channels), 2, left=0.06, right=0.985, hspace=0.5, wspace=0.17,
        top=1 - 0.28 / height_in, bottom=0.45 / height_in,
    )  # fmt: skip
    for row, channel in enumerate(channels):
        readings = readings_of(channel, ticks)
        unit = readings[0].unit if readings else ""
        left, right = figure.add_subplot(grid[row, 0]), figure.add_subplot(grid[row, 1])
        draw_reading(left, readings, f"{quantity(channel)} ({unit})")
        draw_innovation(right, readings, f"{quantity(channel)}: innovation and ± 2 σ ({unit})")
        if row == len(channels) - 1:
            palette.name_abscissa(left, "time (s)")
            palette.name_abscissa(right, "time (s)")
    return figure


def link_figure(ticks: Sequence[Tick]) -> Figure:
    """Latency, polls a second, and the battery."""
    figure = Figure(figsize=(10.4, 2.3))
    grid = figure.add_gridspec(1, 3, left=0.05, right=0.985, top=0.86, bottom=0.2, wspace=0.2)
    up = [tick for tick in ticks if tick.link_up]
    time_s = np.array([tick.received_s for tick in up])
    latency_ms = np.array([1e3 * (tick.received_s - tick.sent_s) for tick in up])
    numbers = np.array([tick.number for tick in up], dtype=np.float64)
    battery = np.array([(t.received_s, t.battery_v) for t in ticks if t.battery_v is not None]).reshape(-1, 2)
    panes: list[tuple[str, FloatArray, FloatArray]] = [
        ("latency of a poll (ms)", time_s, latency_ms),
        ("polls a second", *_rate(time_s, numbers)),
        ("battery (V)", battery[:, 0], battery[:, 1]),
    ]
    for column, (title, at_s, values) in enumerate(panes):
        axes = figure.add_subplot(grid[column])
        palette.dress(axes, title)
        palette.name_abscissa(axes, "time (s)")
        if at_s.size:
            axes.plot(*envelope(at_s, values, _COLUMNS // 2), color=palette.MEASURED_INK, linewidth=1.1)
        if "V" not in title:
            axes.set_ylim(bottom=0.0)
    return figure


def readings_of(channel: str, ticks: Sequence[Tick]) -> list[Innovation]:
    """One channel's readings, in order."""
    return [reading for tick in ticks for reading in tick.innovations if reading.channel == channel]


def draw_reading(axes: Axes, readings: Sequence[Innovation], title: str) -> None:
    """Draw what was measured over what was predicted with its band; refused readings as crosses."""
    palette.dress(axes, title)
    if not readings:
        return
    time_s, measured, predicted, std = _table(readings)
    refused = np.array([not reading.accepted for reading in readings])
    kept = np.where(refused, np.nan, measured)
    _draw_band(axes, time_s, predicted, std)
    axes.plot(*envelope(time_s, kept, _COLUMNS), color=palette.MEASURED, linewidth=2.6, label="measured")
    axes.plot(
        *envelope(time_s, predicted, _COLUMNS), color=palette.IMPROVED, linewidth=1.1, label="predicted"
    )
    if refused.any():
        marked = some(np.flatnonzero(refused), 120)
        axes.plot(
            time_s[marked], measured[marked], linestyle="none", marker="x", markersize=4,
            color=palette.STALE, label="not believed",
        )  # fmt: skip
    name_curves(axes)


def draw_innovation(axes: Axes, readings: Sequence[Innovation], title: str) -> None:
    """Draw measured less predicted, between its bounds."""
    palette.dress(axes, title)
    if not readings:
        return
    time_s, measured, predicted, std = _table(readings)
    believed = np.array([reading.accepted for reading in readings])
    error = np.where(believed, measured - predicted, np.nan)
    axes.plot(*envelope(time_s, error, _COLUMNS), color=palette.MEASURED_INK, linewidth=0.8)
    for sign in (-1.0, 1.0):
        axes.plot(*envelope(time_s, sign * BAND_STD * std, _COLUMNS), color=palette.BASELINE, linewidth=1.0)


class _States:
    """A motor's estimates as columns."""

    def __init__(self, port: Port, ticks: Sequence[Tick]) -> None:
        rows = [
            (t.received_s, m.speed_deg_per_s, 1e3 * m.unknown_torque_nm, 1e3 * m.unknown_torque_std_nm)
            for t in ticks
            for m in t.motors
            if m.port == port
        ]
        self.time_s, self.speed, self.torque, self.std = np.array(rows, dtype=np.float64).reshape(-1, 4).T


def _draw_squares(axes: Axes, readings: Sequence[Innovation]) -> None:
    palette.dress(axes, "normalised innovation square, its running mean, and where 95 % are below")
    if not readings:
        return
    time_s = np.array([reading.time_s for reading in readings])
    squares = np.array([reading.normalised_square for reading in readings])
    summed = np.concatenate(([0.0], np.cumsum(squares)))
    first = np.maximum(np.arange(1, squares.size + 1) - _NIS_MEMORY, 0)
    mean = (summed[1:] - summed[first]) / (np.arange(1, squares.size + 1) - first)
    axes.plot(*envelope(time_s, squares, _COLUMNS), color=palette.MEASURED, linewidth=0.7)
    axes.plot(time_s, mean, color=palette.IMPROVED, linewidth=1.6)
    axes.axhline(NIS_BOUND, color=palette.BASELINE, linewidth=1.0)
    top = max(8.0, 1.3 * float(np.quantile(squares, 0.98)), 1.1 * float(np.max(mean)))
    axes.set_ylim(0.0, top)


def _draw_cloud(axes: Axes, states: _States, adopted_s: Sequence[float]) -> None:
    """Unknown torque against speed; anew, in another colour, from the moment that the last model was adopted."""
    palette.dress(axes, "unknown torque (mN·m)")
    palette.name_abscissa(axes, "speed (deg/s)")
    if not states.time_s.size:
        return
    after = states.time_s >= (max(adopted_s) if adopted_s else -np.inf)
    epochs = [(after, palette.IMPROVED, "adopted model" if adopted_s else "this model")]
    if adopted_s:
        epochs.insert(0, (~after, palette.BASELINE, "model before"))
    for chosen, colour, label in epochs:
        _draw_epoch(axes, states.speed[chosen], states.torque[chosen], colour, label)
    axes.axhline(0.0, color=palette.LINE, linewidth=0.8)
    name_curves(axes)


def _draw_epoch(axes: Axes, speed: FloatArray, torque: FloatArray, colour: str, label: str) -> None:
    dots = some(np.arange(speed.size), _MOST_DOTS)
    axes.plot(
        speed[dots], torque[dots], linestyle="none", marker=".", markersize=2.2, color=colour, alpha=0.35
    )
    along = trend(speed, torque)
    axes.plot(along.at, along.median, color=colour, linewidth=1.8, label=label)


def _draw_torque(axes: Axes, states: _States) -> None:
    palette.dress(axes, "unknown torque over time, ± 2 σ (mN·m)")
    if not states.time_s.size:
        return
    _draw_band(axes, states.time_s, states.torque, states.std)
    axes.plot(*envelope(states.time_s, states.torque, _COLUMNS), color=palette.IMPROVED, linewidth=1.0)
    axes.axhline(0.0, color=palette.LINE, linewidth=0.8)


def _draw_effects(axes: Axes, port: Port, ticks: Sequence[Tick]) -> None:
    palette.dress(axes, "probability")
    rows = [(tick.received_s, motor.effects) for tick in ticks for motor in tick.motors if motor.port == port]
    peaks: dict[str, float] = {}
    for _, effects in rows:
        for name, probability in effects.items():
            peaks[name] = max(peaks.get(name, 0.0), probability)
    likely = [name for name, peak in peaks.items() if name == "nothing" or peak >= _LEAST_TOLD]
    told = sorted(likely, key=lambda name: (name != "nothing", -peaks[name]))[:_MOST_TOLD]
    for name, colour in zip(told, _EFFECTS, strict=False):
        curve = np.array([(at, effects[name]) for at, effects in rows if name in effects])
        words = "the model as it is" if name == "nothing" else name_of(name)
        axes.plot(*envelope(curve[:, 0], curve[:, 1], _COLUMNS), color=colour, linewidth=1.4, label=words)
    axes.set_ylim(-0.03, 1.03)
    if told:
        name_curves(axes)
    else:
        axes.text(0.5, 0.5, "none were weighed", transform=axes.transAxes, ha="center", color=palette.MUTED)


def _draw_band(axes: Axes, time_s: FloatArray, middle: FloatArray, std: FloatArray) -> None:
    """Shade two standard deviations each way, at no more places than can be told apart."""
    at_s, low = envelope(time_s, middle - BAND_STD * std, _COLUMNS)
    high = np.interp(at_s, *envelope(time_s, middle + BAND_STD * std, _COLUMNS))
    axes.fill_between(at_s, low, high, color=palette.IMPROVED, alpha=0.16, linewidth=0)


def _table(readings: Sequence[Innovation]) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    rows = np.array([(r.time_s, r.measured, r.predicted, max(r.variance, 0.0)) for r in readings])
    return rows[:, 0], rows[:, 1], rows[:, 2], np.sqrt(rows[:, 3])


def _rate(time_s: FloatArray, numbers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Polls a second, in up to 60 stretches of the session."""
    chosen = some(np.arange(time_s.size), 60)
    if chosen.size < 2:
        return np.empty(0), np.empty(0)
    passed_s = np.diff(time_s[chosen])
    told = passed_s > 0
    return time_s[chosen][1:][told], np.diff(numbers[chosen])[told] / passed_s[told]


def _mark(axes: Axes, events: Sequence[Event]) -> None:
    for event in events:
        if event.kind in _MARKED:
            axes.axvline(event.time_s, color=palette.SPELL_INK, linewidth=0.9, linestyle=(0, (3, 2)))
