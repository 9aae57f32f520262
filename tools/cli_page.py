"""The reference of the commands, written from the program itself."""

from __future__ import annotations

from collections.abc import Iterator

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption

from nxt_twin.cli.app import program

Command = TyperCommand | TyperGroup

_HEAD = """\
# Commands

This page is written from the program: `nxt-twin COMMAND --help` prints each part of it.
Options that take `FILE|-` write to standard output with `-`.
[Exit statuses](../formats.md#exit-statuses) are alike for all commands.
"""


def page() -> str:
    """The text of the page: a section for each command, with its arguments and options."""
    return "\n".join([_HEAD, *(line for names, command in commands() for line in _section(names, command))])


def commands() -> Iterator[tuple[str, Command]]:
    """Each command with the words that call it, such as ``blind make``; a group comes before its commands."""
    root = typer.main.get_command(program())
    yield from _below(root, "")


def parameters(command: Command) -> list[TyperArgument | TyperOption]:
    """The arguments and options of a command, without `--help`."""
    return [
        one for one in command.params if one.name not in ("help", "install_completion", "show_completion")
    ]


def _below(group: TyperGroup, before: str) -> Iterator[tuple[str, Command]]:
    for name, command in group.commands.items():
        words = f"{before} {name}".strip()
        yield words, command
        if isinstance(command, TyperGroup):
            yield from _below(command, words)


def _section(names: str, command: Command) -> Iterator[str]:
    context = command.context_class(command, info_name=f"nxt-twin {names}")
    yield f"{'###' if ' ' in names else '##'} {names}\n"
    yield f"    {' '.join(command.get_usage(context).removeprefix('Usage: ').split())}\n"
    yield f"{_prose(command.help or '')}\n"
    rows = [one.get_help_record(context) for one in parameters(command)]
    if rows:
        yield "| argument or option | meaning |"
        yield "| --- | --- |"
        yield from (f"| `{' '.join(name.split())}` | {_cell(meaning)} |" for name, meaning in rows)
        yield ""


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _prose(text: str) -> str:
    """Help as Markdown, without the marks that keep the terminal's line breaks."""
    return text.replace("\b\n", "").replace("\f", "").strip()
