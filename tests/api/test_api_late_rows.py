"""A prediction over rows that are stamped late by chance: the plant's clock says so."""

import numpy as np

import nxt_twin as nt
from nxt_twin.physics.effects.timing import CLOCK_SKEW

USUAL = {p.symbol: p.starts[0] * p.si for p in CLOCK_SKEW.parameters}
LATE = USUAL | {"lag_span": 0.03, "lag_mean": 0.5, "rate_error": 0.0, "waves": 0.0, "of_commands": 1.0}


def root_mean_square(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_rows_that_are_late_by_chance_are_predicted_for_when_they_were_taken():
    rng = np.random.default_rng(3)
    taken_s = 0.02 * np.arange(500)
    power_pct = np.where(taken_s % 2.0 < 1.0, 60.0, -40.0)
    stamps_s = np.maximum.accumulate(taken_s + rng.uniform(0.0, 0.03, taken_s.size))
    plant = nt.load_plant("nxt_motor", "power_pct")
    clock = plant.with_effect("clock_skew", LATE)
    true, late = (
        nt.Recording("run", {"time_s": each, "a_power_pct": power_pct}) for each in (taken_s, stamps_s)
    )
    wanted, plain, found = (
        nt.simulate(by, run).columns["a_tacho_deg"]
        for by, run in ((plant, true), (plant, late), (clock, late))
    )
    assert root_mean_square(found - wanted) < 0.5 * root_mean_square(plain - wanted)
