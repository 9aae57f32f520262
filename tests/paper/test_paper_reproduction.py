"""The paper recomputed: numbers worked out by hand here, and every contradiction listed."""

import json
import math

import numpy as np
import pytest

from nxt_twin.paper import printed
from nxt_twin.paper.finding import compare_printed
from nxt_twin.paper.motor import mean_absolute_error, model_speed, motor_numbers
from nxt_twin.paper.reproduction import reproduce, to_json
from nxt_twin.paper.touch import TABLES, means, sensor_deviations
from nxt_twin.paper.ultrasonic import line_error_mm
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.view.paper_page import render_paper_page, write_paper_page


def test_both_fits_of_ks_are_those_of_the_normal_equations():
    speed, emf = printed.SPEED_RPM * math.pi / 30, printed.EMF_V
    count, sx, sy = speed.size, speed.sum(), emf.sum()
    slope = (count * (speed * emf).sum() - sx * sy) / (count * (speed**2).sum() - sx**2)
    numbers = motor_numbers()
    assert numbers.ks_slope == pytest.approx(slope, rel=1e-12)
    assert round(numbers.ks_slope, 4) == 0.4919
    assert round(abs(numbers.ks_offset_v), 4) == 0.0218
    assert round(numbers.ks, 4) == 0.4908


def test_static_friction_by_equation_6_is_not_the_printed_one():
    numbers = motor_numbers()
    assert numbers.static_friction_nm == pytest.approx(0.4908 * (0.2519 / 1.9248) / 7.6)
    assert numbers.static_friction_nm / printed.STATIC_FRICTION_NM == pytest.approx(23.75, abs=0.01)


def test_viscous_friction_has_the_least_absolute_error():
    numbers = motor_numbers()
    best = mean_absolute_error(numbers.static_friction_nm, numbers.viscous)
    for factor in (0.98, 0.999, 1.001, 1.02):
        assert mean_absolute_error(numbers.static_friction_nm, factor * numbers.viscous) > best
    with_printed = mean_absolute_error(printed.STATIC_FRICTION_NM, numbers.viscous_with_printed)
    assert with_printed <= mean_absolute_error(printed.STATIC_FRICTION_NM, 1.92e-3)
    assert numbers.viscous == pytest.approx(1.92e-3, rel=0.04)
    assert numbers.viscous_with_printed > 1.25 * 1.92e-3


def test_equation_11_at_rest_and_without_friction():
    stall_v = 7.6 * 8.45e-3 / 0.4908
    speeds = model_speed(np.array([stall_v, 9.0]), 8.45e-3, 0.0)
    assert speeds[0] == pytest.approx(0.0, abs=1e-12)
    assert speeds[1] == pytest.approx((9.0 - stall_v) / 0.4908)


def test_tables_hold_eight_by_eight_readings():
    assert [table.samples.shape for table in TABLES] == [(8, 8)] * 4
    assert means(printed.FORCE_ON)[1] == 62.75
    assert sensor_deviations(printed.FORCE_OFF)[6] == pytest.approx(math.sqrt(3.5 / 8))
    assert (means(printed.FORCE_ON) >= means(printed.FORCE_OFF)).all()
    assert (means(printed.TRAVEL_ON) > means(printed.TRAVEL_OFF)).all()


@pytest.mark.parametrize(
    ("unit", "near", "far"), [("mm", 1.388, 8.263), ("cm", 1.505, 8.38), ("m", 14.375, 21.25)]
)
def test_the_ultrasonic_line_by_unit(unit, near, far):
    assert line_error_mm(250.0, unit) == pytest.approx(near, abs=1e-3)
    assert line_error_mm(1500.0, unit) == pytest.approx(far, abs=1e-3)


@pytest.mark.parametrize(
    ("shown", "computed", "agrees"),
    [("0.4919", 0.49187, True), ("0.4919", 0.49184, False), ("62.3", 62.25, True), ("1.6e-3", 0.0314, False),
     ("1.92e-3", 1.9249e-3, True), ("1.92e-3", 1.9251e-3, False), ("57", 57.4, True)],
)  # fmt: skip
def test_a_printed_number_agrees_within_half_its_last_digit(shown, computed, agrees):
    assert compare_printed("", "", "", shown, computed).agrees is agrees


@pytest.mark.parametrize(
    ("printed_as", "computed", "shown"),
    [("3.558e-4", 8.4513e-3, "8.4513e-3"), ("24.39", 24.39999, "24.400"), ("57", 57.0, "57.0"), ("0", 0.0, "0.0")],
)  # fmt: skip
def test_a_computed_number_is_written_as_the_printed_one(printed_as, computed, shown):
    assert compare_printed("", "", "", printed_as, computed).shown == shown


def test_each_disagreeing_number_belongs_to_a_listed_contradiction():
    reproduction = reproduce()
    ids = {contradiction.id for contradiction in reproduction.contradictions}
    owner = {
        "Table I": "table_1_rounding",
        "Table III": "table_3_sensor_2",
        "Table IV": "table_4_variances",
        "Table V": "travel_deviation",
        "Table VI": "travel_deviation",
        "Table II": "static_friction",
    }
    disagreeing = [one for one in reproduction.comparisons if not one.agrees]
    assert {owner[one.where] for one in disagreeing} <= ids
    assert {"viscous_friction_against_static", "average_of_ks", "table_4_sensor_7", "ultrasonic_line"} <= ids
    assert len(ids) == len(reproduction.contradictions) >= 5


def test_json_lists_the_contradictions_and_all_tables():
    document = json.loads(to_json(reproduce()))
    assert document["schema"] == "nxt-twin/reproduction/1"
    assert all(
        contradiction[key]
        for contradiction in document["contradictions"]
        for key in ("id", "where", "claim", "evidence", "cause", "used")
    )
    assert [table["table"] for table in document["touch"]] == ["III", "IV", "V", "VI"]


def test_configs_hold_the_consistent_values_and_the_printed_ones_by_name():
    numbers = motor_numbers()
    mended, as_printed = load_plant_config("nxt_motor"), load_plant_config("nxt_motor_as_printed")
    assert mended["coulomb_friction_nm"] == pytest.approx(numbers.static_friction_nm, rel=1e-3)
    assert as_printed["coulomb_friction_nm"] == printed.STATIC_FRICTION_NM
    apart = {key for key in mended if mended[key] != as_printed[key]}
    assert apart == {"coulomb_friction_nm"}


def test_the_page_shows_figures_and_contradictions_and_needs_nothing_else(tmp_path):
    reproduction = reproduce()
    page = write_paper_page(reproduction, tmp_path / "made").read_text(encoding="utf-8")
    assert page == render_paper_page(reproduction)
    assert page.count('class="wide"') == page.count('class="narrow"') == 7
    for name in (
        "Figure 6",
        "Figures 7 and 8",
        "Figure 9",
        "Figure 14",
        "Figures 11 and 16, MODELLED",
        "Figure 17, MODELLED",
    ):
        assert name in page
    for contradiction in reproduction.contradictions:
        assert contradiction.id in page
    assert "<script" not in page
    assert "http" not in page.replace("http://www.w3.org", "")
