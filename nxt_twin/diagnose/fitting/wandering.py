"""Starts of a stamps' lag that wanders, as a structure's residuals suggest them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from nxt_twin.diagnose.fitting.lag_response import PROBE, PROBE_SPAN_S, SHAPES, Response, Wave
from nxt_twin.diagnose.fitting.nuisance import Nuisance
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

_KEPT = 6  # courses that are run
_CHANCE_NATS = 10.0  # that the best of so many courses promises where no stamp is late: 4 to 13
_LARGE = 0.3  # share of a second wave
_FEWEST_LEAPS = 2  # times from one leap to the next, that tell a period
_LEAPS = 0.999  # rise of a wave that falls within a poll
_EVEN = 0.05  # of these times: how far they spread
_USUAL_LATENESS = (0.5, 0.0)  # of rows that chance makes late, in spans
_QUARTER = (0.0, -0.25)  # the phases of a cosine and a sine


def wandering_starts(nuisance: Nuisance, plant: Plant, effect: Effect) -> list[dict[str, float]]:
    """Starts of `effect`, a lag of whole rows that wanders, SI by symbol, likeliest first.

    A reading answers to the lag and its rate of change at that moment: two waves a quarter of a turn apart show both.
    """
    courses = Response(nuisance, _probes(plant, effect)).likeliest(SHAPES, _KEPT)
    found = [_start(one.span_s, one.wave) for one in courses if one.gain > _CHANCE_NATS]
    return found + late_by_chance_starts(max(job.signals.late_span_s for job in nuisance.jobs))


def wandering_apart_starts(
    nuisance: Nuisance, plant: Plant, effect: Effect
) -> list[tuple[dict[str, float], Mapping[str, float]]]:
    """As `wandering_starts`, each with the phase that the wave has in each recording, by name.

    Where stamps themselves tell of leaps, there is no other.
    """
    leaping = _leaping_starts([job.signals for job in nuisance.jobs])
    if leaping:
        return leaping
    courses = Response(nuisance, _probes(plant, effect)).likeliest_apart(SHAPES, _KEPT)
    return [(_start(one.span_s, one.wave), one.phases) for one in courses if one.gain > _CHANCE_NATS]


def _leaping_starts(
    recordings: Sequence[Signals],
) -> list[tuple[dict[str, float], Mapping[str, float]]]:
    """The start of a clock that leaps back evenly, if stamps stood still in even steps: they did while it caught up."""
    apart_s = np.concatenate([np.diff(one.held_s[:, 0]) for one in recordings])
    if apart_s.size < _FEWEST_LEAPS or np.ptp(apart_s) > _EVEN * np.median(apart_s):
        return []
    wave = Wave(float(np.median(apart_s)), 0.0, _LEAPS, 1.0)
    span_s = float(np.median(np.concatenate([one.held_s[:, 1] for one in recordings])))
    phases = {one.name: -float(one.held_s[0, 0]) / wave.period_s for one in recordings if len(one.held_s)}
    return [(_start(span_s, wave), phases)]


def _probes(plant: Plant, effect: Effect) -> list[Plant]:
    """Lags that wander by `PROBE`, and by that wave a quarter of a turn later."""
    probe = _start(PROBE_SPAN_S, PROBE) | {"lag_mean": 0.0}
    return [plant.with_effect(effect.id, {**probe, "lag_phase": phase}) for phase in _QUARTER]


def late_by_chance_starts(span_s: float) -> list[dict[str, float]]:
    """Starts of a lag that neighbouring stamps tell; none where they tell none.

    A command acts when its row was due, or when it was stamped. The usual lateness may be in other numbers already.
    """
    if span_s <= 0.0:
        return []
    return [
        _start(span_s, PROBE) | {"waves": 0.0, "of_commands": late, "lag_mean": mean}
        for late in (1.0, 0.0)
        for mean in _USUAL_LATENESS
    ]


def second_waves(nuisance: Nuisance, plant: Plant, effect: Effect) -> list[tuple[float, Plant]]:
    """`plant`, whose lag wanders by one wave, with second ones and the gain that each promises, nats, best first."""
    first = {
        parameter.symbol: plant.values[Slot(effect.id, parameter.symbol)] for parameter in effect.parameters
    }
    if first["second_share"] > 0.0 or first["waves"] == 0.0:
        return []
    probe = _beside(first, PROBE_SPAN_S, PROBE)
    probes = [plant.with_effect(effect.id, {**probe, "second_phase": phase}) for phase in _QUARTER]
    return [
        (one.gain, plant.with_effect(effect.id, _beside(first, one.span_s, one.wave)))
        for one in Response(nuisance, probes).likeliest(SHAPES[:1], _KEPT)
    ]


def second_wave_alone(plant: Plant, effect: Effect) -> Plant | None:
    """`plant`, whose lag wanders by two waves, with the second alone where that is a large one; else None."""
    own = {each.symbol: plant.values[Slot(effect.id, each.symbol)] for each in effect.parameters}
    share = own["second_share"]
    if share <= _LARGE:
        return None
    wave = Wave(own["second_period"], own["second_phase"], 0.5, 0.0)
    alone = _start(share * own["lag_span"], wave) | {"rate_error": own["rate_error"]}
    return plant.with_effect(effect.id, alone | {"of_commands": own["of_commands"]})


def _beside(first: Mapping[str, float], span_s: float, wave: Wave) -> dict[str, float]:
    """The lag by `first` and a wave of this span round zero on top of it."""
    whole_s = first["lag_span"] + span_s
    return {
        **first,
        "lag_span": whole_s,
        "lag_mean": first["lag_mean"] * first["lag_span"] / whole_s,
        "second_share": span_s / whole_s,
        "second_period": wave.period_s,
        "second_phase": wave.phase,
    }


def _start(span_s: float, wave: Wave) -> dict[str, float]:
    return {
        "lag_span": span_s,
        "lag_mean": 0.5,
        "rate_error": 0.0,
        "lag_period": wave.period_s,
        "lag_phase": wave.phase,
        "lag_rise": wave.rise,
        "lag_straightness": wave.straightness,
        "second_share": 0.0,
        "second_period": 2.0,
        "second_phase": 0.0,
        "waves": 1.0,
        "of_commands": 1.0,
    }
