"""`nxt-twin mock`: serve a brick made of software until interrupted."""

from __future__ import annotations

import json as json_format
import signal
import time
from pathlib import Path
from typing import Annotated, final

import typer

from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.mock.run import Served, serve


@final
class _MachineClock:
    def now_s(self) -> float:
        return time.monotonic()

    def sleep(self, duration_s: float) -> None:
        time.sleep(duration_s)


def mock(
    tcp: Annotated[str | None, typer.Option(metavar="HOST:PORT", help="Listen here; port 0 is any.")] = None,
    pty: Annotated[Path | None, typer.Option(metavar="LINK", help="Link to a pseudo-terminal.")] = None,
    world: Annotated[Path | None, typer.Option(metavar="FILE", help="What surrounds the brick.")] = None,
    seed: Annotated[int, typer.Option(help="Of noise, jitter and faults.")] = 0,
    profile: Annotated[str, typer.Option(help="Delays of the link: none, usb or bluetooth.")] = "none",
    json: JsonOption = None,
) -> None:
    """Serve a mock brick until interrupted; framing as on Bluetooth."""

    def announce(served: Served) -> None:
        if json:
            answer = {"schema": "nxt-twin/mock/1", "name": served.name, "urls": served.urls}
            emit_json(json, json_format.dumps(answer))
        if json != "-":
            print(f"Mock brick '{served.name}' at {'  '.join(served.urls)}", flush=True)

    # A shell starts background jobs with the interrupt ignored; both signals are to end the mock tidily.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    try:
        serve(
            clock=_MachineClock(),
            announce=announce,
            tcp=tcp,
            pty=pty,
            world=world,
            seed=seed,
            profile=profile,
        )
    except KeyboardInterrupt:
        return
