"""Alarms on recordings of a simulator that shares nothing with the twin: seldom without cause, soon with one."""

from itertools import islice

import numpy as np
import pytest
from twin_feed import feed, nxt_motor, true_plant

from nxt_twin.blind.make import make_case
from nxt_twin.blind.polling import polls_s
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands
from nxt_twin.blind.truth.sensing import Sensing

SEEDS = range(7000, 7002)


@pytest.mark.slow_variants
@pytest.mark.parametrize("link", ["usb", "bluetooth"])
def test_no_alarm_where_nothing_is_missing(link):
    """Two minutes over both links, a random torque of 2 mN·m that no model has; docs/live.md has the long run."""
    for seed in SEEDS:
        case = make_case(seed, effects=(), duration_s=15.0, recordings=2, torque_noise_nm=2e-3, link=link)
        for recording in case.recordings:
            fed = feed(recording, true_plant(case))
            assert [event.words for event in fed.events if event.kind == "divergence"] == []


@pytest.mark.slow_variants
@pytest.mark.parametrize("effect", ["constant_load", "backlash", "payload_inertia"])
def test_most_concealed_effects_raise_the_alarm(effect):
    """In two motors of three; a third says no more once two have."""
    alarmed = (seed for seed in range(7100, 7103) if _alarms(effect, seed))
    assert len(list(islice(alarmed, 2))) == 2


def _alarms(effect, seed):
    case = make_case(seed, effects=(effect,), size="large", duration_s=6.0, recordings=2)
    return feed(case.recordings[1], true_plant(case)).first("divergence") is not None


def _pushed(seed, push_nm, from_s, to_s=1e9, *, seconds=14.0):
    rng = np.random.default_rng(seed)
    read_s = polls_s(rng, "usb", seconds)
    levels = np.array([50, -60, 35, -45, 70, -30, 55, -80])
    power = levels[(read_s / 1.1).astype(int) % levels.size].astype(float)
    push = np.where((read_s >= from_s) & (read_s < to_s), push_nm, 0.0)
    commands = Commands(read_s, power, np.zeros(read_s.size, dtype=np.int64), 0.3, 0.0, push)
    return take(rng, "pushed.csv", Motor(), Sensing(), commands).recording


@pytest.mark.parametrize("push_nm", [0.03, -0.05])
def test_the_onset_is_found_to_a_third_of_a_second(push_nm):
    offs, delays = [], []
    for seed in range(3):
        from_s = 6.0 + 0.31 * seed
        fed = feed(_pushed(seed, push_nm, from_s, seconds=from_s + 2.5), nxt_motor())
        event = fed.first("divergence")
        assert event is not None
        offs.append(abs(event.onset_s - from_s))
        delays.append(event.time_s - from_s)
    assert np.median(offs) < 0.3
    assert max(offs) < 0.6
    assert np.median(delays) < 0.6


def test_a_brief_push_is_told_as_such():
    fed = feed(_pushed(3, 0.15, 2.0, 2.25), nxt_motor())
    assert [event.kind for event in fed.events] == ["divergence", "slip", "calm"]
    assert fed.first("divergence").onset_s == pytest.approx(2.0, abs=0.3)
    assert not fed.monitor.diverging


def test_a_filter_that_began_wrong_finds_its_way():
    """An observer that starts with a wrong speed must not take every reading for a bad one."""
    recording = _pushed(1, 0.0, 99.0)
    half = type(recording)(
        recording.name, {name: values[500:] for name, values in recording.columns.items()}
    )  # begins at full speed, where the twin expects rest
    fed = feed(half, nxt_motor())
    angle_deg = fed.twin.state("a").angle_deg
    assert angle_deg == pytest.approx(half.columns["a_tacho_deg"][-1] + 0.5, abs=2.0)
    assert np.median(np.abs(fed.nats[200:])) < 1.0


def test_stale_readings_are_called_though_the_motion_is_the_models():
    """One reading in fourteen is the one before it: the torque fits, single counts do not."""
    rng = np.random.default_rng(4)
    read_s = polls_s(rng, "usb", 14.0)
    power = np.where((read_s / 1.1).astype(int) % 2, 60.0, -60.0)
    commands = Commands(read_s, power, np.zeros(read_s.size, dtype=np.int64), 0.3, 0.0, np.zeros(read_s.size))
    fresh, stale = (
        feed(take(np.random.default_rng(4), "run.csv", Motor(), Sensing(stale_fraction=share), commands).recording,
             nxt_motor())
        for share in (0.0, 0.07)
    )  # fmt: skip
    assert fresh.first("divergence") is None
    event = stale.first("divergence")
    assert "stale" in event.words
    assert event.onset_s < event.time_s < 10.0
    assert stale.monitor.diverging
