from __future__ import annotations

from benchmarks.mock_fuzz import fuzz


def test_no_telegram_kills_the_mock_or_draws_an_impossible_reply():
    seen = fuzz(15_000, seed=7)
    assert sum(seen.values()) == 15_000
    assert len(seen) > 15
