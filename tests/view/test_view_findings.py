"""What the report shows of doubt: intervals, sources, onsets, sizes that would have been seen, the next program."""

from dataclasses import replace

import numpy as np
import pytest
import view_samples as samples
from test_view_report import Page, svgs_of

from nxt_twin.diagnose.diagnosis import (
    DetectableSize,
    Estimate,
    Excitation,
    FalseAlarmRate,
    Moved,
    Nearest,
    NextExperiment,
    Onset,
    Ratio,
    SourceFinding,
)
from nxt_twin.recording.program import MotorProgram, Run, Segment
from nxt_twin.view.report import render_report

SIZES = (
    DetectableSize("stiction", "Stribeck stiction", "breakaway_torque_nm", 0.00868, "N·m", seen_above=True),
    DetectableSize("current_limit", "current limit", "current_limit_a", 0.936, "A", seen_above=False),
    DetectableSize("backlash", "backlash", "gap_deg", None, "deg", seen_above=True),
)
ANCHORS = ("resistance_ohm", "torque_constant_nm_per_a")


def full():
    """An explained diagnosis with everything that may be said."""
    plain = samples.explained(runs=2, samples=700)
    program = MotorProgram(
        name="a-or-b", runs=(Run(name="told-apart", segments=(Segment(duration_s=1.0, power_pct=40),)),)
    )
    gravity = replace(
        samples.GRAVITY,
        params={
            "gravity_torque_nm": Estimate(
                0.0171, 0.0006, "N·m", (0.0159, 0.0183), ANCHORS, Ratio(14.2, 0.1, "1/s²", "inertia_kg_m2")
            )
        },
    )
    return replace(
        plain,
        effects=(gravity,),
        refit={"inertia_kg_m2": Moved(0.0012, 0.00119, 0.00002, "kg·m²", (0.00115, 0.00123), ANCHORS)},
        mismatch=replace(
            plain.mismatch,
            source="actuator",
            sources=(
                SourceFinding("actuator", "torque_balance", 812.0, 1e-300),
                SourceFinding("battery", "electrical", 760.0, 1e-200),
            ),
            onsets=(Onset("gravity_load", "run_02.csv", 6.31, 6.2, 6.4, 88.0, 0.005),),
        ),
        next_experiment=NextExperiment("A or B", "reversals, about 40 s", 10.0, 40.0, program),
        detectable=SIZES,
        excitation=Excitation(enough=True, lacks=(), unseen=("backlash",)),
        false_alarm_rate=FalseAlarmRate(0.0, 0.0133, 200),
    )


@pytest.fixture(scope="module")
def page():
    return Page(render_report(full()))


def test_the_sentence_then_the_picture_then_numbers_doubt_and_what_to_try(page):
    assert page.sections == ["verdict", "picture", "numbers", "doubt", "next", "leftover", "footer"]
    assert page.open_tags == []


def test_intervals_ratios_and_anchors_are_told(page):
    numbers = page.text("numbers")
    for shown in ("95 %: 0.0159 … 0.0183", "per inertia: 14.20 ± 0.10 1/s²", "0.00115 … 0.00123"):
        assert shown in numbers
    assert "rest on the anchors resistance and torque constant" in numbers


def test_the_equations_compete_and_the_moment_is_named(page):
    numbers = page.text("numbers")
    for shown in ("a torque in the actuator", "the battery, the bridge or the winding", "812", "52.0"):
        assert shown in numbers
    assert "gravity_load sets in at 6.31 s of run_02.csv" in numbers
    assert "between 6.20 and 6.40 s" in numbers


def test_what_would_have_been_seen_is_listed_with_its_side(page):
    doubt = page.text("doubt")
    for shown in ("≥ 0.0087", "≤ 0.94", "not at all", "Of 200 synthetic clean recordings", "1.3 %"):
        assert shown in doubt
    assert "details" in page.tags


@pytest.mark.usefixtures("undrawn")
def test_the_program_is_offered_where_there_is_one(page):
    assert "--experiment-out" in page.text("next")
    plain = Page(render_report(samples.explained(runs=1, samples=300)))
    assert "--experiment-out" not in plain.text("next")


@pytest.mark.usefixtures("undrawn")
def test_too_little_excitation_and_the_nearest_effect_are_said():
    poor = replace(
        samples.brief(samples.adequate()),
        excitation=Excitation(enough=False, lacks=("it never turns the other way",), unseen=("stiction",)),
        detectable=SIZES,
    )
    text = Page(render_report(poor)).text("doubt")
    assert "Too little happened to show everything: it never turns the other way" in text
    assert "What would have been seen" in text
    strange = replace(
        samples.brief(samples.unexplained()), nearest=Nearest("cogging", "cogging", "free runs get worse")
    )
    assert "cogging (cogging) comes nearest to what is left, and was not accepted: free runs get worse" in (
        Page(render_report(strange)).text("doubt")
    )


def test_what_is_left_is_drawn_against_the_current_too():
    plain = samples.brief(samples.unexplained())
    leftover = replace(plain.leftover, drive=np.sin(plain.leftover.time_s), drive_label="current (A)")
    drawn = "".join(svgs_of(Page(render_report(replace(plain, leftover=leftover)))))
    assert "current (A)" in drawn
    assert "current (A)" not in "".join(svgs_of(Page(render_report(plain))))
