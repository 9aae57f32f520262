"""What every kernel does whatever effects it holds, as plain Python."""

import math

import numpy as np
import pytest

from nxt_twin.physics.frame import believed, free_speed, latest, log_scales, scattered, schedule, slowed


def spans(target_s, command_time_s, *, load_time_s=(), delay_s=0.0, pace=1.0, step_max_s=0.01):
    loads = np.array(load_time_s, dtype=float)
    commands = np.array(command_time_s, dtype=float)
    most = len(target_s) + commands.size + loads.size
    into = np.full((most, 8), np.nan), np.zeros((most, 2), np.int64), np.zeros(len(target_s) + 1, np.int64)
    told = (
        commands,
        np.arange(1.0, 1.0 + commands.size),
        np.arange(commands.size),
        np.full(commands.size, 8.0),
    )
    others = loads, np.column_stack([np.full(loads.size, 0.5), np.full(loads.size, 3.0)])
    schedule(np.array(target_s), told, others, (delay_s, pace, step_max_s, 2.0), into)
    span, steps, first = into
    return span[: first[-1]], steps[: first[-1]], first


def test_spans_end_where_a_command_or_a_load_changes_and_fill_the_time_between_rows():
    span, steps, first = spans([0.0, 0.03, 0.05], [0.0, 0.012], load_time_s=[0.04])
    assert first.tolist() == [0, 0, 2, 4]
    lengths = span[:, 0] * steps[:, 0]
    assert lengths == pytest.approx([0.012, 0.018, 0.01, 0.01])
    assert np.all(span[:, 0] <= 0.01 + 1e-9)
    assert span[:, 4].tolist() == [1.0, 2.0, 2.0, 2.0]
    assert steps[:, 1].tolist() == [0, 1, 1, 1]
    assert span[:, 6].tolist() == [0.0, 0.0, 0.0, 0.5]
    assert span[:, 3] == pytest.approx([0.0, 0.012, 0.03, 0.04])


def test_a_delay_moves_commands_and_a_pace_shortens_steps():
    span, steps, _ = spans([0.0, 0.03], [0.0, 0.012], delay_s=0.005, pace=1.25)
    assert (span[:, 0] * steps[:, 0]).tolist() == pytest.approx([0.005, 0.012, 0.013])
    assert np.isnan(span[0, 4])
    assert span[1:, 4].tolist() == [1.0, 2.0]
    assert span[:, 1] == pytest.approx(span[:, 0] / 1.25)
    assert span[:, 2] == pytest.approx(np.exp(-2.0 * span[:, 1]))


def test_the_latest_is_the_last_that_is_not_later():
    assert [latest(np.array([0.0, 1.0, 1.0, 2.0]), -1, 0.5, t) for t in (0.0, 0.5, 1.5, 9.0)] == [-1, 0, 2, 3]


def test_dry_friction_stops_a_plant_and_holds_it_but_never_turns_it_by_itself():
    assert slowed(1.0, 0.9, 1.0, 0.2) == pytest.approx(0.7)
    assert slowed(-1.0, -0.9, -1.0, 0.2) == pytest.approx(-0.7)
    assert slowed(0.1, 0.05, 1.0, 0.2) == 0.0
    assert slowed(0.0, 0.15, 1.0, 0.2) == 0.0
    assert slowed(0.1, -1.0, 1.0, 0.2) < 0.0  # a strong push back, and the rest of the step to follow it


def test_without_friction_the_trapezoidal_rule_holds():
    inertia, damping, pull, step_s, before = 1e-3, 2e-3, 0.01, 0.02, 3.0
    momentum = 2.0 * inertia / step_s
    after = free_speed(momentum - damping, before, pull, 1.0 / (momentum + damping))
    assert inertia * (after - before) / step_s == pytest.approx(pull - damping * 0.5 * (before + after))


def test_a_reading_is_believed_by_its_share_of_the_density():
    scale = log_scales(np.array([[0.0, 0.5]]))[0]
    assert scale[0] == 0.0
    normal = math.exp(-0.5 * 1.2**2) / (0.5 * math.sqrt(2.0 * math.pi))
    assert believed(1.2, scale[1], 1.0, 0.0) == pytest.approx((1.0, -math.log(normal)))
    fresh, cost = believed(1.2, scale[1], 0.9, 0.02)
    assert fresh == pytest.approx(0.9 * normal / (0.9 * normal + 0.02))
    assert cost == pytest.approx(-math.log(0.9 * normal + 0.02))


def test_scatter_widens_a_reading():
    trust, std, log_scale = scattered(0.3, 0.1, 0.16)
    assert std == pytest.approx(0.5)
    assert trust == pytest.approx(0.09 / 0.25)
    assert log_scale == pytest.approx(0.1 + math.log(0.5 / 0.3))
