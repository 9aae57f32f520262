"""Commands that lost their sign are told in the sentence."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.diagnose.telling.signs import lost_signs
from nxt_twin.physics.signals import Signals

ROWS = 200
TIME_S = 0.01 * np.arange(ROWS)
COMMAND = np.where(TIME_S < 1.0, 0.6, -0.6)
BOTH_WAYS = Signals(
    name="run.csv",
    channel="a_tacho_deg",
    input_kind="power_pct",
    command_time_s=TIME_S,
    command=np.abs(COMMAND),
    command_mode=np.zeros(ROWS, dtype=np.int64),
    command_supply_v=np.full(ROWS, np.nan),
    time_s=TIME_S,
    measured=np.cumsum(COMMAND) * 0.1,
    is_speed=False,
    quantum=0.0,
)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, True),
        ({"command": COMMAND}, False),
        ({"input_kind": "goal_position_deg"}, False),
        ({"measured": COMMAND, "is_speed": True}, True),
        ({"measured": np.cumsum(np.abs(COMMAND))}, False),
    ],
)
def test_a_motor_that_runs_both_ways_under_commands_of_one_sign_is_told(changes, told):
    said = lost_signs([replace(BOTH_WAYS, **changes), replace(BOTH_WAYS, command=COMMAND)])
    assert ("In run.csv the motor runs both ways" in "".join(said)) is told
    assert len(said) == int(told)
