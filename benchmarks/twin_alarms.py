"""How often the live monitor calls a divergence where none is: three motors and a sensor on one link, side by side.

The motors come from the benchmark's own simulator, which shares no formula with the twin. The twin knows
their true parameters. A random torque acts, and the links' stamps are off. `python -m benchmarks.twin_alarms
HOURS [SEED]` counts that number of hours over each link, which is longer than `make bench` has time for.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter
from scipy.stats import chi2

from benchmarks.twin_feed import Fed, feed_all, plant_of
from nxt_twin.arrays import FloatArray
from nxt_twin.blind.answer import true_parameters
from nxt_twin.blind.bench import draw_motor
from nxt_twin.blind.excitation import FAMILIES
from nxt_twin.blind.polling import LinkName
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.run import Commands
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import PORTS, Port
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.settings import FALSE_ALARMS_PER_HOUR

FIRST_SEED: Final = 50_000
"""Thresholds were set on seeds below."""
SHORT_H: Final = 0.1
DURATION_S: Final = 60.0
TORQUE_NOISE_NM: Final = 2e-3
LINKS: Final[tuple[LinkName, ...]] = ("usb", "bluetooth")
_SAID_EVERY: Final = 10
_TRIP_MS: Final = (3.0, 3.2)
"""A little more than the longest round trip over USB, so that each row of a motor is one of its polls."""
_STALL_CHANCE: Final = 0.0005
_STALL_S: Final = (0.03, 0.12)
TORQUE_MEMORY_S: Final = 0.05


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    return counted(SHORT_H, FIRST_SEED)


def counted(hours: float, first_seed: int) -> Iterator[str]:
    """Watch so many hours over each link, three new motors a minute; lines now and then, and at the end."""
    minutes = round(hours * 3600.0 / DURATION_S)
    seen: dict[LinkName, list[Fed]] = {link: [] for link in LINKS}
    for number, seed in enumerate(range(first_seed, first_seed + minutes), start=1):
        for link, motors in watched(seed).items():
            seen[link] += motors
            events = (event for fed in motors for event in fed.of("divergence"))
            yield from (f"{link}, seed {seed}: {event.words}" for event in events)
        if number % _SAID_EVERY == 0 or number == minutes:
            yield from (_line(link, found) for link, found in seen.items())
            both = [fed for found in seen.values() for fed in found]
            yield _line("both", both)
            yield _stated(both)


def watched(seed: int) -> dict[LinkName, list[Fed]]:
    """Three motors on one battery through one true minute, watched over each link."""
    rng = np.random.default_rng(seed)
    battery_v = float(rng.uniform(7.2, 8.6))
    runs = {port: _run(rng, polls_s, battery_v) for port, polls_s in _polls_s(rng).items()}
    recordings = {port: recording for port, (recording, _) in runs.items()}
    plants = {port: plant for port, (_, plant) in runs.items()}
    return {link: list(feed_all(recordings, plants, link, seed, sensors=True).values()) for link in LINKS}


def _polls_s(rng: Generator) -> dict[Port, FloatArray]:
    """When each motor is polled over USB: in turn, then a sensor; now and then the host stands still."""
    turns = len(PORTS) + 1
    count = round(DURATION_S / (1e-3 * np.mean(_TRIP_MS)))
    stalls_s = np.where(rng.random(count) < _STALL_CHANCE, rng.uniform(*_STALL_S, count), 0.0)
    taken_s = np.cumsum(1e-3 * rng.uniform(*_TRIP_MS, count) + stalls_s)
    return {port: taken_s[turn::turns] for turn, port in enumerate(PORTS)}


def _run(rng: Generator, polls_s: FloatArray, battery_v: float) -> tuple[Recording, Plant]:
    """A motor of its own under commands of its own, which stood still or turned already when it began."""
    motor = replace(draw_motor(rng), battery_v=battery_v)
    excitation = FAMILIES[str(rng.choice(list(FAMILIES)))](rng, polls_s)
    before_pct = float(rng.choice((0.0, 0.0, 0.0, np.round(rng.uniform(-60.0, 60.0)))))
    torque_nm = _torque_nm(rng, polls_s)
    start_deg = float(rng.uniform(0.0, 1.0))
    commands = Commands(polls_s, excitation.power_pct, excitation.mode, start_deg, before_pct, torque_nm)
    taken = take(rng, "watched.csv", motor, Sensing(), commands)
    return taken.recording, plant_of(true_parameters(motor))


def _torque_nm(rng: Generator, polls_s: FloatArray) -> FloatArray:
    """A random torque that is forgotten within some polls, held from each to the next."""
    kept = float(np.exp(-np.mean(np.diff(polls_s)) / TORQUE_MEMORY_S))
    kicks = TORQUE_NOISE_NM * np.sqrt(1.0 - kept**2) * rng.standard_normal(polls_s.size)
    torque_nm: FloatArray = lfilter([1.0], [1.0, -kept], kicks)
    return torque_nm


def at_most_per_hour(alarms: int, hours: float) -> float:
    """The upper 95 % bound of a rate of which so many were counted (Poisson)."""
    return float(chi2.ppf(0.95, 2 * (alarms + 1))) / 2.0 / hours


def _stated(found: list[Fed]) -> str:
    hours = len(found) * DURATION_S / 3600.0
    bound = at_most_per_hour(sum(len(fed.of("divergence")) for fed in found), hours)
    enough = "counted" if bound <= FALSE_ALARMS_PER_HOUR else "not shown by so few hours, or not so"
    return f"stated: at most {FALSE_ALARMS_PER_HOUR:g} an hour: {enough}"


def _line(name: str, found: list[Fed]) -> str:
    hours = len(found) * DURATION_S / 3600.0
    alarms = sum(len(fed.of("divergence")) for fed in found)
    blocked = sum(len(fed.of("stall")) for fed in found)
    square = float(np.mean([np.mean(fed.squares) for fed in found]))
    peaks = np.sort([fed.most_nats for fed in found])
    doubted = min(fed.least_nothing for fed in found)
    return (
        f"{name}: {alarms} alarms in {hours:.2f} motor hours, at most {at_most_per_hour(alarms, hours):.2g} an hour "
        f"(95 %); most evidence of a minute: median {np.median(peaks):.1f}, highest {peaks[-1]:.1f} nats; the model's "
        f"least probability {doubted:.2g}; mean normalised square {square:.2f}; said to be blocked: {blocked}"
    )


if __name__ == "__main__":
    for line in counted(float(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else FIRST_SEED):
        print(line, flush=True)
