"""Numbers as a person reads them: rounded to what their doubt allows, with a true minus sign."""

from __future__ import annotations

import math

UNKNOWN = "–"
_MINUS = "−"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST_DIGITS = 7
_LOWEST, _HIGHEST = -4, 6  # exponents between these are written out
_TWO_DIGITS_BELOW = 3.55  # a doubt that begins with less than this keeps its second digit


def power_of_ten(exponent: int) -> str:
    """`10⁻⁹` for -9."""
    return "10" + str(exponent).translate(_RAISED)


def _exponent(value: float) -> int:
    return math.floor(math.log10(abs(value)))


def _signed(text: str) -> str:
    return text.replace("-", _MINUS)


def plain(value: float, digits: int = 3) -> str:
    """`value` with `digits` significant digits; very small and very large ones as a power of ten."""
    if math.isnan(value):
        return UNKNOWN
    if math.isinf(value):
        return "∞" if value > 0 else f"{_MINUS}∞"
    if value == 0:
        return "0"
    exponent = _exponent(value)
    if _LOWEST < exponent < _HIGHEST:
        return _signed(f"{value:.{max(0, digits - 1 - exponent)}f}")
    return _signed(f"{value / 10.0**exponent:.{digits - 1}f} × {power_of_ten(exponent)}")


def rough(value: float) -> str:
    """`value` with two significant digits, for sizes that are right within a factor of two."""
    return plain(value, 2)


def with_doubt(value: float, std: float) -> str:
    """`0.0312 ± 0.0021`: the standard deviation to one or two digits, the value to the same place."""
    if not math.isfinite(value):
        return plain(value)
    if not math.isfinite(std):
        return f"{plain(value)} ± ?"
    if std <= 0:
        return plain(value, 4)
    largest = _exponent(max(abs(value), std))
    shift = 0 if _LOWEST < largest < _HIGHEST else largest
    scaled, doubt = value / 10.0**shift, std / 10.0**shift
    place = _exponent(doubt)
    place -= doubt / 10.0**place < _TWO_DIGITS_BELOW
    if largest - shift - place >= _MOST_DIGITS:
        return f"{plain(value, _MOST_DIGITS)} ± {plain(std, 2)}"
    decimals = max(0, -place)
    text = f"{_signed(f'{round(scaled, -place):.{decimals}f}')} ± {round(doubt, -place):.{decimals}f}"
    return text if shift == 0 else f"({text}) × {power_of_ten(shift)}"


def change(before: float, after: float) -> str:
    """How far a parameter moved: in percent, or as a multiple where percent would be long."""
    if before == 0 or not math.isfinite(after / before):
        return UNKNOWN
    multiple = after / before
    if multiple > 10:
        return f"× {plain(multiple, 2)}"
    percent = 100.0 * (after - before) / abs(before)
    if abs(percent) >= 9.95:
        return _signed(f"{percent:+.0f} %")
    return "0.0 %" if abs(percent) < 0.05 else _signed(f"{percent:+.1f} %")


def times_smaller(before: float, after: float) -> str:
    """`13.6 times smaller` for errors `before` and `after` an improvement; empty where it is none."""
    if not after > 0 or not math.isfinite(before) or before / after < 1.005:
        return ""
    ratio = before / after
    return (
        f"{ratio:.2f} times smaller"
        if ratio < 2
        else f"{plain(ratio, 2 if ratio < 100 else 3)} times smaller"
    )


def chance(probability: float) -> str:
    """A probability in percent that never reads as certain or impossible."""
    if math.isnan(probability):
        return UNKNOWN
    percent = 100.0 * probability
    if percent > 99.9:
        return "> 99.9 %"
    if percent < 0.1:
        return "< 0.1 %"
    return f"{percent:.1f} %" if percent < 9.95 or percent >= 99 else f"{percent:.0f} %"


def p_value(p: float) -> str:
    """`p = 0.03`, `p = 2 × 10⁻⁹`, or `p < 10⁻¹⁶` where double precision ends."""
    if math.isnan(p):
        return f"p {UNKNOWN}"
    if p < 1e-16:
        return f"p < {power_of_ten(-16)}"
    if p < 1e-3:
        digit, exponent = f"{p:.0e}".split("e")
        return f"p = {digit} × {power_of_ten(int(exponent))}"
    return f"p = {plain(p, 2)}"


def tenths(value: float) -> str:
    """`8.8`: one digit after the point, for columns that are read down."""
    return _signed(f"{value:.1f}") if abs(value) < 1e4 else plain(value)


def seconds(time_s: float) -> str:
    """A stamp with hundredths, `812.30`: digits after the point matter, not significant ones."""
    return _signed(f"{time_s:.2f}") if math.isfinite(time_s) else UNKNOWN
