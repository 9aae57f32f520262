"""Tables III to VI recomputed: what it takes to press and to release the touch sensor."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.paper import printed
from nxt_twin.paper.finding import Comparison, Contradiction, compare_printed, powers
from nxt_twin.paper.printed import TouchTable

TABLES = (printed.FORCE_ON, printed.FORCE_OFF, printed.TRAVEL_ON, printed.TRAVEL_OFF)


def means(table: TouchTable) -> FloatArray:
    """The mean of each sensor, shape (8,)."""
    found: FloatArray = np.mean(table.samples, axis=1)
    return found


def sensor_deviations(table: TouchTable) -> FloatArray:
    """The standard deviation of each sensor (over 8, as most of the printed ones are), shape (8,)."""
    found: FloatArray = np.std(table.samples, axis=1)
    return found


def compare_touch() -> list[Comparison]:
    """The means and deviations of all four tables."""
    listed = []
    for table in TABLES:
        where = f"Table {table.number}"
        for sensor, (mean, deviation) in enumerate(
            zip(means(table).tolist(), sensor_deviations(table).tolist(), strict=True)
        ):
            name = f"sensor {sensor + 1}"
            if table.means is not None and table.deviations is not None:
                shown = f"{table.means[sensor]:g}"
                listed.append(compare_printed(f"{name}, mean", where, table.unit, shown, mean))
                shown = f"{table.deviations[sensor]:g}"
                listed.append(
                    compare_printed(f"{name}, standard deviation", where, table.unit, shown, deviation)
                )
            elif printed.TRAVEL_VARYING[table.number] == sensor + 1:
                listed.append(
                    compare_printed(f"{name}, standard deviation", where, table.unit, "1.6e-3", deviation)
                )
            else:
                listed.append(
                    compare_printed(f"{name}, standard deviation", where, table.unit, "0", deviation)
                )
    return listed


def touch_contradictions() -> list[Contradiction]:
    """Where section III-B disagrees with itself."""
    return [_mean_of_sensor_2(), _variances(), _mean_of_sensor_7(), _travel()]


def _mean_of_sensor_2() -> Contradiction:
    row = printed.FORCE_ON.samples[1]
    spread = float(np.mean(np.abs(row - row.mean())))
    return Contradiction(
        id="table_3_sensor_2",
        title="Mean and deviation of touch sensor 2 are not those of its readings",
        where="Table III, sensor 2",
        claim="mean 62.6, standard deviation 0.38",
        evidence=f"its eight readings have mean {row.mean():.2f} and standard deviation {row.std():.3f}",
        cause=f"0.38 is their mean absolute deviation ({spread:.3f}); the mean fits five readings of 63 rather than six"
        f" ({(3 * 62 + 5 * 63) / 8:.3f})",
        used=f"{row.mean():.2f} ± {row.std():.2f} g, from the readings",
    )


def _variances() -> Contradiction:
    rows = printed.FORCE_OFF.samples[[2, 4, 5, 6]]
    shown = ", ".join(
        f"{n}: std {row.std():.3f}, variance {row.var():.3f}"
        for n, row in zip((3, 5, 6, 7), rows, strict=True)
    )
    return Contradiction(
        id="table_4_variances",
        title="Variances are printed as standard deviations",
        where="Table IV, sensors 3, 5, 6 and 7",
        claim="the last column is σ, with 0.11, 0.11, 0.11 and 0.44",
        evidence=f"recomputed by sensor, {shown}",
        cause="these are variances (Table III's column holds standard deviations): a square root was forgotten",
        used="the standard deviations of the readings",
    )


def _mean_of_sensor_7() -> Contradiction:
    row = printed.FORCE_OFF.samples[6]
    return Contradiction(
        id="table_4_sensor_7",
        title="A mean lies above every reading",
        where="Table IV, sensor 7",
        claim="mean 48.8",
        evidence=f"its readings lie between {row.min():.0f} and {row.max():.0f} and have mean {row.mean():.2f}",
        cause="a mean cannot lie above every reading; 47.8 with a digit slipped",
        used=f"{row.mean():.2f} g",
    )


def _travel() -> Contradiction:
    on, off = printed.TRAVEL_ON.samples[7], printed.TRAVEL_OFF.samples[5]
    return Contradiction(
        id="travel_deviation",
        title="The deviation of the travel is twenty times too small",
        where="III-B, Tables V and VI",
        claim="the travel varies only for sensor 8 (off to on) and sensor 6 (on to off), each with a standard"
        " deviation of 1.6E-3 mm",
        evidence=f"sensor 8 has {on.std():.4f} mm and sensor 6 {off.std():.4f} mm: about twenty times as much,"
        f" and unequal (their variances are {powers(on.var(), 2)} and {powers(off.var(), 2)} mm²)",
        cause="the printed number has the size of a variance, as in Table IV, but equals neither. The printed readings"
        " step by about 0.1 mm. A sensor that changes once in eight therefore deviates by at least 0.03 mm",
        used="the standard deviations of the readings",
    )
