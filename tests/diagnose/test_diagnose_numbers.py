"""A number at the top of a module says what it is: in a comment, or in a sentence below it."""

import ast
from pathlib import Path

import pytest

import nxt_twin.diagnose

ROOMS = Path(nxt_twin.diagnose.__file__).parent
SILENT = {
    "fitting": 0,
    "judging": 0,
    "search": 0,
    "where": 0,
    "telling": 0,
    "next": 0,
    "changed": 0,
    "robot_changed": 0,
    "robot": 0,
    "sensor": 0,
}
"""How many numbers of a room may say nothing: these counts may only fall."""


def is_number(node):
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def silent_numbers(text):
    """The lines of numbers at the top of a module that nothing explains."""
    lines, body = text.splitlines(), ast.parse(text).body
    for node, after in zip(body, [*body[1:], ast.Pass()], strict=True):
        if not isinstance(node, ast.Assign | ast.AnnAssign) or not is_number(node.value):
            continue
        told = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        if not told and not any("#" in line for line in lines[node.lineno - 1 : node.end_lineno]):
            yield lines[node.lineno - 1]


@pytest.mark.parametrize("room", SILENT)
def test_numbers_of_a_room_say_what_they_are(room):
    found = [
        f"{file.name}: {line}"
        for file in sorted((ROOMS / room).glob("*.py"))
        for line in silent_numbers(file.read_text(encoding="utf-8"))
    ]
    assert len(found) <= SILENT[room], "\n".join(found)


def test_a_number_is_silent_without_a_comment_or_a_sentence():
    assert list(
        silent_numbers(
            "A = 1.0\nB = -2  # nats\nC = 3\n'''Of effects.'''\nD = (\n    4  # s\n)\nE = 'word'\n"
        )
    ) == ["A = 1.0"]
