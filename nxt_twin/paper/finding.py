"""A number recomputed, and a contradiction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Comparison:
    """A number of the paper beside the same number computed from the paper's data.

    Attributes:
        quantity: what it is.
        where: table, equation or section.
        unit: of both.
        printed: what the paper prints, as it prints it.
        computed: what its own data give.
        agrees: whether the printed number is the computed one, rounded to the digits that are printed.
    """

    quantity: str
    where: str
    unit: str
    printed: str
    computed: float
    agrees: bool

    @property
    def shown(self) -> str:
        """The computed number written as the printed one is, with one digit more."""
        mantissa, power, _ = self.printed.lower().partition("e")
        decimals = len(mantissa.partition(".")[2]) + 1
        return powers(self.computed, decimals) if power else f"{self.computed:.{decimals}f}"


@final
@dataclass(frozen=True)
class Contradiction:
    """Where the paper disagrees with itself.

    Attributes:
        id: a name for it.
        title: what is wrong, in a few words.
        where: table, equation or section.
        claim: what the paper says.
        evidence: what its own data or equations say.
        cause: what probably happened.
        used: what this project uses instead.
    """

    id: str
    title: str
    where: str
    claim: str
    evidence: str
    cause: str
    used: str


def powers(value: float, decimals: int) -> str:
    """`8.451e-3`: a number with `decimals` and a power of ten without leading zeros."""
    mantissa, _, exponent = f"{value:.{decimals}e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def compare_printed(quantity: str, where: str, unit: str, printed: str, computed: float) -> Comparison:
    """Compare a printed number, digits as printed, with a computed one."""
    mantissa, _, exponent = printed.lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) - int(exponent or 0)
    half_digit = 0.5 * 10.0**-decimals
    agrees = abs(float(printed) - computed) <= half_digit * (1.0 + 1e-9)
    return Comparison(quantity, where, unit, printed, float(computed), bool(agrees))
