"""Two changes that together look like another winding, and are named nonetheless."""

import pytest

from nxt_twin.blind.pairs.make import PairPlan, make_pair
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.recording.case import Case


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_more_inertia_and_viscous_friction_are_told_from_another_resistance(tmp_path, seed):
    pair = make_pair(PairPlan("pair", "bristle", seed, ("viscous_friction", "inertia")))
    before, after = (
        Case(name, tmp_path, pair.content["plant"], recordings, (), "a")
        for name, recordings in (("before", pair.recordings[:2]), ("after", pair.recordings[2:]))
    )
    (found,) = changed(before, [after])
    assert {change.of for change in found.changes} == {"inertia_kg_m2", "viscous_friction_nm_s_per_rad"}
    assert "The motor did not change." in found.sentence
