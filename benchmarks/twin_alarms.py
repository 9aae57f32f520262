"""How often the live monitor calls a divergence where none is: motors of the benchmark's own simulator, which shares no
formula with the twin, beside their true parameters, with a random torque, over links whose stamps are off.

`python -m benchmarks.twin_alarms HOURS [SEED]` counts for longer than `make bench` has time for.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Final

import numpy as np
from scipy.stats import chi2

from benchmarks.twin_feed import Fed, feed, true_plant
from nxt_twin.blind.make import make_case
from nxt_twin.blind.polling import Link
from nxt_twin.twin.settings import FALSE_ALARMS_PER_HOUR

FIRST_SEED: Final = 9200
"""Thresholds were set on seeds below."""
SHORT_H: Final = 0.1
DURATION_S: Final = 60.0
TORQUE_NOISE_NM: Final = 2e-3
LINKS: Final[tuple[Link, ...]] = ("usb", "bluetooth")
_SAID_EVERY: Final = 30


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    return counted(SHORT_H, FIRST_SEED)


def counted(hours: float, first_seed: int) -> Iterator[str]:
    """Watch so many hours over each link, a new motor a minute; lines now and then, and at the end."""
    motors = round(hours * 3600.0 / DURATION_S)
    seen: dict[Link, list[Fed]] = {link: [] for link in LINKS}
    for number, seed in enumerate(range(first_seed, first_seed + motors), start=1):
        for link, fed in watched(seed).items():
            seen[link].append(fed)
            yield from (f"{link}, seed {seed}: {event.words}" for event in fed.of("divergence"))
        if number % _SAID_EVERY == 0 or number == motors:
            yield from (_line(link, found) for link, found in seen.items())
            both = [fed for found in seen.values() for fed in found]
            yield _line("both", both)
            yield _stated(both)


def watched(seed: int) -> dict[Link, Fed]:
    """One true run, watched over each link."""
    case = make_case(
        seed, effects=(), duration_s=DURATION_S, recordings=1, torque_noise_nm=TORQUE_NOISE_NM, link="usb"
    )
    plant = true_plant(case)
    return {link: feed(case.recordings[0], plant, link, seed) for link in LINKS}


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
    square = float(np.mean([np.mean(fed.squares) for fed in found]))
    peaks = np.sort([fed.most_nats for fed in found])
    doubted = min(fed.least_nothing for fed in found)
    return (
        f"{name}: {alarms} alarms in {hours:.2f} h, so at most {at_most_per_hour(alarms, hours):.2g} an hour "
        f"(95 %); most evidence of a minute: median {np.median(peaks):.1f}, highest {peaks[-1]:.1f} nats; the model's "
        f"least probability {doubted:.2g}; mean normalised square {square:.2f}"
    )


if __name__ == "__main__":
    for line in counted(float(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else FIRST_SEED):
        print(line, flush=True)
