"""A sensor for the search: its items, its parameters, and the likelihood of each item.

Items are independent of one another, given the model: an item is a reading, or a stroke of a touch sensor. The values
of a structure are one flat mapping from field to number. Numbers of a single run, such as its room light and the
phase of the mains, are further fields named `field@run`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import Estimate
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.runs import SensorRun
from nxt_twin.sensors.fitting import Free

Values = Mapping[str, float]
Mask = BoolArray

_BLOCKS = 40  # to a recording, at least, before blocks hold more than one item
_LONGEST_BLOCK = 2  # items
_PERIOD = 5  # blocks after which the pattern of fit, check and held-out begins anew
_HELD_OUT_BLOCK = 2  # place in the pattern, from 0, of the block that is held out
_CHECK_BLOCK = 4  # place in the pattern, from 0, of the block that checks


class SensorProblem(Protocol):
    """A sensor case made ready."""

    @property
    def runs(self) -> tuple[SensorRun, ...]:
        """The recordings."""

    @property
    def channel(self) -> str:
        """The sensor's column."""

    @property
    def unit(self) -> str:
        """Of its readings."""

    @property
    def truth(self) -> str:
        """The rig's column that it is held against."""

    @property
    def effects(self) -> tuple[SensorEffect, ...]:
        """The effects that these recordings could show."""

    @property
    def item_run(self) -> IntArray:
        """The run of each item, shape (items,)."""

    @property
    def item_time_s(self) -> FloatArray:
        """The stamp of each item, shape (items,)."""

    @property
    def covariates(self) -> Mapping[str, FloatArray]:
        """By name, quantities that what is left may depend on; shape (items,) each."""

    @property
    def untouched(self) -> frozenset[str]:
        """Those of them along which no effect of this sensor acts."""

    @property
    def regimes(self) -> Mapping[str, Mask]:
        """By name, the items in which an effect may gather."""

    def base(self) -> Sequence[Free]:
        """The ideal sensor's own parameters."""

    def base_start(self) -> Values:
        """Where their fit begins, and the values of all that is fixed."""

    def free(self, effect: SensorEffect) -> Sequence[Free]:
        """The parameters that are fitted with the effect in."""

    def starts(self, effect: SensorEffect, values: Values) -> Sequence[Values]:
        """Values of the effect's parameters from which to begin, taken from the data."""

    def off(self, effect: SensorEffect) -> Values:
        """The values that switch the effect off."""

    def run_bound(self, run: int) -> frozenset[str]:
        """The fields that belong to one run and are unknown for a new one."""

    def log_each(self, values: Values) -> FloatArray:
        """The logarithm of each item's probability, nats, shape (items,)."""

    def log_prior(self, values: Values) -> float:
        """The logarithm of the weak prior, nats."""

    def scores(self, values: Values, rng: Generator) -> FloatArray:
        """Residuals that are standard normal if the model is right, shape (items,); NaN where there is none."""

    def predict(self, values: Values, run: int) -> FloatArray:
        """The expected reading at each row of a run, in `unit`."""

    def draw(self, values: Values, run: int, rng: Generator) -> FloatArray:
        """Readings of a run drawn from the model, in `unit`."""

    def rows_of_items(self, run: int, chosen: Mask) -> Mask:
        """Which rows of a run belong to the chosen items."""

    def estimates(
        self, effect: SensorEffect, values: Values, names: Sequence[str], covariance: FloatArray
    ) -> dict[str, Estimate]:
        """The effect's parameters as a diagnosis reports them."""

    def to_config(self, values: Values, active: frozenset[str]) -> dict[str, Any]:
        """The sensor as YAML-ready keys."""


@final
@dataclass(frozen=True)
class ItemSplit:
    """Which items are fitted, which only check a choice, and which are held out; they do not overlap."""

    fit: Mask
    check: Mask
    held_out: Mask

    @property
    def known(self) -> Mask:
        """Everything that is not held out."""
        return ~self.held_out


def split_of(problem: SensorProblem) -> ItemSplit:
    """Hold out what the case says; else blocks of items all over the recordings, and others to check with.

    The blocks are short, so that a narrow range of the truth has its share of each kind.
    """
    count = problem.item_run.size
    held_out, check = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    named = any(run.held_out for run in problem.runs)
    for index, run in enumerate(problem.runs):
        items = np.flatnonzero(problem.item_run == index)
        if run.held_out:
            held_out[items] = True
            continue
        block = np.arange(items.size) // min(max(1, items.size // _BLOCKS), _LONGEST_BLOCK) % _PERIOD
        check[items[block == _CHECK_BLOCK]] = True
        if not named:
            held_out[items[block == _HELD_OUT_BLOCK]] = True
    return ItemSplit(~(held_out | check), check, held_out)


def standard_errors(names: Sequence[str], covariance: FloatArray) -> dict[str, float]:
    """The standard deviation of each fitted value."""
    return {name: float(std) for name, std in zip(names, np.sqrt(np.diag(covariance)), strict=True)}


def plain_estimates(
    effect: SensorEffect, values: Values, names: Sequence[str], covariance: FloatArray
) -> dict[str, Estimate]:
    """The effect's parameters under their names in JSON."""
    stds = standard_errors(names, covariance)
    return {
        part.name: Estimate(values[part.field], stds.get(part.field, 0.0), part.unit)
        for part in effect.parameters
    }


def free_of(effect: SensorEffect) -> list[Free]:
    """The effect's parameters as the fit takes them."""
    return [Free(part.field, part.lower, part.upper, part.scale) for part in effect.parameters]
