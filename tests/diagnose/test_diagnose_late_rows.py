"""Rows that chance stamps late: their neighbours tell by how much, and a clock is named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_cases import concealed
from diagnose_motors import clean_case
from test_diagnose_held_ages import turning

from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.late_rows import as_late_as, with_drawn_moments, with_lateness
from nxt_twin.diagnose.fitting.wandering import late_by_chance_starts, second_waves
from nxt_twin.diagnose.judging.doubt import straying
from nxt_twin.diagnose.telling.notes import stamped_late
from nxt_twin.physics.effects.timing import CLOCK_SKEW
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.recording import Recording

ROWS = 1500
STARTS = {p.symbol: p.starts[0] * p.si for p in CLOCK_SKEW.parameters}


def polled(rng, poll_s, jitter, *, stalls=3):
    """When a host that waits for a poll after each one reads: jitter adds up, and it stands still a few times."""
    waits_s = poll_s * (1.0 + rng.uniform(-jitter, jitter, ROWS))
    waits_s[rng.choice(ROWS, stalls, replace=False)] += 0.1
    return np.cumsum(waits_s)


def made_late(rng, taken_s, span_s):
    """Each row later by anything up to `span_s`, and none before the row above it."""
    return np.maximum.accumulate(taken_s + rng.uniform(0.0, span_s, taken_s.size))


def known(*stamps_s):
    """What stamps tell of lateness; nothing turns."""
    return with_lateness([turning(np.zeros(each.size), each) for each in stamps_s])


@pytest.mark.parametrize(("poll_s", "span_s"), [(0.01, 0.02), (0.02, 0.03), (0.05, 0.02), (0.02, 0.1)])
@pytest.mark.parametrize("jitter", [0.02, 0.15])
def test_stamps_tell_by_how_much_each_row_is_late(poll_s, span_s, jitter):
    rng = np.random.default_rng(5)
    taken_s = [polled(rng, poll_s, jitter) for _ in range(2)]
    stamps_s = [made_late(rng, each, span_s) for each in taken_s]
    for found, true_s in zip(known(*stamps_s), taken_s, strict=True):
        late_s = found.time_s - true_s
        assert found.late_span_s == pytest.approx(np.sqrt(12.0) * np.std(late_s), rel=0.15)
        told_s = found.late_span_s * found.ages[:, 2]
        assert np.corrcoef(told_s, late_s)[0, 1] > 0.75
        left_s = told_s - late_s
        open_s = found.late_open * found.late_span_s
        assert 1.4826 * np.median(np.abs(left_s - np.median(left_s))) == pytest.approx(open_s, rel=0.6)
        assert np.std(left_s) < np.std(late_s)


@pytest.mark.parametrize("seldom", [0.05, 0.2])
@pytest.mark.parametrize("jitter", [0.03, 0.15])
def test_a_few_rows_may_be_very_late_and_all_others_punctual(seldom, jitter):
    """As where a host is busy now and then: a row waits for it, and those behind wait as well."""
    rng = np.random.default_rng(16)
    taken_s = polled(rng, 0.02, jitter)
    late_s = np.where(rng.random(ROWS) < seldom, rng.exponential(0.02, ROWS), 0.0)
    stamps_s = np.maximum.accumulate(taken_s + late_s)
    (found,) = known(stamps_s)
    told_s = found.late_span_s * found.ages[:, 2]
    assert np.std(told_s - (stamps_s - taken_s)) < 0.3 * np.std(stamps_s - taken_s)


@pytest.mark.parametrize("after", [4, 40, 400])
def test_rows_after_a_stall_are_not_late(after):
    """Though few rows may be very late: these would all be so by one time."""
    rng = np.random.default_rng(17)
    taken_s = polled(rng, 0.02, 0.1, stalls=0)
    taken_s[-after:] += 0.5
    (found,) = known(np.maximum.accumulate(taken_s + 0.02 * rng.random(ROWS) ** 2))
    assert np.abs(found.late_span_s * found.ages[-after:, 2]).max() < 0.03


def test_a_command_is_as_late_as_its_row():
    rng = np.random.default_rng(6)
    stamps_s = made_late(rng, polled(rng, 0.02, 0.05), 0.03)
    rows = np.array([0, 40, 700])
    (found,) = with_lateness(
        [
            replace(
                turning(np.zeros(ROWS), stamps_s),
                command_time_s=stamps_s[rows],
                command=np.zeros(3),
                command_mode=np.zeros(3, dtype=np.int64),
                command_supply_v=np.full(3, 8.0),
            )
        ]
    )
    np.testing.assert_allclose(found.command_late, found.ages[rows, 2])


@pytest.mark.parametrize("jitter", [0.02, 0.25])
@pytest.mark.parametrize("poll_s", [0.005, 0.05])
def test_polls_that_are_late_themselves_are_no_late_rows(poll_s, jitter):
    (found,) = known(polled(np.random.default_rng(7), poll_s, jitter))
    assert found.late_span_s == 0.0
    assert not found.ages[:, 2].any()


def test_stamps_that_are_rounded_are_no_late_rows():
    (found,) = known(np.round(polled(np.random.default_rng(8), 0.01, 0.02, stalls=0), 3))
    assert found.late_span_s == 0.0


@pytest.mark.parametrize(
    ("poll_s", "jitter", "span_s", "told"),
    [
        (0.05, 0.15, 3.6e-3, False),  # neighbouring times turn by -0.05: polls have most of the jitter
        (0.05, 0.15, 5.6e-3, True),  # by -0.11
        (0.02, 0.02, 1.7e-3, False),
        (0.02, 0.02, 2.3e-3, True),
    ],
)
def test_small_lateness_beside_the_jitter_of_polls_is_none(poll_s, jitter, span_s, told):
    rng = np.random.default_rng(13)
    found = known(*(made_late(rng, polled(rng, poll_s, jitter, stalls=0), span_s) for _ in range(8)))
    assert (found[0].late_span_s > 0.0) is told


def test_too_short_recordings_tell_no_lateness():
    rng = np.random.default_rng(9)
    stamps_s = made_late(rng, polled(rng, 0.02, 0.02), 0.03)
    assert known(stamps_s[:63])[0].late_span_s == 0.0
    assert known(stamps_s[:64])[0].late_span_s > 0.0
    assert with_lateness([]) == []


def test_a_short_recording_beside_a_long_one_has_late_rows_too():
    rng = np.random.default_rng(10)
    stamps_s = made_late(rng, polled(rng, 0.02, 0.02), 0.03)
    short = known(stamps_s, stamps_s[:50])[1]
    assert np.corrcoef(short.ages[5:-5, 2], known(stamps_s)[0].ages[5:45, 2])[0, 1] > 0.98
    assert not known(stamps_s, stamps_s[:1])[1].ages[:, 2].any()


def test_drawn_lateness_strays_by_what_stamps_leave_open():
    rng = np.random.default_rng(11)
    (found,) = known(made_late(rng, polled(rng, 0.02, 0.1), 0.03))
    drawn = with_drawn_moments(found, rng)
    assert np.std(drawn.ages[:, 2] - found.ages[:, 2]) == pytest.approx(found.late_open, rel=0.1)
    honest = clean_signals()
    assert with_drawn_moments(honest, rng) is honest


def test_rows_of_clumps_are_drawn_about_their_moments_with_their_commands():
    time_s = 0.01 * np.arange(2000)
    given = replace(
        turning(6.0 * time_s, time_s),
        command_time_s=time_s[::10].copy(),
        command=np.zeros(200),
        command_mode=np.zeros(200, dtype=np.int64),
        command_supply_v=np.full(200, 8.0),
        command_late=np.zeros(200),
        command_open_s=np.zeros(200),
        open_s=np.full(2000, 1e-3),
    )
    loose = replace(given, command_open_s=np.full(200, 2e-3))
    drawn, kept = (with_drawn_moments(each, np.random.default_rng(4)) for each in (loose, given))
    assert np.std(drawn.time_s - time_s) == pytest.approx(1e-3, rel=0.1)
    assert np.diff(drawn.time_s).min() > 0.0
    assert np.std(drawn.command_time_s - time_s[::10]) == pytest.approx(2e-3, rel=0.15)
    np.testing.assert_array_equal(kept.command_time_s, time_s[::10])
    exact = replace(loose, open_s=np.zeros(2000))
    assert with_drawn_moments(exact, np.random.default_rng(4)) is exact


def test_what_others_draw_of_lateness_strays_in_no_synthetic_reading():
    rng = np.random.default_rng(15)
    (found,) = known(made_late(rng, polled(rng, 0.02, 0.1), 0.03))
    plant = problem_for(clean_case(12)).plant.with_effect("clock_skew", STARTS | {"waves": 0.0})
    held = plant.with_effect("sample_hold", {"refresh_period": 0.05, "age_when_new": 0.5})
    with Simulator(plant.layout, workers=1) as simulator:
        assert not straying(simulator, plant, found).any()
        moving = replace(found, command=np.full(found.command.size, 0.7), command_mode=0 * found.command_mode)
        alone, both = (straying(simulator, one, moving) for one in (held.without(["clock_skew"]), held))
    assert np.nanmax(alone) > 0.0
    np.testing.assert_allclose(np.nanmax(both), np.nanmax(alone), rtol=0.2)


def test_stamps_of_rows_that_were_spread_over_a_clump_tell_no_lateness():
    plant = problem_for(clean_case(12)).plant
    late = plant.with_effect("clock_skew", STARTS | {"lag_span": 0.03, "waves": 0.0})
    spread = replace(turning(np.zeros(200), 0.01 * np.arange(200.0)), clump_rows=4.0)
    assert as_late_as(late, spread) is spread
    assert as_late_as(late, replace(spread, clump_rows=0.0)).late_span_s == 0.03


def test_a_row_may_be_late_with_its_command_or_not():
    (found,) = known(made_late(rng := np.random.default_rng(16), polled(rng, 0.02, 0.1), 0.03))
    starts = late_by_chance_starts(found.late_span_s)
    assert {one["of_commands"] for one in starts} == {0.0, 1.0}
    assert all(one["waves"] == 0.0 and one["lag_span"] == found.late_span_s for one in starts)
    assert late_by_chance_starts(0.0) == []


@pytest.mark.parametrize(("rows", "told"), [(64, False), (400, True)])
def test_few_rows_have_to_turn_the_more_to_tell(rows, told):
    rng = np.random.default_rng(17)
    taken_s = polled(rng, 0.02, 0.15, stalls=0)[:rows]
    found = known(made_late(rng, taken_s, 4e-3))[0]
    assert (found.late_span_s > 0.0) is told


def clean_signals():
    return problem_for(clean_case(12)).signals[0]


def restamped(case, seed, span_s, made=made_late):
    """The case with each row late by chance."""
    rng = np.random.default_rng(seed)

    def stamped(recording):
        stamps_s = made(rng, recording.columns["time_s"], span_s)
        return Recording(recording.name, {**recording.columns, "time_s": stamps_s})

    return replace(
        case,
        recordings=tuple(stamped(one) for one in case.recordings),
        holdout=tuple(stamped(one) for one in case.holdout),
    )


def test_the_answer_tells_by_how_much_rows_are_late_and_what_stays_open():
    rng = np.random.default_rng(12)
    recordings = known(made_late(rng, polled(rng, 0.02, 0.1), 0.03))
    open_ms = 30.0 * recordings[0].late_open
    plant = problem_for(clean_case(12)).plant
    late = plant.with_effect("clock_skew", STARTS | {"lag_span": 0.03, "waves": 0.0})
    (note,) = stamped_late(late, recordings)
    assert "by up to 30 ms" in note
    assert f"to {open_ms:.1g} ms" in note
    wandering = plant.with_effect("clock_skew", STARTS)
    assert stamped_late(wandering, recordings) == stamped_late(plant, recordings) == ()


def test_a_plant_whose_rows_are_late_tells_it_of_stamps_that_alone_are_too_few_to_show_it():
    rng = np.random.default_rng(14)
    taken_s = polled(rng, 0.02, 0.1)[:100]
    signals = turning(np.zeros(100), made_late(rng, taken_s, 0.03))
    plant = problem_for(clean_case(12)).plant
    found = as_late_as(plant.with_effect("clock_skew", STARTS | {"lag_span": 0.03, "waves": 0.0}), signals)
    assert np.corrcoef(found.late_span_s * found.ages[:, 2], signals.time_s - taken_s)[0, 1] > 0.8
    assert as_late_as(plant.with_effect("clock_skew", STARTS), signals) is signals
    assert as_late_as(plant, signals) is signals
    none = plant.with_effect("clock_skew", STARTS | {"lag_span": 0.0, "waves": 0.0})
    assert as_late_as(none, signals) is signals


def test_rows_that_are_late_by_chance_have_no_second_wave():
    plant = problem_for(clean_case(12)).plant.with_effect("clock_skew", STARTS | {"waves": 0.0})
    assert second_waves(SimpleNamespace(), plant, CLOCK_SKEW) == []


@pytest.mark.slow
def test_rows_that_are_late_by_chance_are_named():
    said = diagnose(restamped(concealed((), seed=2203, seconds=14.0), 1, 0.04)).diagnosis
    assert said.verdict == "explained"
    assert [one.id for one in said.effects] == ["clock_skew"]
    assert said.effects[0].params["lag_span_s"].value == pytest.approx(0.04, rel=0.35)
    assert said.effects[0].params["lag_waves"].value == 0.0
    assert any(note.startswith("Each row is stamped late by chance") for note in said.notes)
    two_s = next(one for one in said.fit.horizons if one.seconds == 2.0)
    assert two_s.improved < 0.6 * two_s.baseline


def seldom_late(rng, taken_s, mean_s):
    """One row of six very late, and none before the row above it."""
    late_s = np.where(rng.random(taken_s.size) < 1.0 / 6.0, rng.exponential(mean_s, taken_s.size), 0.0)
    return np.maximum.accumulate(taken_s + late_s)


@pytest.mark.slow
def test_rows_that_are_late_seldom_are_named_and_all_others_keep_their_worth():
    said = diagnose(restamped(concealed((), seed=2204, seconds=14.0), 2, 0.02, seldom_late)).diagnosis
    assert (said.verdict, [one.id for one in said.effects]) == ("explained", ["clock_skew"])
    two_s = next(one for one in said.fit.horizons if one.seconds == 2.0)
    assert two_s.improved < 0.35 * two_s.baseline


@pytest.mark.parametrize(
    ("share", "turned", "told"),
    [(0.03, 1.0, True), (0.03, 0.6, True), (0.03, 0.4, False), (0.015, 1.0, False)],
)
def test_rows_that_came_at_once_have_waited_where_the_motor_had_turned(share, turned, told):
    """By half as far as between other rows, or more; where polls come in bursts it had not."""
    rng = np.random.default_rng(18)
    stamps_s = np.cumsum(
        0.01 + 0.006 * np.sin(np.arange(ROWS) / 20.0)
    )  # slow and quick in turn: no times go against
    waits = 2 + 3 * rng.choice(ROWS // 3 - 1, int(share * ROWS), replace=False)
    stamps_s[waits] = stamps_s[waits - 1]
    moved = np.where(np.diff(stamps_s, prepend=-1.0) == 0.0, turned, 1.0)
    (found,) = with_lateness([turning(np.cumsum(moved), stamps_s)])
    assert (found.late_span_s > 0.0) is told


@pytest.mark.parametrize(("effect", "starts"), [("clock_skew", [0.0, 1.0]), ("command_delay", [])])
def test_a_clock_is_settled_with_commands_that_are_late_and_with_punctual_ones(effect, starts):
    plant = problem_for(clean_case(12)).plant
    fits = SimpleNamespace(problem=SimpleNamespace(signals=[SimpleNamespace(late_span_s=0.01)]))
    effect = plant.layout.effect(effect)
    found = Fits.stamped_late(fits, plant, effect)
    assert sorted(one.values[Slot(effect.id, "of_commands")] for one in found) == starts
    fits.problem.signals[0].late_span_s = 0.0
    assert Fits.stamped_late(fits, plant, effect) == []
