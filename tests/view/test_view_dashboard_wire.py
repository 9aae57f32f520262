"""Polls and events survive the way to the dashboard's process."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from view_ticks import some_events, some_ticks

from nxt_twin.twin.records import Innovation, MotorBelief, Tick
from nxt_twin.view.dashboard.job import DashboardJob, job_of
from nxt_twin.view.dashboard.scene import DrawnShape, Scenery, WorldMoment, coarse
from nxt_twin.view.dashboard.wire import line_of, read


def test_polls_come_back_as_they_were():
    for tick in some_ticks(60):
        line = line_of(tick)
        assert line.endswith(b"\n")
        assert line.count(b"\n") == 1
        assert read(line) == tick


def test_events_and_losses_come_back():
    for event in some_events():
        assert read(line_of(event)) == event
    assert read(line_of(17)) == 17


def test_what_is_not_finite_and_read_only_mappings_are_carried_too():
    effects = MappingProxyType({"nothing": 1.0})
    motor = MotorBelief("b", 0.0, "coast", float("inf"), float("-inf"), 0.0, 0.0, 0.0, effects)
    back = read(line_of(Tick(3, 1.0, 1.1, (motor,), (), link_up=False)))
    assert isinstance(back, Tick)
    assert back.motors == (motor,)
    assert back.link_up is False


def test_numbers_of_numpy_are_carried_as_plain_ones():
    reading = Innovation(np.float64(1.0), "a_tacho_deg", "deg", np.int64(7), np.float32(6.5), 1.0, np.True_)
    back = read(line_of(Tick(np.int64(2), 0.9, 1.0, (), (reading,))))
    assert back == Tick(2, 0.9, 1.0, (), (Innovation(1.0, "a_tacho_deg", "deg", 7, 6.5, 1.0),))


def test_words_with_line_breaks_stay_on_one_line():
    event = some_events()[0]
    told = type(event)(1.0, "stopped", "first\nsecond, with ü")
    assert read(line_of(told)) == told
    assert line_of(told).count(b"\n") == 1


def test_a_robots_world_comes_back():
    hub = DrawnShape("cylinder", (0.028, 0.026), (0.0, 0.0, 0.0), (1.57, 0.0, 0.0), (0.1, 0.1, 0.1, 1.0))
    scenery = Scenery((2.0, 1.0), coarse(np.array([[0.0, 1.0], [0.5, 0.2]])), (("robot/left", (hub,)),))
    assert scenery.shades == ((0, 255), (128, 51))
    assert read(line_of(scenery)) == scenery
    frame = (0.1, 0.2, 0.03, 0.0, 0.0, 0.0, 1.0)
    for ghost in (None, (0.1, 0.25, 1.5)):
        moment = WorldMoment(2.5, (frame,), ((0.0, 0.0, 0.1, 0.8, 0.0, 0.1),), ghost, 2)
        assert read(line_of(moment)) == moment


def test_a_large_floor_is_made_coarse():
    shades = coarse(np.tile(np.linspace(0.0, 1.0, 1000)[:, None], (1, 700)))
    assert max(len(shades), len(shades[0])) <= 160
    assert shades[0][0] == 0
    assert shades[-1][0] > 245


def test_a_line_of_another_kind_is_refused():
    with pytest.raises(ValueError, match="unknown kind"):
        read(b'["?", 1]\n')


def test_a_job_comes_back_from_its_command():
    job = DashboardJob(
        "web", "a title", ("a", "c"), ("s1_light_raw",), data_port=1, page_port=2, parts_port=3, tab=1
    )
    assert job_of(job.command()[-1]) == job
