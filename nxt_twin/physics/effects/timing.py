"""When commands act, and when readings were taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

_LATE_S = (0.01, 0.04, 0.1)


def _delay(command_delay: float) -> float:
    return command_delay


def _sooner(poll_share: float, longer_after_s: float, longer_before_s: float) -> float:
    """By how much a command acts sooner than others, as its own poll is shorter, s."""
    return -poll_share * (longer_after_s if poll_share > 0.0 else longer_before_s)


def _delays_s(recordings: Sequence[Signals]) -> list[float]:
    """The usual delays, then half a poll and a whole one early: a logger may write a command that already acts."""
    poll_s = -_one_poll_early_s(recordings)
    return [*_LATE_S, -0.5 * poll_s, -poll_s]


def _one_poll_early_s(recordings: Sequence[Signals]) -> float:
    """A command that acts earlier than one poll before its row would stand in the row before."""
    return -min(max(signals.interval_s for signals in recordings), _LATE_S[-1])


COMMAND_DELAY = Effect(
    id="command_delay",
    name="command delay",
    equation="u(t) = command(t - d - p·(T - T0)), d ≥ -T0; T the poll after its row (before it: p < 0), T0 the mean",
    source="a dead time, as a radio link or a polling loop has; negative where a logger writes what acts already",
    equation_of="timing",
    shows=("after_command",),
    notable=2e-3,
    parameters=(
        Parameter(
            "delay_s",
            "command_delay",
            "s",
            NUMBER,
            _LATE_S,
            -_LATE_S[-1],
            0.5,
            hints=_delays_s,
            lowest=_one_poll_early_s,
        ),
        # A loop that writes at its end is late by its own length, which is another each time.
        Parameter(
            "poll_share", "poll_share", "1", NUMBER, (0.0,), -1.0, 1.0, 1.0, otherwise=0.0, shared_out=True
        ),
    ),
    terms={"delay": _delay, "commanded": _sooner},
    confusable_with={
        "inductance": "below two samples nothing tells them apart; poll faster",
        "backlash": "a delay acts on every command, play only where the torque changes sign",
    },
)


def _age(refresh_period: float, age_when_new: float, shown_s: float, unseen_s: float) -> float:
    if unseen_s < 0.0:
        return 0.5 * refresh_period
    return shown_s + age_when_new * unseen_s


def _strayed(speed: float, refresh_period: float, unseen_s: float) -> float:
    """The variance of an age that is anywhere in a span, times the speed squared."""
    strays = (refresh_period if unseen_s < 0.0 else unseen_s) * speed
    return strays * strays / 12.0


def _refreshments_s(recordings: Sequence[Signals]) -> list[float]:
    """What repeated readings tell of the time between refreshments, if anything."""
    told = [signals.refreshed_s for signals in recordings if signals.refreshed_s > 0.0]
    return told[:1]


SAMPLE_HOLD = Effect(
    id="sample_hold",
    name="sample hold",
    equation=(
        "y(t) = θ(t - a), a anywhere from 0 to T: a lag of T/2 and a scatter of T·|ω|/√12; "
        "where repeats tell it, a = (time since the first of them) + s·(poll before that)"
    ),
    source="uniform quantisation, Bennett 1948, in time; the phase is unknown in every recording",
    equation_of="timing",
    shows=("high_speed",),
    parameters=(
        Parameter(
            "refresh_period_s",
            "refresh_period",
            "s",
            NUMBER,
            (8e-3, 0.02, 0.05),
            0.0,
            0.5,
            hints=_refreshments_s,
            hinted_spread=0.01,
        ),
        # A host that polls in step with the device sees readings that are new, or a poll old.
        Parameter(
            "age_when_new", "age_when_new", "1", NUMBER, (0.5,), 0.0, 1.0, 1.0, otherwise=0.5, shared_out=True
        ),
    ),
    terms={"lag": _age, "scatter": _strayed},
    confusable_with={
        "command_delay": "quick steady turning tells: readings that are held scatter, a delay leaves them smooth",
        "clock_skew": "ages of a held reading are anywhere in a period; a clock's lag wanders slowly",
        "stale_samples": "every reading is held, by less than a period; single ones are stale",
    },
    fault=True,
)


_REPEATED = 0.5  # of the stale readings: as likely the last one again as one stamped late


def _stale_density(
    reading: float, predicted: float, last_reading: float, reading_std: float, stale_fraction: float
) -> float:
    low = min(last_reading, predicted)
    high = max(last_reading, predicted)
    width = high - low
    repeated = math.exp(-0.5 * ((reading - last_reading) / reading_std) ** 2)
    repeated /= reading_std * math.sqrt(2.0 * math.pi)
    if width < 0.1 * reading_std:
        return stale_fraction * repeated
    scale = reading_std * math.sqrt(2.0)
    inside = math.erf((reading - low) / scale) - math.erf((reading - high) / scale)
    late = 0.5 * inside / width
    return stale_fraction * (_REPEATED * repeated + (1.0 - _REPEATED) * late)


STALE_SAMPLES = Effect(
    id="stale_samples",
    name="stale samples",
    equation="with probability p a reading is the last one again, or was taken at any time since and stamped late",
    source="our own: a mixture likelihood, half at the last reading, half uniform from there to the prediction",
    equation_of="timing",
    shows=("after_gap",),
    parameters=(
        # How many of the readings that lie between count as late hangs on how late they are.
        Parameter("stale_fraction", "stale_fraction", "1", NUMBER, (0.02,), 1e-4, 0.7, frozen=True, law=0.1),
    ),
    terms={"outlier": _stale_density},
    fault=True,
    notable_most=0.55,  # where half of all readings are late, it is no few of them
)


def _pace(rate_error: float) -> float:
    return rate_error


def _lag(
    stamp_s: float,
    lag_span: float,
    lag_mean: float,
    lag_period: float,
    lag_phase: float,
    lag_rise: float,
    lag_straightness: float,
    second_share: float,
    second_period: float,
    second_phase: float,
    waves: float,
    late: float,
) -> float:
    turn = stamp_s / lag_period + lag_phase
    part = turn - math.floor(turn)
    fall = 1.0 - lag_rise
    half = 0.5 * part / fall if part < fall else 1.0 - 0.5 * (1.0 - part) / lag_rise
    rounded = math.cos(math.tau * half)
    straight = math.fabs(4.0 * half - 2.0) - 1.0
    wave = rounded + lag_straightness * (straight - rounded)
    second = math.cos(math.tau * (stamp_s / second_period + second_phase)) if second_share > 0.0 else 0.0
    return lag_span * (
        lag_mean + 0.5 * waves * (wave + second_share * (second - wave)) + (1.0 - waves) * late
    )


def _whole_rows(
    stamp_s: float,
    lag_span: float,
    lag_mean: float,
    lag_period: float,
    lag_phase: float,
    lag_rise: float,
    lag_straightness: float,
    second_share: float,
    second_period: float,
    second_phase: float,
    waves: float,
    of_commands: float,
    late: float,
) -> float:
    return of_commands * _lag(
        stamp_s,
        lag_span,
        lag_mean,
        lag_period,
        lag_phase,
        lag_rise,
        lag_straightness,
        second_share,
        second_period,
        second_phase,
        waves,
        late,
    )


def _strayed_lateness(speed: float, lag_span: float, waves: float, late_open: float) -> float:
    """The variance that neighbouring stamps leave to a row's lateness, times the speed squared."""
    strays = (1.0 - waves) * late_open * lag_span * speed
    return strays * strays


# A lag that wanders by no law, beside its slowest wave; without a share there is no second one to be fitted.
_SECOND_WAVE = (
    Parameter(
        "lag_second_share",
        "second_share",
        "1",
        NUMBER,
        (0.0,),
        0.0,
        0.8,
        otherwise=0.0,
        shapes=True,
        part_of="second_share",
    ),
    Parameter(
        "lag_second_period_s",
        "second_period",
        "s",
        NUMBER,
        (2.0,),
        0.5,
        300.0,
        otherwise=2.0,
        part_of="second_share",
    ),
    Parameter(
        "lag_second_phase",
        "second_phase",
        "1",
        NUMBER,
        (0.0,),
        -1.0,
        1.0,
        otherwise=0.0,
        shapes=True,
        part_of="second_share",
    ),
)

CLOCK_SKEW = Effect(
    id="clock_skew",
    name="clock skew",
    equation=(
        "stamp = (1 + ε)·(t + s·(m + ½·w(t))) for readings; for commands as well, or (1 + ε)·t; "
        "w(t) = (1 - q)·v(t/P + φ) + q·cos(2π·(t/P₂ + φ₂)); "
        "v from 1 to -1 and back in r of a turn, as a cosine (k = 0), by straight lines (k = 1) or between; "
        "with `lag_waves` 0, s·½·w is what a row is later than its neighbours tell, and what they leave open scatters"
    ),
    source=(
        "rate error as of Moon, Skelly and Towsley 1999. The waves are our own: sine, triangle, sawtooth, "
        "or what two of them make"
    ),
    equation_of="timing",
    shows=("high_speed", "elapsed_time"),
    notable=2e-3,  # a rate error alone is that of other parameters
    parameters=(
        Parameter("lag_span_s", "lag_span", "s", NUMBER, (0.03, 0.09), 0.0, 0.5, law=0.12),
        # A half for a wander between none and s. As the span found is off by the law's shape, so is half of it: held to
        # a half, the rest would be taken for a delay.
        Parameter(
            "lag_mean", "lag_mean", "1", NUMBER, (0.5,), 0.0, 1.0, spread=0.12, otherwise=0.5, shapes=True
        ),
        Parameter("rate_error", "rate_error", "1", NUMBER, (3e-3,), -0.1, 0.1, spread=2.0),
        Parameter(
            "lag_period_s",
            "lag_period",
            "s",
            NUMBER,
            (4.0, 2.0, 2.3, 2.6, 3.0, 3.4, 4.8, 5.8, 7.4, 10.0),
            0.5,
            300.0,
            otherwise=4.0,
            part_of="waves",
        ),
        Parameter(
            "lag_phase",
            "lag_phase",
            "1",
            NUMBER,
            (0.0, 1.0 / 3.0, -1.0 / 3.0),
            -1.0,
            1.0,
            otherwise=0.0,
            shapes=True,
            part_of="waves",
        ),
        Parameter(
            "lag_rise",
            "lag_rise",
            "1",
            NUMBER,
            (0.5,),
            0.001,
            0.999,
            otherwise=0.5,
            shapes=True,
            part_of="waves",
        ),
        Parameter(
            "lag_straightness",
            "lag_straightness",
            "1",
            NUMBER,
            (0.0,),
            0.0,
            1.0,
            otherwise=0.0,
            shapes=True,
            part_of="waves",
        ),
        *_SECOND_WAVE,
        # Where chance makes each row late, it wanders by none of these waves: neighbouring stamps tell by how much.
        Parameter("lag_waves", "waves", "1", NUMBER, (1.0,), 0.0, 1.0, otherwise=1.0, tried=True),
        # A logger stamps a command with its row, or when it was sent.
        Parameter("lag_of_commands", "of_commands", "1", NUMBER, (0.0,), 0.0, 1.0, otherwise=0.0, tried=True),
    ),
    terms={"pace": _pace, "lag": _lag, "commanded": _whole_rows, "scatter": _strayed_lateness},
    confusable_with={
        "command_delay": "a long recording tells: a delay stays, a lag wanders",
        "stale_samples": "steady turning tells: a stale reading stands still, a late one is behind by the same time",
    },
    fault=True,
)
