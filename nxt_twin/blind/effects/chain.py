"""Concealed faults of timing and encoder."""

from __future__ import annotations

from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation


def _command_delay(now: Situation) -> Draw:
    delay_s = now.sized((5e-3, 10e-3), (15e-3, 30e-3), (45e-3, 80e-3))
    return Draw(params={"delay_s": delay_s}, sensing={"delay_s": delay_s})


def _clock_skew(now: Situation) -> Draw:
    span_s = now.sized((8e-3, 12e-3), (20e-3, 35e-3), (60e-3, 0.1))
    rate_error = now.sign() * now.between(1e-3, 1e-2)
    return Draw(
        params={"lag_span_s": span_s, "rate_error": rate_error},
        sensing={
            "rate_error": rate_error,
            "lag_span_s": span_s,
            "lag_period_s": now.between(2.0, 8.0),
            "lag_phase": float(now.rng.random()),
            "lag_triangle": now.one_of(0.0, 1.0),
        },
    )


def _stale_samples(now: Situation) -> Draw:
    share = now.sized((0.015, 0.025), (0.04, 0.08), (0.12, 0.25))
    return Draw(params={"stale_fraction": share}, sensing={"stale_fraction": share})


def _missed_counts(now: Situation) -> Draw:
    share = now.sized((0.02, 0.035), (0.06, 0.1), (0.15, 0.3))
    above = now.between(4.0, 8.0)
    return Draw(
        params={"loss_fraction": share, "speed_threshold_rad_s": above},
        motor={"lost_fraction": share, "lost_above_rad_s": above},
    )


def _encoder_eccentricity(now: Situation) -> Draw:
    amplitude = now.sized((0.8, 1.2), (2.0, 3.0), (5.0, 8.0))
    cycles = now.one_of(1.0, 1.0, 2.0)
    return Draw(
        params={"amplitude_deg": amplitude, "cycles_per_turn": cycles},
        sensing={
            "eccentricity_deg": amplitude,
            "eccentricity_cycles": cycles,
            "eccentricity_phase_rad": now.angle_rad(),
        },
    )


CHAIN: tuple[ConcealedEffect, ...] = (
    ConcealedEffect("command_delay", "timing", _command_delay),
    ConcealedEffect("clock_skew", "timing", _clock_skew),
    ConcealedEffect("stale_samples", "timing", _stale_samples),
    ConcealedEffect("missed_counts", "measurement", _missed_counts),
    ConcealedEffect("encoder_eccentricity", "measurement", _encoder_eccentricity),
)
