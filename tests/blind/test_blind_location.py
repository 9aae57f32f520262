"""Whether the benchmark counts right where a baseline is said to fail."""

import pytest

from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.located import Located, locate_score, parse_place
from nxt_twin.blind.location import location
from nxt_twin.blind.reached import Reach
from nxt_twin.blind.verdict import NOTHING_GIVEN, Judged, judge
from nxt_twin.physics.library import library


def source(equation, strength, p_value=1e-9):
    return {"source": "", "equation": equation, "strength": strength, "p_value": p_value}


def onset(time_s, recording="r2.csv", half_s=0.1):
    return {
        "what": "inertia", "recording": recording, "time_s": time_s,
        "low_s": time_s - half_s, "high_s": time_s + half_s, "strength": 20.0, "p_value": 1e-3,
    }  # fmt: skip


def placed(effect, equation=None, *, sources=(), onsets=(), **params):
    """What was hidden, judged beside what a diagnosis says of where."""
    hidden = [{"id": effect, "params": params}] if effect else []
    said = {"channel": "a_tacho_deg", "when": [], "regimes": [], "equation": equation}
    return locate_score({"effects": hidden}, parse_place({**said, "sources": sources, "onsets": onsets}))


def case(kind, located: Located, *, seen=True):
    effects = {"clean": [], "single": ["stiction"], "unknown": ["pawl"]}[kind]
    answer = {
        "case": kind,
        "effects": [
            {"id": one, "known": kind == "single", "size": "small", "main": "x", "params": {}}
            for one in effects
        ],
        "effect_rms_deg": 5.0,
    }
    plain = judge(answer, NOTHING_GIVEN, Reach(50.0 if seen else 1.0, 0.0, 1.0))
    return Judged(**{**vars(plain), "located": located})


@pytest.mark.parametrize("effect_id", KNOWN_EFFECTS)
def test_benchmark_and_library_agree_on_the_equation_of_each_effect(effect_id):
    declared = KNOWN_EFFECTS[effect_id].equation
    assert library()[effect_id].equation_of == ("torque_balance" if declared == "kinematic" else declared)


def test_the_equation_is_judged_as_named_and_as_heard_without_a_name():
    sources = [source("electrical", 9.0), source("timing", 12.0)]
    found = placed("command_delay", "electrical", sources=sources, delay_s=0.02)
    assert (found.truth, found.named, found.unaided) == ("timing", False, True)


def test_what_joins_two_bodies_counts_to_the_torques_only_where_the_format_has_no_other_name():
    sources = [source("torque_balance", 9.0), source("kinematic", 8.0)]
    found = placed("backlash", "torque_balance", sources=sources, gap_deg=5.0)
    assert (found.named, found.unaided) == (True, False)


def test_a_moment_is_only_sought_where_something_sets_in():
    told = {"added_inertia_kg_m2": 1e-3, "from_recording": 2.0, "from_s": 4.0}
    found = placed("payload_inertia", onsets=[onset(9.0, "r1.csv"), onset(4.2)], **told)
    assert found.onset_error_s == pytest.approx(0.2)
    assert found.onset_held is False
    assert placed("payload_inertia", onsets=[onset(9.0, "r1.csv")], **told).onset is None
    assert placed("payload_inertia", added_inertia_kg_m2=1e-3, from_recording=2.0, from_s=0.0).event is None


def test_cases_are_counted_by_equation_and_moments_by_nearness():
    told = {"from_recording": 2.0, "from_s": 4.0}
    right = placed("stiction", "torque_balance", sources=[source("torque_balance", 9.0)])
    wrong = placed("stiction", "timing", sources=[source("electrical", 9.0)])
    near = placed("payload_inertia", "torque_balance", onsets=[onset(4.05)], **told)
    far = placed("payload_inertia", "torque_balance", onsets=[onset(5.0)], **told)
    feigned = placed("pawl", onsets=[onset(2.0)])
    singles = [case("single", one) for one in (right, near, far)]
    table = location([*singles, case("single", wrong, seen=False), case("unknown", feigned)])
    assert str(table.row("single").named) == "3/4 [30–95 %]"
    assert (table.row("single, detectable").named.count, table.row("single, detectable").named.of) == (3, 3)
    assert table.row("unknown, torque_balance").unaided.count == 0
    assert (table.onsets.near.count, table.onsets.near.of) == (1, 2)
    assert table.onsets.error_s == pytest.approx(0.525)
    assert (table.onsets.held.count, table.onsets.held.of) == (1, 2)
    assert (table.onsets.feigned.count, table.onsets.feigned.of) == (1, 3)
    assert "single, torque_balance" in table.as_text()
    assert table.as_dict()["onsets"]["near"]["count"] == 1


def test_p_values_are_counted_on_clean_cases_that_give_them():
    quiet = placed(None, sources=[source("electrical", 1.0, 0.4)])
    loud = placed(None, sources=[source("electrical", 1.0, 0.4), source("timing", 9.0, 1e-3)])
    silent = placed(None)
    table = location([case("clean", one) for one in (quiet, loud, silent)])
    assert (table.alarms.count, table.alarms.of) == (1, 2)
