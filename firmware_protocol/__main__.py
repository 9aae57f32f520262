"""Prints the table of telegrams, read from their declarations: ``python -m firmware_protocol``."""

from __future__ import annotations

from firmware_protocol.layout import describe
from firmware_protocol.registry import all_commands


def table() -> str:
    """All telegrams, one line each: type, opcode, name, request and reply as a Markdown table."""
    lines = [
        "| type | opcode | name | request | reply, behind the status |",
        "| --- | --- | --- | --- | --- |",
    ]
    for command in all_commands():
        cells = (
            command.KIND.name.lower(),
            f"{command.OPCODE:02X}",
            command.NAME,
            describe(command),
            describe(command.Reply),
        )
        lines.append(f"| {' | '.join(cell.replace('|', ' or ') or '-' for cell in cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())  # noqa: T201 - printing the table is what the command is for
