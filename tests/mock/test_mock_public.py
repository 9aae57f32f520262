"""What the page about the mock shows works as written."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "mock.md"


def test_the_example_in_the_documentation_runs():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    exec(compile(code, str(PAGE), "exec"), {})


def test_every_quirk_has_its_test():
    text = Path(__file__).with_name("test_mock_quirks.py").read_text(encoding="utf-8")
    assert {int(number) for number in re.findall(r"def test_quirk_(\d+)_", text)} == set(range(1, 37))
