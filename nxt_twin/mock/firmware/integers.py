"""The integer arithmetic of the brick's processor: truncating division, narrow types."""

from __future__ import annotations


def quotient(dividend: int, divisor: int) -> int:
    """Integer division that rounds towards zero; 0 for a divisor of 0, as on the brick."""
    if divisor == 0:
        return 0
    magnitude = abs(dividend) // abs(divisor)
    return magnitude if (dividend < 0) == (divisor < 0) else -magnitude


def remainder(dividend: int, divisor: int) -> int:
    """What `quotient` leaves, with the sign of the dividend."""
    return dividend - divisor * quotient(dividend, divisor)


def bounded(value: int, limit: int) -> int:
    """The value, kept within ±limit."""
    if value > limit:
        return limit
    return -limit if value < -limit else value


def s8(value: int) -> int:
    """The value as a signed byte holds it."""
    return (value + 0x80 & 0xFF) - 0x80


def s16(value: int) -> int:
    """The value as a signed 16-bit word holds it."""
    return (value + 0x8000 & 0xFFFF) - 0x8000


def s32(value: int) -> int:
    """The value as a signed 32-bit word holds it."""
    return (value + 0x80000000 & 0xFFFFFFFF) - 0x80000000


def u16(value: int) -> int:
    """The value as an unsigned 16-bit word holds it."""
    return value & 0xFFFF


def u32(value: int) -> int:
    """The value as an unsigned 32-bit word holds it."""
    return value & 0xFFFFFFFF


def sign_of(value: int) -> int:
    """1 for a positive value, else -1."""
    return 1 if value > 0 else -1
