"""A load that bears a share of the friction: settled from several shares, round after round."""

from types import SimpleNamespace

import pytest
from diagnose_limits import shared_anew_with

from nxt_twin.diagnose.search.limits import EFFORT
from nxt_twin.physics.effects.transmission import BACKLASH, SHAFT_COMPLIANCE

OWN, LARGER = 5.0, 100.0  # the unknown torque of the trial, and of what lacks the effect


@pytest.mark.parametrize("effect", [BACKLASH, SHAFT_COMPLIANCE], ids=lambda each: each.id)
def test_a_second_body_is_settled_from_shares_on_either_side_of_the_usual_one(effect):
    tried = shared_anew_with(effect, gain=0.0).tried
    assert tried[:3] == [(0.0, OWN), (0.5, OWN), (0.25, LARGER)]


def test_where_no_share_is_likelier_a_motor_that_rubs_less_is_tried_under_hardly_any_unknown_torque():
    assert shared_anew_with(BACKLASH, gain=0.0).tried[3:] == [(0.5, pytest.approx(0.04), pytest.approx(2.0))]


@pytest.mark.parametrize(("gain", "tried"), [(5.1, 12), (4.9, 4)])
def test_shares_are_tried_anew_where_less_friction_is_likelier(gain, tried):
    found = shared_anew_with(BACKLASH, gain=0.0, slack_gain=gain)
    assert len(found.tried) == tried
    assert found.cost == pytest.approx(-gain * tried / 4)


@pytest.mark.parametrize(("gain", "rounds"), [(5.1, EFFORT.shares), (4.9, 1)])
def test_rounds_end_where_one_hardly_gains(gain, rounds):
    found = shared_anew_with(BACKLASH, gain=gain)
    assert len([one for one in found.tried if len(one) == 2]) == 3 * rounds
    assert found.cost == pytest.approx(-gain * rounds)


def test_the_better_end_is_kept_where_no_other_share_is_likelier():
    assert shared_anew_with(BACKLASH, gain=-3.0).cost == 0.0


def test_an_effect_without_such_a_share_is_left_as_it_is():
    effect = SimpleNamespace(id="other", parameters=BACKLASH.parameters[:2])
    assert shared_anew_with(effect, gain=9.0).tried == []
