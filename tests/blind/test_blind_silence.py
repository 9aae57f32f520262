from __future__ import annotations

import pytest

from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.table import BRISTLE, FAMILIES
from nxt_twin.blind.sets import CasePlan
from nxt_twin.blind.silence import remains


def made(family, effects, seed):
    plan = CasePlan("case", seed, effects, "large")
    return FAMILIES[family].make(Order(family, plan, "usb", 6.0))


@pytest.mark.parametrize("family", [BRISTLE, "workshop"])
def test_a_clean_motor_is_within_a_count_of_the_plainest_model(family):
    case = made(family, (), 3)
    assert remains(case.recordings, case.answer).rms_deg < 1.0


def test_a_motor_that_lacks_nothing_is_nearer_than_one_that_lacks_much():
    case = made("workshop", ("gravity_load",), 3)
    assert remains(case.recordings, case.answer).rms_deg > 3.0
