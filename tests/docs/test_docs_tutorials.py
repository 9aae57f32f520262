"""The tutorials do what they say: each command is run in an empty folder, and its output is compared.

What the program does is done in this process. Other commands get a shell.
"""

import contextlib
import io
import shlex
import subprocess
import sys

import pytest

from nxt_twin.cli import main

PAGES = {
    "first-brick": {"usb:": "mock:"},
    "without-a-brick": {},
    "only-a-csv": {},
    "robot-world": {},
}
SLOW = {"without-a-brick", "only-a-csv"}


@pytest.fixture
def here(monkeypatch):
    """Runs `nxt-twin` in this process, whose imports and compiled kernels serve every command."""
    import tutorials

    def run(command, folder):
        words = shlex.split(command)
        if words[0] != "nxt-twin":
            return tutorials.in_a_shell(command, folder)
        out, err, status = io.StringIO(), io.StringIO(), 0
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "argv", words)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                main()
            except SystemExit as leaving:
                status = leaving.code or 0
        return subprocess.CompletedProcess(command, status, out.getvalue(), err.getvalue())

    return run


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in PAGES]
)
def test_every_command_of_the_tutorial_says_what_the_page_says(name, root, tmp_path, monkeypatch, here):
    import tutorials

    if name == "robot-world":
        pytest.importorskip("pybullet")
    monkeypatch.setenv("PYTHONPATH", str(root))
    page = (root / "docs" / "tutorials" / f"{name}.md").read_text(encoding="utf-8")
    assert len([step for step in tutorials.steps(page) if not step.file]) >= 2
    assert list(tutorials.played(page, tmp_path, PAGES[name], here)) == []


@pytest.mark.parametrize(
    ("expected", "said", "alike"),
    [
        ("a\nb\n", "a\nb\n", True),
        ("a\n...\nd\n", "a\nb\nc\nd\n", True),
        ("a\n...\nd\n", "a\nd\n", True),
        ("...\nd\n", "a\nb\nd\n", True),
        ("a\n...\n", "a\nb\nc\n", True),
        ("speed ... deg\n", "speed 3.4 deg\n", True),
        ("a\nb\n", "a\nc\n", False),
        ("a\n", "a\nb\n", False),
        ("speed ... deg\n", "speed 3.4 rad\n", False),
    ],
)
def test_dots_stand_for_anything_and_nothing_else_does(expected, said, alike):
    import tutorials

    assert tutorials.matches(expected, said) is alike


def test_a_command_that_says_something_else_or_fails_is_told(tmp_path):
    import tutorials

    page = '```python title="one.py"\nprint(1)\n```\n\n```console\n$ python one.py\n2\n$ python no-such.py\n```\n'
    wrong, failed = tutorials.played(page, tmp_path, {})
    assert "is to say\n2" in wrong
    assert "leaves with 2" in failed
