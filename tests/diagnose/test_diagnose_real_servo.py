"""A real servo that carries another known load: it is named, and the motor stays. Skipped where the data are not."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.api.prediction import predictions
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.errors import MissingDataError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.realdata import data_root

pytestmark = pytest.mark.real_data


@pytest.fixture(scope="module")
def case_of():
    try:
        cases = data_root() / "servo-sts3215" / "cases"
    except MissingDataError as missing:
        pytest.skip(str(missing))
    if not cases.exists():
        pytest.skip(f"{cases} is missing")
    return lambda name, stamps="": read_case(cases / (name + stamps))


@pytest.fixture(scope="module", params=["", "_restamped"], ids=["logged", "restamped"])
def stamps(request):
    return request.param


@pytest.fixture(scope="module")
def before(case_of, stamps):
    """The servo with 0.741 kg on 0.100 m, and the model that was fitted to it."""
    own = case_of("gear-friction-left-out", stamps)
    recordings = (*own.recordings, *own.holdout)
    return replace(case_of("unchanged", stamps), name="before", recordings=recordings, holdout=())


@pytest.mark.parametrize(
    ("name", "gravity_nm", "within", "added_kg_m2", "error_deg"),
    [
        ("heavier", 1.163, 0.10, 0.0053, 1.8),
        ("longer-arm", 1.127, 0.10, 0.0095, 1.8),
        ("heavier-and-longer-arm", 1.755, 0.15, 0.0202, 2.3),
    ],
)
def test_another_load_is_named_with_its_size(
    case_of, before, stamps, name, gravity_nm, within, added_kg_m2, error_deg
):
    case = case_of(name, stamps)
    (found,) = changed(before, [replace(case, holdout=())])
    sizes = {change.of: change for change in found.changes}
    assert sizes.keys() == {"gravity_torque_nm", "inertia_kg_m2"}
    assert found.sentence.startswith("The load changed")
    assert "The motor did not change." in found.sentence
    assert sizes["gravity_torque_nm"].after == pytest.approx(gravity_nm, rel=within)
    inertia = sizes["inertia_kg_m2"]
    assert inertia.after - inertia.before == pytest.approx(added_kg_m2, rel=0.15)
    runs = [run for one in case.holdout for run in predictions(found.plant.to_config(), one, 2.0)]
    assert np.sqrt(np.mean([run.rmse**2 for run in runs])) <= error_deg


def test_other_repeats_of_one_load_are_unchanged(case_of, before, stamps):
    (found,) = changed(before, [replace(case_of("unchanged", stamps), holdout=())])
    assert (found.verdict, found.changes) == ("unchanged", ())


def test_friction_that_grows_with_load_is_named_where_the_model_leaves_it_out(case_of, stamps):
    found = diagnose(case_of("gear-friction-left-out", stamps)).diagnosis
    assert (found.verdict, [effect.id for effect in found.effects]) == (
        "explained",
        ["load_dependent_friction"],
    )
    assert found.fit.improved < 0.7 * found.fit.baseline


def test_a_model_with_gear_friction_is_adequate_for_other_repeats(case_of, stamps):
    found = diagnose(case_of("unchanged", stamps)).diagnosis
    assert (found.verdict, found.effects) == ("adequate", ())
    assert found.fit.improved <= 1.3
    assert all(abs(moved.after / moved.before - 1.0) <= 0.1 for moved in found.refit.values())
