"""The real axis EMPS: friction of its second run is some percent higher. Skipped where the data are not."""

from dataclasses import replace

import pytest

from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.errors import MissingDataError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.realdata import data_root, prepare_case

pytestmark = pytest.mark.real_data

GIVEN = {
    "kind": "rigid_body",
    "inertia": 95.0,
    "viscous_friction": 200.0,
    "coulomb_friction": 20.0,
    "effects": {"constant_load": {"load_force_n": 3.2}},
}
"""Its drive pushes 3.2 N to one side in both runs."""


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    try:
        folder = prepare_case("emps", data_root(), tmp_path_factory.mktemp("emps"))
    except MissingDataError as missing:
        pytest.skip(str(missing))
    return replace(read_case(folder), plant=GIVEN)


def part(recording, rows, name):
    """Some rows of a recording."""
    columns = {key: values[rows] for key, values in recording.columns.items()}
    return replace(recording, name=name, columns=columns)


def test_viscous_friction_of_the_second_run_is_some_percent_higher(case):
    before = replace(case, name="before", holdout=())
    after = replace(case, name="after", recordings=case.holdout, holdout=())
    (found,) = changed(before, [after])
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "viscous_friction")
    assert 1.03 < change.after / change.before < 1.09
    assert change.interval_95[0] > change.before


def test_halves_of_the_first_run_are_unchanged(case):
    (run,) = case.recordings
    middle = run.rows // 2
    halves = [
        replace(case, name=name, recordings=(part(run, rows, name),), holdout=())
        for name, rows in (("first", slice(0, middle)), ("second", slice(middle, None)))
    ]
    (found,) = changed(halves[0], halves[1:])
    assert (found.verdict, found.changes) == ("unchanged", ())
