"""docs/formats.md names what the code reads and writes."""

import re
from pathlib import Path
from typing import get_args

import pytest

from nxt_twin.recording.case import CaseFile
from nxt_twin.recording.columns import CATALOGUE
from nxt_twin.recording.mapping import (
    InputSource,
    Mapping,
    ModeSource,
    OutputSource,
    SplitColumn,
    SupplySource,
    TableFormat,
    TimeSource,
)
from nxt_twin.recording.program import MotorProgram, Run, Segment
from nxt_twin.recording.recording import InputKind, OutputKind

PAGE = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")


def named(section):
    """Every name in code marks, and every word of the examples, of one section."""
    body = PAGE.split(f"\n## {section}\n")[1].split("\n## ")[0]
    return set(re.findall(r"[\w/]+", " ".join(re.findall(r"`[^`]+`|(?m:^    .*$)", body))))


def test_every_column_stands_in_it():
    ports_and_slots = {
        re.sub(r"^[bc]_", "a_", re.sub(r"^s[234]_(?!ultra)", "s1_", name)) for name in CATALOGUE
    }
    told = named("Recordings") | {f"s{n}_ultrasonic_cm" for n in (2, 3)}
    assert ports_and_slots <= told


@pytest.mark.parametrize(
    ("section", "models"),
    [
        (
            "Mapping files",
            [
                Mapping,
                TableFormat,
                TimeSource,
                InputSource,
                OutputSource,
                SupplySource,
                ModeSource,
                SplitColumn,
            ],
        ),
        ("Cases", [CaseFile]),
        ("Motor programs", [MotorProgram, Run, Segment]),
    ],
)
def test_every_key_stands_in_it(section, models):
    keys = {key for model in models for key in model.model_fields}
    assert keys - named(section) <= {"name"}


def test_every_kind_stands_in_it():
    assert {*get_args(InputKind), *get_args(OutputKind)} <= named("Mapping files")
