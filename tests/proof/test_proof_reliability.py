"""The programs of `make fuzz` and `make soak`, as short as they can be run."""

from __future__ import annotations

import os

import pytest

from benchmarks import ledger
from benchmarks.reliability import cuts, flips, fuzz

pytestmark = pytest.mark.skipif(os.name == "nt", reason="uses signals and Linux's files about processes")


def test_hostile_inputs_break_no_rule(tmp_path, monkeypatch):
    monkeypatch.setattr(fuzz, "KEPT", tmp_path)
    without_mat = [
        one for name in ("yaml", "url", "csv", "streams", "decoded") for one in fuzz.fuzz(1000, 11, name)
    ]
    assert [line for _, tally in without_mat for line in tally.broken] == []
    assert all(tally.count == tally.read + tally.refused for _, tally in without_mat)
    assert sum(tally.refused for _, tally in without_mat) > 200
    assert not list(tmp_path.iterdir())


def test_what_breaks_a_rule_is_counted_and_kept(tmp_path, monkeypatch):
    def read(_folder, data):
        if len(data) > 20:
            raise ZeroDivisionError("nobody documented this")

    monkeypatch.setattr(fuzz, "KEPT", tmp_path)
    monkeypatch.setattr(fuzz, "parsers", lambda: [fuzz.Parser("a parser", (b"1 2 3",), read, 1.0)])
    ((_, tally),) = fuzz.fuzz(40, 1)
    assert tally.broken
    assert "ZeroDivisionError" in tally.broken[0]
    assert len(list(tmp_path.iterdir())) == len(tally.broken)


def test_flipped_bits_are_told():
    (line,) = flips.report(40, 3)
    assert "silently wrong 0" in line


def test_a_cut_after_any_byte_is_a_named_failure():
    lines = [line for line in cuts.report(every=8) if "cut after" in line]
    assert [line.split()[0] for line in lines] == ["tcp", "serial", "bluetooth"]
    assert not any("ANSWERED" in line for line in lines)


def test_pieces_add_up_over_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(ledger, "FOLDER", tmp_path)
    monkeypatch.setattr(fuzz, "PIECE", 300)
    assert fuzz.main(300, 7, "decoded") == 0
    assert fuzz.main(700, 7, "decoded") == 0
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith("217 inputs in 3 pieces, 0 broke a rule")
    assert fuzz.main(300, 8, "decoded") == 0
    assert "93 inputs in 1 pieces" in capsys.readouterr().out
