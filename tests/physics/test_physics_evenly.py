"""Rows with rounded stamps go to the moments of an even course, their commands with them, where readings agree."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import commanded

from nxt_twin.physics.evenly import evenly_read

STEP_S = 0.005


def recorded(read_s, stamps_s):
    run = commanded(
        [(float(t), float(n % 7) / 7.0) for n, t in enumerate(stamps_s)], seconds=20.0, stamps=stamps_s
    )
    angle = 3.0 * np.sin(2.0 * read_s) + 2.0 * read_s
    return replace(run, measured=np.round(angle / 0.01745) * 0.01745, quantum=0.01745)


def polls():
    return np.cumsum(0.0123 + 1e-4 * np.random.default_rng(3).standard_normal(1200))


def test_rounded_rows_are_put_where_they_were_read_with_their_commands():
    read_s = polls()
    found = evenly_read(recorded(read_s, np.round(read_s / STEP_S) * STEP_S))
    assert np.std(found.time_s - read_s) < 6e-4
    assert found.command_time_s == pytest.approx(found.time_s, abs=1e-6)
    assert found.rounded_s == pytest.approx(STEP_S)
    assert 0.0 < np.mean(found.open_s) < 1e-3
    assert found.command_open_s == pytest.approx(found.open_s)


def test_a_device_that_read_in_such_steps_keeps_its_stamps():
    stamps_s = np.round(polls() / STEP_S) * STEP_S
    signals = recorded(stamps_s, stamps_s)
    assert evenly_read(signals) is signals


def test_fine_stamps_and_clumps_stay_as_they_are():
    fine = recorded(polls(), polls())
    assert evenly_read(fine) is fine
    clumped = replace(recorded(polls(), np.round(polls() / STEP_S) * STEP_S), clump_rows=2.0)
    assert evenly_read(clumped) is clumped


def test_commands_without_readings_keep_their_stamps():
    signals = recorded(polls(), np.round(polls() / STEP_S) * STEP_S)
    unread = replace(signals, measured=np.full(signals.time_s.size, np.nan))
    assert evenly_read(unread) is unread
