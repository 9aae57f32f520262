"""Run the tutorials: the files that they show are written, their commands run, and the output is compared.

A fenced block with ``title="NAME"`` is a file. In a ``console`` block a line after ``$ `` is a command, and the lines
below it are its output, in which ``...`` stands for anything.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

_FENCE: Final = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LONGEST_S: Final = 300


@final
@dataclass(frozen=True)
class Step:
    """A file to write, or a command to run.

    Attributes:
        file: the file's name; empty for a command.
        text: what the file holds, or the command.
        output: what the command prints, with ``...`` for anything.
    """

    file: str
    text: str
    output: str = ""


def steps(page: str) -> Iterator[Step]:
    """The steps of a page, in order."""
    for language, title, body in _FENCE.findall(page):
        if title:
            yield Step(title, body)
        elif language == "console":
            for said in re.split(r"^\$ ", body, flags=re.MULTILINE)[1:]:
                command, _, output = said.partition("\n")
                yield Step("", command, output)


def matches(expected: str, said: str) -> bool:
    """Whether the output is as expected, apart from blanks at the ends of lines and of the text."""
    wanted = [re.escape(line.strip()).replace(r"\.\.\.", ".*") for line in expected.strip().splitlines()]
    pattern = "\n".join(wanted).replace("\n.*\n", "\n(?:.*\n)*?")
    pattern = re.sub(r"\n\.\*$", r"(?:\n.*)*", re.sub(r"^\.\*\n", r"(?:.*\n)*?", pattern))
    return bool(re.fullmatch(pattern, "\n".join(line.strip() for line in said.strip().splitlines())))


Ran = Callable[[str, Path], subprocess.CompletedProcess[str]]
"""Runs a command in a folder."""


def in_a_shell(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command as a reader does, with this interpreter's programs first in the path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        command, shell=True, cwd=folder, env={**os.environ, "PATH": path}, text=True, check=False,
        stdin=subprocess.DEVNULL, capture_output=True, timeout=_LONGEST_S,
    )  # fmt: skip


def played(page: str, folder: Path, instead: Mapping[str, str], run: Ran = in_a_shell) -> Iterator[str]:
    """Run a page's steps in a folder, and yield a complaint for each command that fails or says something else.

    Args:
        page: The page's text.
        folder: Where files and commands go.
        instead: Words of the commands and what stands in their place, such as ``usb:`` and ``mock:``.
        run: Runs each command.
    """
    for step in steps(page):
        if step.file:
            (folder / step.file).write_text(step.text, encoding="utf-8")
            continue
        command = step.text
        for word, other in instead.items():
            command = command.replace(word, other)
        done = run(command, folder)
        if done.returncode != 0:
            yield f"$ {command}\nleaves with {done.returncode}: {done.stdout}{done.stderr}"
        elif not matches(step.output, done.stdout):
            yield f"$ {command}\nis to say\n{step.output}\nand says\n{done.stdout}{done.stderr}"
