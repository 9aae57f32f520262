"""The page for users tells limits of the verdict as they are."""

from pathlib import Path

import pytest

from nxt_twin.diagnose.judging.verdict import LIMITS

PAGE = " ".join((Path(__file__).parents[2] / "docs" / "diagnosis.md").read_text(encoding="utf-8").split())


@pytest.mark.parametrize(
    "told",
    [
        f"An error of more than {LIMITS.surprising:g} times as much",
        f"By windows alone {100 * LIMITS.large_by_windows:g} % is the limit.",
        f"a free function of the time at rest gains {LIMITS.rested:g} nats",
        f"one that sets in above a speed gains {LIMITS.shaped:g} nats",
        f"an unknown torque above {100 * LIMITS.excused:g} %",
        f"where it gains {LIMITS.sober:g} nats and {100 * LIMITS.most_left:g} % of all gains",
        f"gain {LIMITS.heard:g} nats where it hardly brings a simulation nearer, and {LIMITS.unmistakable:g}",
        f"above {100 * LIMITS.forgiven:g} %. By windows alone",
        f"gain {LIMITS.sure:g} nats, if no other effect was found",
        f"errs by less than {LIMITS.faint:g} times the tolerance",
        f"for more than {100 * LIMITS.most_stalled:g} % of a recording",
    ],
)
def test_the_page_on_diagnosis_tells_a_limit_as_it_is(told):
    assert told in PAGE
