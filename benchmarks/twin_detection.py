"""How soon the live monitor calls a divergence where something is missing, and how well it dates it.

Motors of the benchmark's own simulator under a random torque, over links whose stamps are off, beside their true base
parameters. `python -m benchmarks.twin_detection SEEDS [EFFECT…]` takes SEEDS motors of each effect.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

import numpy as np

from benchmarks.twin_alarms import LINKS, TORQUE_NOISE_NM
from benchmarks.twin_feed import feed, true_plant
from benchmarks.twin_ideal import gained_nats
from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.make import make_case
from nxt_twin.blind.polling import LinkName, polls_s
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import Recording

FIRST_SEED: Final = 60_000
WITHIN_S: Final = 60.0
SHORT: Final = ("constant_load", "backlash")
PUSHES_NM: Final = (0.02, 0.03, 0.05)
_LEVELS: Final = (50.0, -60.0, 35.0, -45.0, 70.0, -30.0, 55.0, -80.0)
_HELD_S: Final = 1.1
_AIM_S: Final = 0.3
_NOTICED: Final = ("divergence", "stall")
"""A motor that runs into a stop is said to be blocked, and its model is not doubted."""


class Called(NamedTuple):
    """When a divergence was called and since when it says it was, s after the event; NaN if never."""

    after_s: float
    onset_s: float


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    yield from effects(SHORT, 1)
    yield from pushes(3)


def effects(ids: Iterable[str], seeds: int) -> Iterator[str]:
    """A row for each effect of medium size, then how many were noticed.

    Where it was not, what could have been is told.
    """
    delays: dict[LinkName, list[float]] = {link: [] for link in LINKS}
    for effect in ids:
        here: dict[LinkName, list[float]] = {link: [] for link in LINKS}
        missed: list[str] = []
        for seed in range(FIRST_SEED, FIRST_SEED + seeds):
            case = make_case(
                seed, effects=(effect,), size="medium", duration_s=WITHIN_S, recordings=1,
                torque_noise_nm=TORQUE_NOISE_NM, link="usb",
            )  # fmt: skip
            for link in LINKS:
                here[link].append(_called(case.recordings[0], true_plant(case), link, seed, 0.0).after_s)
                if not np.isfinite(here[link][-1]):
                    missed.append(f"{link} {gained_nats(case, link, seed):.0f}")
        words = [f"{link} {', '.join(_seconds(each) for each in found)}" for link, found in here.items()]
        words += [f"nats for who knows what is missing: {', '.join(missed)}"] * bool(missed)
        yield f"{effect:26} noticed after: {'; '.join(words)}"
        for link, found in here.items():
            delays[link] += found
    for link, found in delays.items():
        known = [each for each in found if np.isfinite(each)]
        typical = f"; after {np.median(known):.1f} s (median)" if known else ""
        yield f"{link}: {len(known)} of {len(found)} noticed within {WITHIN_S:.0f} s{typical}"


def pushes(seeds: int) -> Iterator[str]:
    """A steady torque that sets in at some moment: a row for each size."""
    plant = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
    for push_nm in PUSHES_NM:
        for link in LINKS:
            called = [_pushed(seed, push_nm, plant, link) for seed in range(FIRST_SEED, FIRST_SEED + seeds)]
            offs = np.array([abs(each.onset_s) for each in called])
            late = np.array([each.after_s for each in called])
            yield (
                f"{1e3 * push_nm:.0f} mN·m sets in, {link}: called {np.isfinite(late).sum()} of {seeds}, after "
                f"{np.nanmedian(late):.2f} s; onset off by {np.nanmedian(offs):.2f} s (medians), "
                f"within {_AIM_S} s in {(offs < _AIM_S).sum()}"
            )


def _called(recording: Recording, plant: Plant, link: LinkName, seed: int, event_s: float) -> Called:
    fed = feed(recording, plant, link, seed)
    found = [each for each in fed.events if each.kind in _NOTICED and each.time_s >= event_s]
    if not found:
        return Called(np.nan, np.nan)
    onset_s = found[0].onset_s
    return Called(found[0].time_s - event_s, np.nan if onset_s is None else onset_s - event_s)


def _pushed(seed: int, push_nm: float, plant: Plant, link: LinkName) -> Called:
    rng = np.random.default_rng(seed)
    read_s = polls_s(rng, "usb", 14.0)
    event_s = float(rng.uniform(5.0, 8.0))
    power = np.array(_LEVELS)[(read_s / _HELD_S).astype(int) % len(_LEVELS)]
    push = np.where(read_s >= event_s, push_nm * float(rng.choice((-1.0, 1.0))), 0.0)
    commands = Commands(read_s, power, np.zeros(read_s.size, dtype=np.int64), 0.3, 0.0, push)
    recording = take(rng, "pushed.csv", Motor(), Sensing(), commands).recording
    return _called(recording, plant, link, seed, event_s)


def _seconds(value: float) -> str:
    return f"{value:.1f} s" if np.isfinite(value) else "never"


if __name__ == "__main__":
    count = int(sys.argv[1])
    wanted = sys.argv[2:] or [effect.id for effect in KNOWN_EFFECTS.values() if effect.leaves_out is None]
    for line in itertools.chain(effects(wanted, count), pushes(10 * count)):
        print(line, flush=True)
