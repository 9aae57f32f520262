"""Each table of `strangers` is read as what it is by the mapping that `map` guesses, or refused by what to write."""

import re
from pathlib import Path

import numpy as np
import pytest
import strangers
from strangers import DEG, GOAL, READ, REFUSED, THERE, U, W, write

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.guess.guess import guess_mapping
from nxt_twin.recording.mapped import read_all_mapped
from nxt_twin.recording.mapping import mapping_of

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "import-a-table.md"


def read(path):
    guessed = guess_mapping(path)
    if guessed.lacking is not None:
        raise guessed.lacking
    return read_all_mapped(path, mapping_of(guessed.keys, "guess"))


def joined(recordings, column):
    return np.concatenate([recording.columns[column] for recording in recordings])


def straight(found, expected, atol):
    """They are alike up to an offset, such as a count's at the start."""
    known = np.isfinite(found)
    np.testing.assert_allclose(
        found[known] - found[0], (expected - expected[0])[: found.size][known], atol=atol
    )


@pytest.mark.parametrize("odd", READ)
def test_a_stranger_s_table_is_read_as_what_it_is(tmp_path, odd):
    recordings = read(write(tmp_path / "log", READ[odd]))
    assert len(recordings) == 1 + odd.startswith(("runs", "episodes"))
    kinds = recordings[0].kinds
    elapsed = [recording.time_s - recording.time_s[0] for recording in recordings]
    np.testing.assert_allclose(np.concatenate(elapsed)[:299], strangers.T[:299], atol=0.0101)
    is_goal, is_speed = kinds.input == "goal_position_rad", kinds.output == "speed_rad_per_s"
    wanted = np.degrees(joined(recordings, "input")) if is_goal else joined(recordings, "input")
    size = {"power_pct": 1.0, "voltage_v": 0.08, "goal_position_rad": 1.0}[kinds.input]
    expected = (GOAL if is_goal else U * size)[: wanted.size]
    np.testing.assert_allclose(
        wanted - (wanted[0] - expected[0]), expected, atol=5.0 if "pulses" in odd else 0.6
    )
    reading = joined(recordings, "output")
    if is_speed:
        np.testing.assert_allclose(reading, W, atol=0.01)
    else:
        straight(np.degrees(reading), THERE if is_goal else DEG, atol=1.1)


@pytest.mark.parametrize("wrong", REFUSED)
def test_what_is_no_recording_is_refused_by_what_to_write(tmp_path, refusal, wrong):
    content, part = REFUSED[wrong]
    assert part in refusal(NxtTwinError, read, write(tmp_path / "log.csv", content))


def test_the_page_says_how_many_tables_there_are():
    told = re.search(
        r"(\d+) odd tables .* (\d+) more are refused", PAGE.read_text(encoding="utf-8"), re.DOTALL
    )
    assert told is not None
    assert (int(told[1]), int(told[2])) == (len(READ), len(REFUSED))
