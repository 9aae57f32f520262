"""`nxt-twin doctor`: what on this machine would keep a brick from being reached, and the mend."""

from __future__ import annotations

import json as json_format
from dataclasses import asdict

import typer
from rich.console import Console
from rich.text import Text

from nxt_twin.brick.doctor.checks import examine
from nxt_twin.brick.doctor.finding import Finding, Severity
from nxt_twin.brick.doctor.gather import gather_facts
from nxt_twin.cli.output import JsonOption, emit_json

_STYLES = {Severity.OK: "green", Severity.WARN: "yellow", Severity.FAIL: "bold red"}


def doctor(
    json: JsonOption = None,
) -> None:
    """Find what on this machine keeps a brick from being reached, and print how to mend it.

    The command changes nothing. Exit status 1 if a check fails.
    """
    findings = examine(gather_facts())
    if json:
        found = [asdict(each) for each in findings]
        emit_json(json, json_format.dumps({"schema": "nxt-twin/doctor/1", "findings": found}))
    if json != "-":
        console = Console(highlight=False, soft_wrap=True)
        for finding in findings:
            console.print(_line(finding))
    if any(finding.verdict is Severity.FAIL for finding in findings):
        raise typer.Exit(1)


def _line(finding: Finding) -> Text:
    line = Text.assemble(
        (f"{finding.verdict:<4}", _STYLES[finding.verdict]), f"  {finding.check}: {finding.what}"
    )
    if finding.why:
        line.append(f"\n      why:  {finding.why}")
    if finding.mend:
        line.append(f"\n      mend: {finding.mend}")
    return line
