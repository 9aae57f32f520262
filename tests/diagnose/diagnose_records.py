"""What a verdict rests on, for tests: a motor with nothing amiss, and one whose missing effect is found."""

from dataclasses import replace

from nxt_twin.diagnose.judging.verdict import Record

QUIET = Record(
    named=0,
    found=False,
    left_nats=0.0,
    left_limit_nats=15.0,
    gained_nats=0.0,
    torque_before=1e-3,
    torque_after=1e-3,
    run_ratio=1.0,
    matters=True,
    worst_ratio=1.0,
    stalled_share=0.0,
    surprise=1.0,
    by_windows=False,
    nearer=1.0,
    least_nats=100.0,
    remaining=10.0,
)
FOUND = replace(
    QUIET, found=True, named=1, gained_nats=500.0, torque_before=2e-2, run_ratio=0.1, worst_ratio=0.1
)
