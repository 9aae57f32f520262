"""Robots before and after a touch, by seed: how often a comparison names exactly what was done."""

from __future__ import annotations

import sys

from nxt_twin.blind.robot.pairs import pairs_as_text, solve_pairs

if __name__ == "__main__":
    first, last = map(int, sys.argv[1:3])
    outcomes = []
    for outcome in solve_pairs(range(first, last + 1)):
        outcomes.append(outcome)
        print(f"{outcome.seed}: {'exact' if outcome.exact else 'not exact'}", file=sys.stderr, flush=True)
    print(*pairs_as_text(outcomes), sep="\n")
