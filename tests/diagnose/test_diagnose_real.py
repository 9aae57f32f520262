"""The three real motors, with the splits fixed beforehand. Skipped where the data are not."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from nxt_twin.diagnose.engine import diagnose, fit_as_it_stands, problem_for
from nxt_twin.diagnose.fitting.baselines import best_baseline, settled_baseline
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.diagnose.judging.horizons import errors_of
from nxt_twin.errors import MissingDataError
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest, restarts
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.realdata import data_root, prepare_case

pytestmark = pytest.mark.real_data


@pytest.fixture(scope="module")
def case_of(tmp_path_factory):
    try:
        data = data_root()
    except MissingDataError as missing:
        pytest.skip(str(missing))
    folder = tmp_path_factory.mktemp("cases")
    return lambda name: read_case(prepare_case(name, data, folder))


def test_emps_lacks_dry_friction_and_the_error_on_the_test_file_falls_to_3_2_mm(case_of):
    diagnosis = diagnose(case_of("emps")).diagnosis
    assert diagnosis.verdict == "explained"
    assert {"coulomb_friction", "asymmetric_friction"} & {effect.id for effect in diagnosis.effects}
    assert diagnosis.fit.unit == "mm"
    assert diagnosis.fit.baseline > 7.0
    assert diagnosis.fit.improved <= 3.2


def test_the_re_fitted_baseline_of_emps_errs_as_a_plain_fit_of_windows_by_scipy_does(case_of):
    problem = problem_for(case_of("emps"))
    jobs = [free_job(one, restarts(one, 2.0)) for one in problem.signals]
    free = [Slot("base", "inertia"), Slot("viscous_friction", "viscous")]

    def at(logs):
        return problem.plant.with_values(
            {s: problem.plant.values[s] * np.exp(x) for s, x in zip(free, logs, strict=True)}
        )

    def misses(logs):
        values, active = (np.array([row]) for row in at(logs).vectors())
        runs = simulator.run(values, active, jobs)
        pairs = zip(jobs, runs, strict=True)
        return np.concatenate(
            [(job.signals.measured - run.predicted[0])[~job.start.at] for job, run in pairs]
        )

    with Simulator(problem.plant.layout) as simulator:
        plain = at(least_squares(misses, [0.0, 0.0], diff_step=1e-2).x)
        fitter = Fitter(simulator, problem)
        settled = settled_baseline(fitter)
        refit = best_baseline(fitter, settled, settled)
        own, other = (
            errors_of(simulator, problem, plant, refit.plant, refit.noise).rms
            for plant in (refit.plant, plain)
        )
    assert not {one.name for one in problem.signals} & {part.signals.name for part in problem.held_out}
    assert (np.array(own) <= 1.1 * np.array(other)).all()


def test_emps_parameters_of_the_published_structure_agree_within_5_percent(case_of):
    case = case_of("emps")
    published = {**case.plant, "coulomb_friction": 10.0, "effects": {"constant_load": {"load_force_n": 1.0}}}
    values = fit_as_it_stands(
        Case("emps", case.folder, published, case.recordings, case.holdout, None)
    ).plant.values
    assert values[Slot("base", "inertia")] == pytest.approx(95.11, rel=0.05)
    assert values[Slot("viscous_friction", "viscous")] == pytest.approx(203.5, rel=0.05)
    assert values[Slot("coulomb_friction", "coulomb")] == pytest.approx(20.39, rel=0.05)
    assert values[Slot("constant_load", "load")] == pytest.approx(3.165, rel=0.05)


def test_ev3_free_run_over_the_first_two_seconds_of_the_test_steps_falls_to_5_5_deg(case_of):
    case = case_of("ev3-large")
    answer = diagnose(case)
    assert "friction" in " ".join(effect.id for effect in answer.diagnosis.effects)
    problem = problem_of(case.name, case.plant, case.recordings, case.holdout, case.port)
    errors = []
    with Simulator(answer.plant.layout) as simulator:
        for part in problem.held_out:
            if part.signals.name.startswith("step"):
                run = simulator.trace(answer.plant, free_job(part.signals, at_rest(part.signals)))
                first = part.signals.time_s - part.signals.time_s[0] <= 2.0
                errors.append(np.degrees(part.signals.measured - run["predicted"])[first])
    assert len(errors) == 10
    assert np.sqrt(np.mean(np.concatenate(errors) ** 2)) <= 5.5
    bad = [note for note in answer.diagnosis.notes if "keeps a large error" in note]
    assert any("step_p100.csv" in note and "1.25 times the largest" in note for note in bad)


def test_nxt_step_is_a_fault_of_the_transport_and_no_physics_is_invented(case_of):
    diagnosis = diagnose(case_of("nxt-step")).diagnosis
    assert [effect.id for effect in diagnosis.effects] == ["stale_samples"]
    assert diagnosis.mismatch.equation == "timing"
    assert diagnosis.sentence.startswith("No physics is missing")
    note = next(note for note in diagnosis.notes if "older than their stamps" in note)
    assert "0.355" in note
    assert "2.154" in note
