"""The search's economies: a screen of one run a start, noise by stars, coarse steps, and a bounded amount of work."""

import math
from dataclasses import asdict, replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_cases import concealed, diagnosed

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting import batch
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.fitting.noise import damping_per_s, estimate, first_noise, with_noise
from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import DRAFT_STEP_S, step_for
from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search.drafts import Drafts
from nxt_twin.diagnose.search.explain import _Search, explain
from nxt_twin.diagnose.search.screen import screen
from nxt_twin.diagnose.search.trials import addable_effects
from nxt_twin.diagnose.search.weight import Weight, weigh
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import STEP_S, Simulator
from nxt_twin.recording.recording import Recording, SignalKinds


class Bench:
    """A problem with its baseline settled, and a count of the steps that are simulated."""

    def __init__(self, effects, **made):
        self.problem = problem_for(concealed(effects, **made))
        self.simulator = Simulator(self.problem.plant.layout)
        self.fitter = Fitter(self.simulator, self.problem)
        self.fits = Fits(self.simulator, self.problem)
        self.steps = 0.0
        self._run = self.simulator.run
        self.simulator.run = self._counted
        noise = first_noise(self.problem.plant, self.problem.signals, self.problem.scale.torque)
        self.baseline = settled(self.fitter, self.problem.plant, noise)

    def _counted(self, values, active, jobs):
        spans_s = [(job.signals.time_s[-1] - job.signals.time_s[0]) / job.step_s for job in jobs]
        self.steps += values.shape[0] * sum(spans_s)
        return self._run(values, active, jobs)

    def screened(self):
        return screen(self.fits, self.baseline, addable_effects(self.baseline.plant, self.problem.signals[0]))


@pytest.fixture(scope="module")
def lacking():
    return Bench(("gravity_load",), seed=141)


def test_the_screen_puts_what_is_concealed_first(lacking):
    assert lacking.screened()[0].effect.id == "gravity_load"


def test_a_screen_costs_about_one_run_a_start(lacking):
    before = lacking.steps
    starts = len(lacking.screened())
    seconds = sum(float(job.signals.time_s[-1]) for job in lacking.problem.target.jobs)
    assert lacking.steps - before < 2.6 * starts * seconds / DRAFT_STEP_S


def test_beside_late_stamps_an_effect_promises_what_believed_readings_gain():
    bench = Bench(("stale_samples", "voltage_drop"), seed=151)
    late = bench.baseline.plant.with_effect("stale_samples", {"stale_fraction": 0.02})
    best = settled(bench.fitter, late, bench.baseline.noise)
    further = screen(bench.fits, best, addable_effects(best.plant, bench.problem.signals[0]))
    true = settled(bench.fitter, best.plant.with_effect("voltage_drop", {"brush_drop": 1.0}), best.noise)
    assert further[0].effect.id == "voltage_drop"
    assert further[0].gain < best.fitted_cost - true.fitted_cost


def test_small_batches_promise_the_same(lacking, monkeypatch):
    whole = {(p.effect.id, tuple(p.plant.values.values())): p.gain for p in lacking.screened()}
    monkeypatch.setattr(batch, "_MOST_READINGS", 20_000)
    for prospect in lacking.screened():
        key = (prospect.effect.id, tuple(prospect.plant.values.values()))
        assert prospect.gain == pytest.approx(whole[key], rel=1e-6, abs=1e-6)


def test_an_hour_that_must_be_run_set_by_set_is_fitted_the_same(lacking, monkeypatch):
    plant, noise = lacking.baseline.plant, lacking.baseline.noise
    whole = settled(lacking.fitter, plant, noise)
    slopes = linearise(lacking.simulator, lacking.problem, whole).slopes
    monkeypatch.setattr(batch, "_MOST_READINGS", 1)
    alone = settled(lacking.fitter, plant, noise)
    # Sets that run abreast round their last digits otherwise than one that runs alone.
    assert alone.plant.values == pytest.approx(whole.plant.values, rel=1e-6)
    assert asdict(alone.noise) == pytest.approx(asdict(whole.noise), rel=1e-6)
    assert alone.free_run_rms == pytest.approx(whole.free_run_rms, rel=1e-6)
    again = linearise(lacking.simulator, lacking.problem, alone).slopes
    assert again == pytest.approx(slopes, rel=1e-4, abs=1e-5)


def test_the_noise_is_at_least_as_likely_as_any_on_a_fine_grid(lacking):
    plant, target = lacking.baseline.plant, lacking.problem.target
    start = replace(lacking.baseline.noise, damping_per_s=damping_per_s(plant))
    values, active = plant.vectors()

    def cost_under(noise):
        tuned = with_noise(target, noise)
        return tuned.cost(lacking.simulator.run(values[None], active[None], tuned.jobs))[0]

    likeliest, gain = estimate(lacking.simulator, plant, target, start)
    assert cost_under(start) - gain == pytest.approx(cost_under(likeliest), abs=1e-6)
    for reading in np.geomspace(0.8, 3.0, 6):
        for disturbance in np.geomspace(0.2, 5.0, 9):
            noise = replace(
                start,
                reading_std=max(start.reading_std, reading * start.reading_std),
                disturbance_std=disturbance * start.disturbance_std,
            )
            assert cost_under(likeliest) < cost_under(noise) + 1.0


def test_no_noise_is_settled_on_under_which_a_run_runs_away():
    """A motor whose current is held does not forget its speed as its resistance tells, a light one within 3 ms."""
    bench = Bench(("current_limit",), seed=144, seconds=12.0)
    light = bench.baseline.plant.with_values({Slot("base", "inertia"): 2e-4})
    plant, target = light.with_effect("current_limit", {"ceiling": 0.06}), bench.problem.target
    start = replace(bench.baseline.noise, damping_per_s=30.0)
    values, active = plant.vectors()

    def cost_under(noise):
        tuned = with_noise(target, noise)
        return tuned.cost(bench.simulator.run(values[None], active[None], tuned.jobs))[0]

    likeliest, gain = estimate(bench.simulator, plant, target, start)
    assert damping_per_s(plant) > 5.0 * start.damping_per_s
    assert gain >= 0.0
    assert cost_under(likeliest) <= cost_under(start)


@pytest.mark.usefixtures("one_by_one")
@pytest.mark.parametrize("damping_per_s", [0.0, 5.0])
def test_noise_is_searched_for_a_body_that_nothing_damps(damping_per_s):
    time_s = np.arange(0.0, 6.0, 0.01)
    torque_nm = 0.1 * np.sign(np.sin(3.0 * time_s))
    speed_rad_s = np.cumsum(torque_nm) * 0.01 / 0.02
    angle_rad = np.cumsum(speed_rad_s) * 0.01 + np.random.default_rng(5).normal(0.0, 1e-3, time_s.size)
    columns = {"time_s": time_s, "input": torque_nm, "output": angle_rad}
    recording = Recording("made", columns, SignalKinds("torque_nm", "position_rad"))
    problem = problem_of("case", {"kind": "rigid_body", "inertia": 0.02}, [recording], [], None)
    with Simulator(problem.plant.layout) as simulator:
        start = replace(
            first_noise(problem.plant, problem.signals, problem.scale.torque), damping_per_s=damping_per_s
        )
        likeliest, gain = estimate(simulator, problem.plant, problem.target, start)
    assert gain >= 0.0
    assert math.isfinite(likeliest.reading_std)


@pytest.mark.slow
def test_effects_are_found_that_free_runs_speak_against_one_by_one():
    """With a twisting shaft but without the spring a free run is further off than with neither."""
    concealing = ("spring_load", "inductance", "shaft_compliance")
    found = diagnosed(concealing, seed=5507709547413580, size="large").diagnosis
    assert found.verdict == "explained"
    assert {effect.id for effect in found.effects} == set(concealing)


def test_a_draft_is_made_once_for_a_structure(lacking):
    drafts = Drafts(lacking.fits)
    effects = addable_effects(lacking.baseline.plant, lacking.problem.signals[0])
    first = drafts.of(lacking.baseline, effects, 2)
    before = lacking.steps
    again = drafts.of(lacking.baseline, effects, 2)
    assert lacking.steps == before
    assert [(effect.id, draft.cost) for effect, draft in again] == [(e.id, d.cost) for e, d in first]
    assert drafts.of(lacking.baseline, effects, 2, least_nats=1e9) == []


def test_mechanical_states_take_finer_steps(lacking):
    plant = lacking.baseline.plant
    playing = plant.with_effect("backlash", {"gap": 0.1, "load_inertia": 5e-4})
    assert step_for(plant, DRAFT_STEP_S) == DRAFT_STEP_S
    assert STEP_S <= step_for(playing, DRAFT_STEP_S) < DRAFT_STEP_S


def test_coarse_steps_change_a_settled_weight_by_little(lacking):
    bench, plant = lacking, lacking.baseline.plant
    found = max(bench.screened(), key=lambda prospect: prospect.gain)
    noise = bench.baseline.noise
    coarse = settled(bench.fitter, found.plant, noise)
    exact = Fitter(bench.simulator, bench.problem)
    exact._targets = {1e-3: bench.problem.objective, 2e-3: bench.problem.objective}
    fine = settled(exact, found.plant, noise)
    fine_base = settled(exact, plant, noise)
    assert weigh(bench.baseline, coarse).gain == pytest.approx(weigh(fine_base, fine).gain, abs=6.0)


def test_two_effects_are_found_together_with_a_bounded_amount_of_work():
    bench = Bench(("battery_sag", "gravity_load"), seed=142)
    before = bench.steps
    explanation = explain(bench.fits, bench.baseline, lambda _: None)
    assert {effect.id for effect, _ in explanation.found} == {"battery_sag", "gravity_load"}
    assert all(weight.total > 0.0 for _, weight in explanation.found)
    assert bench.steps - before < 92e6


def test_nothing_is_found_where_nothing_lacks_and_it_costs_little():
    bench = Bench((), seed=143)
    before = bench.steps
    explanation = explain(bench.fits, bench.baseline, lambda _: None)
    assert explanation.found == ()
    assert bench.steps - before < 32e6


def test_what_doubts_readings_does_not_hide_what_else_is_missing():
    bench = Bench(("stale_samples", "stiction"), seed=143)
    doubting = settled(
        bench.fitter,
        bench.baseline.plant.with_effect("stale_samples", {"stale_fraction": 0.05}),
        bench.baseline.noise,
    )
    effect = doubting.plant.layout.effect("stiction")
    best = screen(bench.fits, doubting, [effect])[0]
    coulomb = doubting.plant.values[Slot("coulomb_friction", "coulomb")]
    assert best.gain > 10.0
    stretched = best.stretched(bench.problem.scale)
    assert stretched.values[Slot("stiction", "breakaway")] > coulomb


def late(case, latency_s):
    """`case` with every reading as it was a while before its stamp, as where commands act so much later."""
    made = []
    for run in (*case.recordings, *case.holdout):
        columns = dict(run.columns)
        told = np.isfinite(columns["a_tacho_deg"])
        stamps_s, counts = columns["time_s"][told], columns["a_tacho_deg"][told]
        columns["a_tacho_deg"] = columns["a_tacho_deg"].copy()
        columns["a_tacho_deg"][told] = np.floor(np.interp(stamps_s - latency_s, stamps_s, counts) + 0.5)
        made.append(replace(run, columns=columns))
    count = len(case.recordings)
    return replace(case, recordings=tuple(made[:count]), holdout=tuple(made[count:]))


@pytest.mark.parametrize("effects", [(), ("gravity_load",)])
def test_a_latency_of_a_millisecond_has_no_name_and_takes_none_from_another(effects):
    problem = problem_for(late(concealed(effects, seed=147, seconds=12.0), 1.5e-3))
    with Simulator(problem.plant.layout) as simulator:
        fits = Fits(simulator, problem)
        explanation = explain(fits, fits.settled_baseline(), lambda _: None)
    assert tuple(effect.id for effect, _ in explanation.found) == effects
    assert [effect.id for effect in explanation.unnamed] == ["command_delay"]
    delay_s = explanation.best.plant.values[Slot("command_delay", "command_delay")]
    assert delay_s == pytest.approx(1.5e-3, abs=0.6e-3)


@pytest.mark.parametrize(
    ("smaller_rank", "ahead"), [((True, 9.1), True), ((True, 8.9), False), ((False, 50.0), False)]
)
def test_what_a_smaller_effect_clearly_explains_names_no_larger_one(smaller_rank, ahead, monkeypatch):
    search = object.__new__(_Search)
    search._standard = SimpleNamespace(worth_it=lambda *_: True)
    search._unnamed = set()
    larger, smaller = (SimpleNamespace(id=name) for name in ("cogging", "presliding"))
    ranks = {"cogging": (True, 1.0), "presliding": smaller_rank}
    monkeypatch.setattr(_Search, "_rank", lambda _, effect, *__: ranks[effect.id])
    monkeypatch.setattr(_Search, "pruned", lambda _, trial: trial)
    monkeypatch.setattr(_Search, "_still_worth_it", lambda _, added, __: added)
    added = search._added("bare", [(larger, None, "with cogging")], [(smaller, None, "with presliding")])
    assert added == ("with presliding" if ahead else "with cogging")
    assert search._unnamed == ({"presliding"} if ahead else set())


@pytest.mark.parametrize(
    ("gain", "ratio", "own_ratio", "first"),
    [
        (102.0, 0.49, 0.94, "constant_load"),
        (102.0, 0.51, 0.94, "command_delay"),
        (43.0, 0.49, 0.94, "command_delay"),
        (102.0, 0.49, 0.4, "command_delay"),
    ],
)
def test_restored_numbers_come_first_unless_a_likelier_effect_simulates_much_nearer(
    gain, ratio, own_ratio, first, monkeypatch
):
    search = object.__new__(_Search)
    search._standard = SimpleNamespace(worth_it=lambda *_: True, lasts=lambda *_: True, leaning=lambda _: 0.0)
    monkeypatch.setattr(explaining, "coincidence_nats", lambda *_: 0.0)
    delay, load = (SimpleNamespace(id=name) for name in ("command_delay", "constant_load"))
    weights = {
        "delayed": Weight(44.0, 0.0, own_ratio, runs_worse=False, restored_nats=12.0),
        "loaded": Weight(gain, 0.0, ratio, runs_worse=False),
    }
    monkeypatch.setattr(explaining, "weigh", lambda _, trial: weights[trial.plant])
    settled = [(load, SimpleNamespace(plant="loaded")), (delay, SimpleNamespace(plant="delayed"))]
    assert search._ranked("bare", settled)[0][0].id == first


@pytest.mark.parametrize(
    ("stated", "found", "small"), [({"coulomb_friction"}, set(), True), (set(), {"coulomb_friction"}, False)]
)
def test_what_brings_a_plain_term_with_it_is_small_only_if_the_baseline_has_that_term(stated, found, small):
    """Else plain friction that the baseline lacks would lose its name, found or not."""
    search = object.__new__(_Search)
    asymmetric = SimpleNamespace(id="asymmetric_friction", supersedes=("coulomb_friction",))
    search._trials = SimpleNamespace(beside=lambda _: [(asymmetric, None)])
    search._standard = SimpleNamespace(
        is_notable=lambda *_: False, is_too_small=lambda *_: True, loud=frozenset()
    )
    search.baseline = SimpleNamespace(plant=SimpleNamespace(active=frozenset(stated)))
    search._ranked = lambda _, settled: settled
    search._untaken = SimpleNamespace(note=lambda *_: None)
    best = SimpleNamespace(plant=SimpleNamespace(active=frozenset(stated | found)))
    assert search._forward(best) == ([], [(asymmetric, None)] if small else [])


def test_a_window_that_errs_by_half_the_tolerance_says_nothing(lacking):
    assert lacking.baseline.slight == 0.5 * lacking.problem.tolerance


@pytest.mark.parametrize(
    ("found", "worth_it", "lasts", "ratio", "added"),
    [
        ({"cogging"}, True, True, 0.64, True),
        ({"cogging"}, True, True, 0.66, False),
        ({"cogging"}, True, False, 0.3, False),
        ({"cogging"}, False, True, 0.3, False),
        (set(), True, True, 0.3, False),
        ({"command_delay"}, True, True, 0.3, False),
    ],
)
def test_a_small_effect_rounds_off_found_ones_where_a_simulation_gets_much_nearer(
    found, worth_it, lasts, ratio, added
):
    search = object.__new__(_Search)
    search.baseline = SimpleNamespace(plant=SimpleNamespace(active=frozenset()))
    search._standard = SimpleNamespace(worth_it=lambda *_: worth_it, lasts=lambda *_: lasts)
    search._unnamed = {"command_delay"}
    best = SimpleNamespace(plant=SimpleNamespace(active=frozenset(found)))
    small = (SimpleNamespace(id="presliding"), SimpleNamespace(free_run_ratio=ratio), "with presliding")
    assert search._rounded_off(best, [small]) == ("with presliding" if added else None)
    assert ("presliding" in search._unnamed) is added
    assert search._rounded_off(best, []) is None


@pytest.mark.parametrize(
    ("friction", "there"),
    [("coulomb_friction", True), ("asymmetric_friction", True), ("viscous_friction", False)],
)
def test_stiction_waits_for_the_friction_that_it_comes_on_top_of(lacking, friction, there):
    bare = lacking.problem.plant.without(["coulomb_friction"])
    effect = bare.layout.effect(friction)
    plant = bare.with_effect(friction, {p.symbol: p.starts[0] * p.si for p in effect.parameters})
    addable = addable_effects(plant, lacking.problem.signals[0])
    assert ("stiction" in {one.id for one in addable}) is there
