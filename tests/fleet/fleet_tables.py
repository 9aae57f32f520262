"""Fleets' tables without a diagnosis: rows as the engine would write them, drawn from known fleets."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from nxt_twin.fleet.finding.labels import Labels
from nxt_twin.fleet.row import SCHEMA, completed


def estimate(value, std, unit="N·m"):
    return {"value": value, "std": std, "own_std": std, "unit": unit}


def effect(name, parameter, value, std):
    return {"id": name, "probability": 1.0, "parameters": [{"name": parameter, **estimate(value, std)}]}


def answer(inertia, effects=(), verdict=None, std=1e-5):
    return {
        "verdict": verdict or ("explained" if effects else "adequate"),
        "false_alarm_rate": 0.015,
        "tried": 30,
        "parameters": [
            {"name": "inertia_kg_m2", "given": 1.2e-3, **estimate(inertia, std, "kg·m²")},
            {"name": "coulomb_friction_nm", "given": 8e-3, **estimate(8.4e-3, 1e-4)},
        ],
        "effects": list(effects),
    }


def write_table(path, rows):
    """Rows by (unit, session, batch)."""
    whole = [
        completed(row, Labels(unit, session, batch), f"{unit}/{session}.csv", unit + session, "1")
        for (unit, session, batch), row in rows.items()
    ]
    pq.write_table(pa.Table.from_pylist(whole, SCHEMA), path)
    return path


def plain_fleet(units=40, sessions=3, seed=0):
    """Units of two batches that lack nothing and differ by chance alone."""
    random = np.random.default_rng(seed)
    rows = {}
    for number in range(units):
        own = 1.2e-3 + 2e-5 * random.standard_normal()
        for day in range(1, sessions + 1):
            key = (f"U{number:03}", f"2026-03-{day:02}", f"B{number % 2}")
            rows[key] = answer(own + 1e-5 * random.standard_normal())
    return rows


def changed_fleet():
    """A plain one in which a batch has play, a unit drifts, one stands out, one is broken, and one alarm is false."""
    rows = plain_fleet()
    for unit, session, batch in list(rows):
        key, number, day = (unit, session, batch), int(unit[1:]), int(session[-2:])
        inertia = rows[key]["parameters"][0]["value"]
        if number < 16 and batch == "B0":
            rows[key] = answer(inertia, [effect("backlash", "gap_deg", 4.0, 0.1)])
        if number == 13:
            rows[key] = answer(1.2e-3 + 8e-5 * day)
        if number == 15:
            rows[key] = answer(2.4e-3)
        if number == 17 and day == 1:
            rows[key] = answer(inertia, [effect("cogging", "cogging_torque_nm", 2e-3, 8e-4)])
        if number == 19:
            rows[key] = answer(inertia, verdict="unexplained")
    rows["U999", "2026-03-01", "B0"] = {"failure": "recording", "error": "run.csv: is empty"}
    return rows
