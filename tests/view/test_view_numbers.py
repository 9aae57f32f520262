import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nxt_twin.view.numbers import chance, change, p_value, plain, tenths, times_smaller, with_doubt
from nxt_twin.view.wording import counted, quantity, spelled_out

LOWERED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


def read_back(text):
    mantissa, _, power = text.translate(LOWERED).partition(" × 10")
    return float(mantissa) * 10.0 ** int(power or 0)


def read_estimate(text):
    plain_text = text.translate(LOWERED)
    if plain_text.startswith("("):
        inside, power = re.fullmatch(r"\((.*)\) × 10(.*)", plain_text).groups()
        value, std = (float(part) * 10.0 ** int(power) for part in inside.split(" ± "))
        return value, std
    value, std = text.split(" ± ")
    return read_back(value), read_back(std)


magnitudes = st.floats(1e-12, 1e12)
signed = magnitudes | magnitudes.map(lambda value: -value)


@settings(deadline=None)
@given(signed)
def test_a_plain_number_reads_back_to_half_a_percent(value):
    assert read_back(plain(value)) == pytest.approx(value, rel=0.0051)


@settings(deadline=None)
@given(signed, magnitudes)
def test_an_estimate_reads_back_to_a_fraction_of_its_doubt(value, std):
    read_value, read_std = read_estimate(with_doubt(value, std))
    assert read_std == pytest.approx(std, rel=0.15)
    assert abs(read_value - value) <= 0.51 * std + 1e-6 * abs(value)


@settings(deadline=None)
@given(signed, magnitudes)
def test_no_number_is_longer_than_a_table_cell(value, std):
    assert len(with_doubt(value, std)) <= 40
    assert len(plain(value)) <= 14


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (0.0312, 0.0021, "0.0312 ± 0.0021"),
        (0.0021, 0.00004, "0.00210 ± 0.00004"),
        (-3.2, 2.4, "−3.2 ± 2.4"),
        (1.2345e7, 2.3e4, "(1.2345 ± 0.0023) × 10⁷"),
        (2.3456e-9, 3e-11, "(2.346 ± 0.030) × 10⁻⁹"),
        (-3e-12, 9e-12, "(−3 ± 9) × 10⁻¹²"),
        (12.0, 340.0, "10 ± 340"),
        (7.6, 0.0, "7.600"),
        (7.6, math.nan, "7.60 ± ?"),
        (7.6, math.inf, "7.60 ± ?"),
        (math.nan, 1.0, "–"),
    ],
)
def test_estimates_are_rounded_to_their_doubt(value, std, text):
    assert with_doubt(value, std) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(31.2, "31.2"), (0.4, "0.400"), (-1e-9, "−1.00 × 10⁻⁹"), (0.0, "0"), (math.inf, "∞"), (-math.inf, "−∞")],
)
def test_plain_numbers_carry_three_digits(value, text):
    assert plain(value) == text


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        (0.00192, 0.0021, "+9.4 %"),
        (-0.5, -0.623, "−25 %"),
        (95.0, 123456.7, "× 1300"),
        (0.0, 20.0, "–"),
        (2.0, 1.0, "−50 %"),
        (2.0, 1.9995, "0.0 %"),
    ],
)
def test_a_moved_parameter_says_how_far(before, after, text):
    assert change(before, after) == text


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        (31.2, 2.3, "14 times smaller"),
        (3.0, 2.0, "1.50 times smaller"),
        (2.0, 2.0, ""),
        (1.0, 2.0, ""),
        (1.0, 0.0, ""),
        (math.inf, 1.0, ""),
    ],
)
def test_an_improvement_is_claimed_only_where_there_is_one(before, after, text):
    assert times_smaller(before, after) == text


@pytest.mark.parametrize(
    ("probability", "text"),
    [
        (1.0, "> 99.9 %"),
        (0.0, "< 0.1 %"),
        (0.97, "97 %"),
        (0.995, "99.5 %"),
        (0.02, "2.0 %"),
        (math.nan, "–"),
    ],
)
def test_no_probability_reads_as_certain(probability, text):
    assert chance(probability) == text


@pytest.mark.parametrize(
    ("p", "text"),
    [
        (0.0, "p < 10⁻¹⁶"),
        (2.1e-9, "p = 2 × 10⁻⁹"),
        (9.97e-4, "p = 1 × 10⁻³"),
        (0.034, "p = 0.034"),
        (math.nan, "p –"),
    ],
)
def test_p_values_are_short(p, text):
    assert p_value(p) == text


def test_strengths_share_one_place_after_the_point():
    assert [tenths(value) for value in (14.23, 8.0, -0.75)] == ["14.2", "8.0", "−0.8"]


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("breakaway_torque_nm", "breakaway torque"),
        ("viscous_friction_nm_s_per_rad", "viscous friction"),
        ("load_inertia_kg_m2", "load inertia"),
        ("friction_per_torque", "friction per torque"),
        ("exponent", "exponent"),
    ],
)
def test_parameter_keys_become_words_without_their_unit(key, words):
    assert spelled_out(key) == words


@pytest.mark.parametrize(
    ("channel", "words"),
    [("a_tacho_deg", "tacho A"), ("s1_ultrasonic_cm", "ultrasonic S1"), ("output", "output"), ("", "output")],
)
def test_channels_become_words(channel, words):
    assert quantity(channel) == words


def test_counts_agree_with_their_noun():
    assert [counted(count, "run") for count in (1, 2, 13)] == ["one run", "two runs", "13 runs"]
