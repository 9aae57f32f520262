"""How often the live monitor calls a divergence where none is: three motors and a sensor on one link, side by side.

The motors come from the benchmark's own simulator, which shares no formula with the twin. The twin knows
their true parameters. A random torque acts, and the links' stamps are off. `python -m benchmarks.twin_alarms
HOURS [SEED]` counts that number of hours over each link, which is longer than `make bench` has time for. It keeps each
minute. A run that was ended goes on after its last one, and the minutes of a seed add up.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, final

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter
from scipy.stats import chi2

from benchmarks import ledger
from benchmarks.ledger import Ledger
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
    with TemporaryDirectory() as folder:
        yield from counted(SHORT_H, FIRST_SEED, Ledger(Path(folder) / "alarms.jsonl", ""))


def counted(hours: float, first_seed: int, kept: Ledger) -> Iterator[str]:
    """Watch what is missing of a number of hours over each link, three new motors a minute; lines now and then."""
    minutes = round(hours * 3600.0 / DURATION_S)
    for number in range(len(kept.pieces()), minutes):
        found = watched(first_seed + number)
        kept.add({link: [asdict(_minute(fed)) for fed in motors] for link, motors in found.items()})
        for link, motors in found.items():
            events = (event for fed in motors for event in fed.of("divergence"))
            yield from (f"{link}, seed {first_seed + number}: {event.words}" for event in events)
        if (number + 1) % _SAID_EVERY == 0:
            yield from _lines(kept)
    yield from _lines(kept)
    yield f"commits: {kept.commits()}"


def _lines(kept: Ledger) -> Iterator[str]:
    seen = {link: [Minute(**each) for piece in kept.pieces() for each in piece[link]] for link in LINKS}
    yield from (_line(link, found) for link, found in seen.items())
    both = [minute for found in seen.values() for minute in found]
    yield _line("both", both)
    yield _stated(both)


@final
@dataclass(frozen=True)
class Minute:
    """Alarms and evidence of one motor in one minute over one link.

    Attributes:
        alarms: divergences that were called.
        blocked: times that it was said to be blocked.
        most_nats, least_nothing: as of `Fed`.
        square: mean normalised squared innovation.
    """

    alarms: int
    blocked: int
    most_nats: float
    least_nothing: float
    square: float


def _minute(fed: Fed) -> Minute:
    square = float(np.mean(fed.squares))
    return Minute(
        len(fed.of("divergence")),
        len(fed.of("stall")),
        float(fed.most_nats),
        float(fed.least_nothing),
        square,
    )


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
    """The upper 95 % bound of a rate, from the number of alarms counted (Poisson)."""
    return float(chi2.ppf(0.95, 2 * (alarms + 1))) / 2.0 / hours


def _stated(found: Sequence[Minute]) -> str:
    bound = at_most_per_hour(sum(each.alarms for each in found), _hours(found))
    enough = "counted" if bound <= FALSE_ALARMS_PER_HOUR else "not shown by so few hours, or not so"
    return f"stated: at most {FALSE_ALARMS_PER_HOUR:g} an hour: {enough}"


def _hours(found: Sequence[Minute]) -> float:
    return len(found) * DURATION_S / 3600.0


def _line(name: str, found: Sequence[Minute]) -> str:
    alarms = sum(each.alarms for each in found)
    peaks = np.sort([each.most_nats for each in found])
    return (
        f"{name}: {alarms} alarms in {_hours(found):.2f} motor hours, at most "
        f"{at_most_per_hour(alarms, _hours(found)):.2g} an hour (95 %); most evidence of a minute: median "
        f"{np.median(peaks):.1f}, highest {peaks[-1]:.1f} nats; the model's least probability "
        f"{min(each.least_nothing for each in found):.2g}; mean normalised square "
        f"{np.mean([each.square for each in found]):.2f}; said to be blocked: {sum(each.blocked for each in found)}"
    )


if __name__ == "__main__":
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else FIRST_SEED
    for line in counted(float(sys.argv[1]), seed, Ledger(ledger.FOLDER / "alarms.jsonl", f"seed {seed}")):
        print(line, flush=True)
