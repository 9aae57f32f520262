"""`nxt-twin connect`: say who a brick is, or search for bricks."""

from __future__ import annotations

import json as json_format
import sys
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.api.openers import LOOKING_OPENERS
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.discovery import SEARCH_TIMEOUT_S, default_ways, search_ways
from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.brick.open import open_brick
from nxt_twin.brick.portrait import Portrait, portray
from nxt_twin.brick.search.finding import WayReport
from nxt_twin.cli.output import JsonOption, emit_json, fail


def connect(
    url: Annotated[
        str | None,
        typer.Argument(
            help="usb:, usb:SERIAL, bt:ADDRESS, serial:DEVICE, tcp:HOST:PORT or mock:; without: search."
        ),
    ] = None,
    timeout_s: Annotated[
        float, typer.Option("--timeout", min=0.1, help="How long to search, s.")
    ] = SEARCH_TIMEOUT_S,
    tap: Annotated[Path | None, typer.Option(help="Record every telegram into this file.")] = None,
    json: JsonOption = None,
) -> None:
    """Talk to a brick: who it is, firmware, battery, ports, free flash. Without a URL, search for bricks.

    The command moves nothing. Exit status 1 if no brick is found, or if the brick cannot be reached.
    """
    if url is None:
        _search(timeout_s, json)
    else:
        try:
            _connect(url, tap, json)
        except LinkUrlError as error:
            raise typer.BadParameter(str(error), param_hint="URL") from error


def _connect(url: str, tap: Path | None, json: str | None) -> None:
    clock = SystemClock()
    with (
        nullcontext() if tap is None else tap.open("w", encoding="utf-8") as sink,
        open_brick(url, clock, LOOKING_OPENERS, tap=sink) as brick,
    ):
        portrait = portray(brick)
    if json:
        emit_json(json, json_format.dumps({"schema": "nxt-twin/connect/1", **asdict(portrait)}))
    if json != "-":
        print("\n".join(_portrait_lines(portrait)))
    if turning := [motor for motor in portrait.motors if motor.running and motor.power_pct]:
        were = ", ".join(f"{motor.port} at {motor.power_pct} %" for motor in turning)
        fail(f"the brick drives {were}; nxt-twin stop {url} lets its motors coast")


def _search(timeout_s: float, json: str | None) -> None:
    reports = search_ways(SystemClock(), default_ways(), timeout_s=timeout_s)
    if json:
        ways = [asdict(report) for report in reports]
        emit_json(json, json_format.dumps({"schema": "nxt-twin/search/1", "ways": ways}))
    if json != "-":
        for report in reports:
            _print_way(report)
    if not any(report.bricks for report in reports):
        print("nxt-twin: no brick was found", file=sys.stderr)
        raise typer.Exit(1)


def _portrait_lines(portrait: Portrait) -> list[str]:
    motors = ", ".join(
        f"{motor.port} {motor.tacho_deg}°{' running' if motor.running else ''}" for motor in portrait.motors
    )
    sensors = ", ".join(f"{each.port} {each.sensor_type} {each.raw}" for each in portrait.sensors)
    sleep = f"{portrait.sleep_timeout_s / 60:g} min" if portrait.sleep_timeout_s else "never"
    return [
        f"{portrait.name} at {portrait.link}",
        f"  address   {portrait.bluetooth_address}",
        f"  firmware  {portrait.firmware}, protocol {portrait.protocol}",
        f"  battery   {portrait.battery_v:.2f} V",
        f"  flash     {portrait.free_flash_bytes} bytes free",
        f"  program   {portrait.program or 'none'}",
        f"  sleeps    {sleep}",
        f"  answers   in {1000 * portrait.round_trip_s:.1f} ms",
        f"  motors    {motors}",
        f"  sensors   {sensors}",
    ]


def _print_way(report: WayReport) -> None:
    for brick in report.bricks:
        print(f"{brick.url}    {brick.what}")
    for reason in report.reasons:
        mend = f" ({reason.mend})" if reason.mend else ""
        print(f"{report.way}: {reason.what}{mend}", file=sys.stderr)
