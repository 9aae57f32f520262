"""A load behind play: where it strikes decides, and the likelihood of a gap has steps that slopes do not show."""

import math

import pytest

from nxt_twin.blind.pairs.make import PairPlan, make_pair
from nxt_twin.diagnose.changed.engine import ready_pairs
from nxt_twin.diagnose.changed.joint import JointFitter
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case

ALIKE_NATS = 8.0  # of 380
USUAL_SHARE = 0.2  # of the friction, from which a fit begins


def test_the_gap_that_a_fit_ends_at_does_not_depend_on_the_one_that_it_begins_at(tmp_path):
    pair = make_pair(PairPlan("pair", "bristle", 880004, ("backlash",)))
    before, after = (
        Case(name, tmp_path, pair.content["plant"], recordings, (), "a")
        for name, recordings in (("before", pair.recordings[:2]), ("after", pair.recordings[2:]))
    )
    (ready,) = ready_pairs(before, [after])
    problem = ready.problems[0]
    found = []
    with Simulator(problem.plant.layout) as simulator:
        fitter = JointFitter(simulator, ready.windows.sides, ready.tolerance, ready.as_read)
        for gap_deg in (6.0, 12.0, 30.0):
            start = {"gap": math.radians(gap_deg), "load_inertia": 1e-3, "load_friction_share": USUAL_SHARE}
            model = ready.model.with_effect("backlash", start, problem.scale)
            found.append(fitter.fit(model, model.start()))
    true_deg = pair.answer["changes"][0]["params"]["gap_deg"]
    costs = [fit.cost for fit in found]
    assert max(costs) - min(costs) < ALIKE_NATS
    for fit in found:
        gap = fit.model.plant_at(fit.x, after=True).values[Slot("backlash", "gap")]
        assert math.degrees(gap) == pytest.approx(true_deg, rel=0.3)
