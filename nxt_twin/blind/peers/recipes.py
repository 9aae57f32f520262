"""The methods, each by its recipe: from a regression to the effects that it names."""

from __future__ import annotations

import warnings
from typing import Final

import numpy as np
from scipy import stats

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.blind.peers.regression import Regression

LEVEL: Final = 0.05
THRESHOLDS: Final = (0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3)
REGIMES: Final = 3
CLEAN_SHARE: Final = 0.6
LAGS: Final = 12


def sindy(case: Regression) -> tuple[str, ...]:
    """PySINDy on the discrepancy (Kaheman and others, 2019): the plain model's residual, thresholded least squares.

    The threshold is the highest whose error on the half seconds that were not fitted is within one standard error of
    the least.
    """
    from pysindy import STLSQ

    names, theta = _stacked(case)
    target, theta = case.without_base(case.acceleration), case.without_base(theta)
    theta = theta / (np.linalg.norm(theta, axis=0) / np.sqrt(len(theta)) + 1e-12)
    target = target / (float(np.std(target)) + 1e-12)
    even = case.part % 2 == 0.0
    tried = []
    for threshold in THRESHOLDS:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", UserWarning
            )  # it warns where it keeps no term, which is an answer here
            fitted = STLSQ(threshold=threshold, alpha=1e-3).fit(theta[even], target[even, None])
        weights = np.asarray(fitted.coef_).ravel()
        tried.append(((target[~even] - theta[~even] @ weights) ** 2, weights))
    best = min(tried, key=lambda pair: float(np.mean(pair[0])))[0]
    allowed = float(np.mean(best)) + np.sqrt(_long_run(best) / best.size)
    weights = next(weights for misses, weights in reversed(tried) if float(np.mean(misses)) <= allowed)
    return tuple(sorted({name for name, weight in zip(names, weights, strict=True) if weight != 0.0}))


def freed(case: Regression) -> tuple[str, ...]:
    """Everything freed at once, as toolboxes for parameters do: what differs from zero at 95 %."""
    names, theta = _stacked(case)
    every = np.column_stack([case.base, theta])
    weights, *_ = np.linalg.lstsq(every, case.acceleration, rcond=None)
    miss = case.acceleration - every @ weights
    spread = np.sqrt(np.clip(np.diag(np.linalg.pinv(every.T @ every)), 0.0, None) * _long_run(miss))
    sure = np.abs(weights) > stats.norm.ppf(1.0 - LEVEL / 2.0) * spread
    kept = sure[case.base.shape[1] :]
    return tuple(sorted({name for name, one in zip(names, kept, strict=True) if one}))


def lisdd(case: Regression) -> tuple[str, ...]:
    """Localised sparse discovery (arXiv 2606.23215), from its abstract: there is no published code.

    It fits the plain model on the quieter regimes and flags the loud ones. In each it chooses a candidate on
    one half of the data, and confirms it by an F test on the other. It controls false discoveries over
    regimes.
    """
    return tuple(sorted({name for name, _ in _confirmed_cells(case)}))


def lisdd_cells(case: Regression) -> frozenset[int]:
    """The regimes in which `lisdd` confirms that something is missing."""
    return frozenset(cell for _, cell in _confirmed_cells(case))


def _confirmed_cells(case: Regression) -> list[tuple[str, int]]:
    """What is missing and the regime in which it is confirmed, false discoveries controlled."""
    regime = cells_of(case)
    clean = _quiet(case, regime)
    weights, *_ = np.linalg.lstsq(case.base[clean], case.acceleration[clean], rcond=None)
    miss = case.acceleration - case.base @ weights
    chosen = case.part % 2 == 0.0
    floor = _long_run(miss[clean]) / max(float(np.var(miss[clean])), 1e-12)
    tests = []
    for one in np.unique(regime):
        rows = regime == one
        independent = max(rows.sum() / max(floor, 1.0), 4.0)
        louder = float(np.mean(miss[rows] ** 2)) / max(float(np.mean(miss[clean] ** 2)), 1e-12)
        if stats.f.sf(louder, independent, independent) < LEVEL:
            name = _chosen(case, miss, rows & chosen)
            p_value = _confirmed(case, miss, rows & ~chosen, name, floor)
            tests.append((p_value, (name[0], int(one))))
    return _controlled(tests)


def _stacked(case: Regression) -> tuple[list[str], FloatArray]:
    names = [effect for (effect, _), columns in case.candidates.items() for _ in range(columns.shape[1])]
    return names, np.column_stack(list(case.candidates.values()))


def _long_run(miss: FloatArray) -> float:
    """Variance of a mean times the number of rows, neighbours counted (Bartlett's window)."""
    centred = miss - miss.mean()
    shares = [float(np.mean(centred[lag:] * centred[: centred.size - lag])) for lag in range(LAGS)]
    return max(shares[0] + 2.0 * sum((1.0 - lag / LAGS) * shares[lag] for lag in range(1, LAGS)), 1e-12)


def cells_of(case: Regression) -> FloatArray:
    """The cell of speed and volts, by thirds of each, in which each row lies, shape (rows,)."""
    cells = [
        np.searchsorted(np.quantile(values, np.linspace(0.0, 1.0, REGIMES + 1)[1:-1]), values)
        for values in (case.speed, case.volts)
    ]
    return np.asarray(REGIMES * cells[0] + cells[1], dtype=np.float64)


def _quiet(case: Regression, regime: FloatArray) -> BoolArray:
    """Rows of the regimes in which a fit on everything leaves the least."""
    miss = case.without_base(case.acceleration)
    energy = {one: float(np.mean(miss[regime == one] ** 2)) for one in np.unique(regime)}
    kept = sorted(energy, key=lambda one: energy[one])[: max(1, int(CLEAN_SHARE * len(energy)))]
    return np.isin(regime, kept)


def _chosen(case: Regression, miss: FloatArray, rows: BoolArray) -> tuple[str, int]:
    """The candidate that explains most of what is missing in these rows."""

    def left(key: tuple[str, int]) -> float:
        columns = case.candidates[key][rows]
        weights, *_ = np.linalg.lstsq(columns, miss[rows], rcond=None)
        return float(np.sum((miss[rows] - columns @ weights) ** 2))

    return min(case.candidates, key=left)


def _confirmed(
    case: Regression, miss: FloatArray, rows: BoolArray, key: tuple[str, int], floor: float
) -> float:
    """The p-value of the F test for a candidate on rows that did not choose it, neighbours counted."""
    columns, target = case.candidates[key][rows], miss[rows]
    weights, *_ = np.linalg.lstsq(columns, target, rcond=None)
    without, left = float(target @ target), float(np.sum((target - columns @ weights) ** 2))
    free = max(rows.sum() / max(floor, 1.0) - columns.shape[1], 2.0)
    return float(
        stats.f.sf((without - left) / columns.shape[1] / max(left / free, 1e-12), columns.shape[1], free)
    )


def _controlled(tests: list[tuple[float, tuple[str, int]]]) -> list[tuple[str, int]]:
    """Names and regimes that stand with false discoveries below the level (Benjamini and Hochberg)."""
    ranked = sorted(tests)
    passed = [rank for rank, (p, _) in enumerate(ranked, start=1) if p <= LEVEL * rank / len(ranked)]
    return [found for _, found in ranked[: max(passed, default=0)]]
