"""The most that a monitor could notice: the nats that an observer gains who knows the missing effect and its
size.

Two filters follow the same readings and stamps. One has the effect with its true numbers, the other lacks it;
both know the random torque. The difference of their log-likelihoods is about what any monitor could gain at
most, and one that does not know the effect gains less.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from benchmarks.twin_alarms import TORQUE_MEMORY_S, TORQUE_NOISE_NM
from benchmarks.twin_feed import Heed, feed, true_plant
from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.polling import LinkName
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.brick_twin import TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.motor import ReadingEvidence
from nxt_twin.twin.settings import MotorNoise

_NOISE: Final = MotorNoise(torque_nm=TORQUE_NOISE_NM, torque_time_s=TORQUE_MEMORY_S)
_HALF_A_COUNT: Final = 0.5


def gained_nats(case: ConcealedCase, link: LinkName, seed: int) -> float:
    """By how much the first recording of a case is more likely to one who knows its only effect."""
    concealed = case.answer["effects"][0]
    params: dict[str, float] = concealed["params"]
    plant, recording = true_plant(case), case.recordings[0]
    effect = plant.layout.effect(concealed["id"])
    if "reading" in effect.terms:  # an encoder's error is as good as gone to one who knows it
        return _nats(_unspoilt(case), plant, link, seed) - _nats(recording, plant, link, seed)
    if "outlier" in effect.terms:
        age_s = float(np.median(np.diff(recording.time_s)))
        return _nats_of_stale(recording, plant, link, seed, params["stale_fraction"], age_s)
    values = {each.symbol: params.get(each.name, each.starts[0]) * each.si for each in effect.parameters}
    complete = plant.with_effect(effect.id, values)
    return _nats(recording, complete, link, seed) - _nats(recording, plant, link, seed)


def _unspoilt(case: ConcealedCase) -> Recording:
    recording = case.recordings[0]
    counts = np.floor(case.answer["recordings"][recording.name]["hub_deg"])
    return replace(recording, columns={**recording.columns, "a_tacho_deg": counts})


def _nats(recording: Recording, plant: Plant, link: LinkName, seed: int) -> float:
    """The log-likelihood of all readings by the model alone."""
    found: list[float] = []
    _follow(recording, plant, link, seed, lambda evidence: found.append(evidence.believed.log_likelihood))
    return sum(found)


def _nats_of_stale(
    recording: Recording, plant: Plant, link: LinkName, seed: int, fraction: float, age_s: float
) -> float:
    """What is gained by expecting that a share of the readings is of that age."""
    found: list[float] = []

    def weigh(evidence: ReadingEvidence) -> None:
        believed = evidence.believed
        off = math.radians(evidence.tacho_deg + _HALF_A_COUNT) - believed.predicted
        late = off + evidence.speed * age_s
        fresh_nats, stale_nats = (-0.5 * each**2 / believed.variance for each in (off, late))
        expected = np.logaddexp(math.log1p(-fraction) + fresh_nats, math.log(fraction) + stale_nats)
        found.append(float(expected) - fresh_nats)

    _follow(recording, plant, link, seed, weigh)
    return sum(found)


def _follow(recording: Recording, plant: Plant, link: LinkName, seed: int, heed: Heed) -> None:
    options = TwinOptions(noise=_NOISE, candidates=(), bridge=plain_bridge, cells_ohm=0.0)
    feed(recording, plant, link, seed, options, heed)
