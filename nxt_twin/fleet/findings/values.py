"""The findings of a fleet, each with its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

LEVEL: Final = 0.05
"""Of what is called sure, at most this share is false on average."""
UNKNOWN: Final = "unknown"
"""Stands for physics that no known effect accounts for, in the place of an effect's id."""


@final
@dataclass(frozen=True)
class Lack:
    """An effect that a unit's model leaves out.

    Attributes:
        unit: whose.
        effect: its id, or `UNKNOWN`.
        found: sessions in which it was found.
        sessions: of the unit, all that have an answer.
        parameter: the effect's first one, with its unit's suffix; empty for what is unknown.
        value: of that parameter, combined over the sessions that found it.
        std: of that value.
        q: the false discovery rate at which this finding is called sure.
    """

    unit: str
    effect: str
    found: int
    sessions: int
    parameter: str
    value: float
    std: float
    q: float


@final
@dataclass(frozen=True)
class EffectShare:
    """Of how many units an effect was found in.

    Attributes:
        effect: its id, or `UNKNOWN`.
        found: units with a session in which it was found.
        sure: those of them in which it is sure.
        units: all.
        low_95, high_95: Wilson's interval for the share of units in which it is found.
    """

    effect: str
    found: int
    sure: int
    units: int
    low_95: float
    high_95: float


@final
@dataclass(frozen=True)
class UnitDrift:
    """A parameter of a unit that changes from session to session.

    Attributes:
        per: what the slope is per: `day` where all sessions are dated, else `session`.
        at: when its sessions were, in that unit from the first on, shape of `values`.
        values: the parameter's values in that order.
        stds: their standard deviations.
    """

    unit: str
    parameter: str
    slope: float
    slope_std: float
    per: str
    at: tuple[float, ...]
    values: tuple[float, ...]
    stds: tuple[float, ...]
    q: float


@final
@dataclass(frozen=True)
class Common:
    """An effect or a parameter in which a batch differs from all others.

    Attributes:
        of: an effect's id or a parameter's name.
        kind: which of the two.
        inside: share of the batch's units with the effect, or the median of its units' values.
        outside: likewise of all other units.
        units: of the batch.
    """

    batch: str
    of: str
    kind: Literal["effect", "parameter"]
    inside: float
    outside: float
    units: int
    q: float


@final
@dataclass(frozen=True)
class Outlier:
    """A unit's parameter that is far from the fleet's.

    Attributes:
        value, std: of the unit, all sessions together.
        median, spread: of the fleet; the spread is a standard deviation, estimated from the median deviation.
        source: of the unit's first recording.
        typical: the unit nearest to the fleet's median, to compare with, and the source of its first recording.
    """

    unit: str
    parameter: str
    value: float
    std: float
    median: float
    spread: float
    q: float
    source: str
    typical: tuple[str, str]


@final
@dataclass(frozen=True)
class Failed:
    """A session without an answer."""

    unit: str
    session: str
    error: str


@final
@dataclass(frozen=True)
class FleetParameter:
    """A parameter over the fleet: values of its units, shape (units,), in `unit`, and the median."""

    name: str
    unit: str
    values: tuple[float, ...]
    median: float


@final
@dataclass(frozen=True)
class Findings:
    """All that a fleet's table says. Each list begins with what is surest and holds only what is sure at `LEVEL`.

    Attributes:
        sessions: rows of the table.
        units: with an answer.
        verdicts: sessions by verdict.
        possible: findings of effects in units that are not sure.
    """

    sessions: int
    units: int
    verdicts: dict[str, int]
    shares: tuple[EffectShare, ...]
    lacks: tuple[Lack, ...]
    possible: int
    drifts: tuple[UnitDrift, ...]
    commons: tuple[Common, ...]
    outliers: tuple[Outlier, ...]
    parameters: tuple[FleetParameter, ...]
    failed: tuple[Failed, ...]
