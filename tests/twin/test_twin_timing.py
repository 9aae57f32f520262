"""When the brick acted within a round trip, and what it does to the motion that this is not known well."""

import math

import numpy as np
import pytest
from twin_feed import nxt_motor
from twin_rig import Rig, run

from nxt_twin.twin.batch import Batch
from nxt_twin.twin.bridge import COAST, DRIVE, Hold
from nxt_twin.twin.history import History
from nxt_twin.twin.jerk import Drive
from nxt_twin.twin.settings import Pace
from nxt_twin.twin.timing import Stalls, Timing


def _settled(trip_s=0.003):
    timing = Timing(Pace(share=0.4, share_std=0.1))
    for n in range(200):
        timing.moment(0.01 * n, 0.01 * n + trip_s * (1.0 + 0.2 * (n % 3 - 1)))
    return timing


def test_an_ordinary_round_trip_is_dated_by_the_links_pace():
    moment = _settled().moment(5.0, 5.003)
    assert moment.at_s == pytest.approx(5.0012)
    assert moment.std_s == pytest.approx(0.0003)
    assert not moment.late
    assert moment.stall_s == 0.0


def test_a_long_one_says_only_that_it_was_somewhere_in_it():
    timing = _settled()
    slow = timing.moment(5.0, 5.009)
    assert slow.late
    assert slow.at_s == pytest.approx(5.0045)
    assert slow.std_s == pytest.approx(0.009 / np.sqrt(12.0))
    assert slow.stall_s == 0.0
    assert timing.moment(6.0, 6.103).stall_s == pytest.approx(0.1, abs=2e-3)


def test_what_is_usual_follows_a_link_that_became_slower():
    timing = _settled()
    for n in range(300):
        last = timing.moment(10.0 + 0.05 * n, 10.03 + 0.05 * n)
    assert not last.late
    assert timing.usual_s == pytest.approx(0.03, rel=0.1)


def test_stalls_are_told_in_words():
    stalls = Stalls()
    assert stalls.words() == ""
    stalls.add(0.05)
    assert "once" in stalls.words()
    stalls.add(0.2)
    assert stalls.words() == "the host or the link stood still 2 times, for 200 ms at most"


@pytest.mark.parametrize("after_s", [0.005, 0.03, 0.1])
def test_a_command_that_came_late_moves_the_motor_by_what_is_foretold(after_s):
    """Beside the compiled plant, to which the same command is given 4 ms later."""
    late_s, at_s = 0.004, 0.5
    plant = nxt_motor().without({"coulomb_friction", "viscous_friction", "inductance"})
    batch = Batch([plant, plant], ["a", "b"], [0.0, 0.0], 0.1)
    for port, when_s in (("a", at_s), ("b", at_s + late_s)):
        batch.command(port, 0.0, (Hold(0.0, 0.6, DRIVE),))
        batch.command(port, when_s, (Hold(0.0, -0.6, DRIVE),))
    batch.advance(at_s, 8.0)
    speed = float(batch.state[0, 1])
    batch.advance(at_s + late_s + after_s, 8.0)
    gone = batch.state[1, :2] - batch.state[0, :2]
    jerk = Drive(plant).jerk(at_s, late_s, Hold(0.0, 0.6, DRIVE), Hold(0.0, -0.6, DRIVE), speed, 8.0)
    spread = jerk.spread(0.5 * late_s + after_s)
    np.testing.assert_allclose(np.sqrt(np.diag(spread)), np.abs(gone), rtol=0.12)


def test_what_follows_a_badly_dated_command_is_not_tied_to_what_was_before():
    history = History("a")
    history.command(0.0, (Hold(0.0, 0.5, DRIVE),))
    for n in range(1001):
        history.count(0.01 * n, n)
    assert history.seconds_since(0.0) == pytest.approx(10.0)
    history.part(2.5)
    assert history.seconds_since(0.0) == pytest.approx(7.5)
    assert history.recording(0.0, lambda _: 8.0).time_s[0] == pytest.approx(2.5)
    for at_s in (4.0, 5.5, 7.0, 8.5):
        history.part(at_s)
    assert history.seconds_since(0.0) == pytest.approx(5.0)  # in many parts: half of it counts
    assert history.recording(0.0, lambda _: 8.0).time_s[0] == pytest.approx(0.0)


def test_a_host_that_stalls_is_said_to_and_is_no_divergence():
    stalls_s = (3.0, 3.5, 5.2, 6.9, 8.0, 9.5)
    outcome = run(Rig(stalls_s=stalls_s), 10.0)
    assert outcome.session.stalls.count == len(stalls_s)
    assert set(outcome.kinds()) == {"started", "stalled", "stopped"}
    assert "stood still 6 times" in outcome.first("stopped").words
    assert not outcome.session.monitors["a"].diverging


def test_a_badly_dated_coast_leaves_the_angle_in_doubt_for_longer_than_a_badly_dated_drive():
    plant = nxt_motor()
    before, speed, supply_v = Hold(0.0, 0.65, DRIVE), 9.8, 8.0
    coast, drive = (
        Drive(plant).jerk(0.0, 0.076, before, Hold(0.0, 0.0, mode), speed, supply_v).spread(0.33)
        for mode in (COAST, DRIVE)
    )
    assert math.degrees(math.sqrt(coast[0, 0])) > 20.0
    assert coast[1, 1] > drive[1, 1]
