"""`nxt-twin mock`: serve a brick made of software until interrupted."""

from __future__ import annotations

import json as json_format
import signal
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.api.openers import concealing, world_bodies
from nxt_twin.brick.clock import SystemClock
from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, fail
from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.run import Served, parse_address, serve
from nxt_twin.mock.serve.profile import LinkProfile

UsbFakeOption = Annotated[
    Path | None,
    typer.Option(metavar="SCRIPT", help="Run this Python program, which finds the brick on USB, and end."),
]
ArgumentOption = Annotated[
    list[str] | None, typer.Option(help="An argument of that program; may be given again.")
]
WorldOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="World file, or a built-in world: what surrounds the brick."),
]
ConcealOption = Annotated[
    str | None,
    typer.Option(
        metavar="SEED|FILE",
        help="Conceal an effect in motor A, from a seed or a file; nxt-twin blind reveal prints it.",
    ),
]


def _place(tcp: str | None) -> str | None:
    """Refuse what is not HOST:PORT as wrong use."""
    try:
        if tcp is not None:
            parse_address(tcp)
    except ServeError as error:
        raise typer.BadParameter(str(error)) from error
    return tcp


def mock(
    tcp: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT",
            callback=_place,
            help="Listen here; without any place: localhost:7000, where connect looks.",
        ),
    ] = None,
    tcp_raw: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT",
            callback=_place,
            help="Listen here for nxt-python's socket backend, unframed.",
        ),
    ] = None,
    pty: Annotated[Path | None, typer.Option(metavar="LINK", help="Link to a pseudo-terminal.")] = None,
    usb_fake: UsbFakeOption = None,
    argument: ArgumentOption = None,
    world: WorldOption = None,
    seed: Annotated[int, typer.Option(help="Random seed of noise, jitter and faults.")] = 0,
    profile: Annotated[LinkProfile, typer.Option(help="Delays of the link.")] = "none",
    conceal: ConcealOption = None,
    json: JsonOption = None,
) -> None:
    """Serve a mock brick until interrupted. Telegrams are framed as on Bluetooth.

    With --usb-fake, the brick is on the USB of one program, in real time, until this program ends. Exit status 1 if it
    fails.
    """

    def announce(served: Served) -> None:
        if json:
            answer = {"schema": "nxt-twin/mock/1", "name": served.name, "urls": served.urls}
            emit_json(json, json_format.dumps(answer))
        if json != "-":
            print(f"Mock brick '{served.name}' at {'  '.join(served.urls)}", flush=True)

    # A shell starts background jobs with the interrupt ignored; both signals are to end the mock tidily.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    with suppress(KeyboardInterrupt):
        tell_of_compiling()
        if usb_fake is not None:
            _run_on_usb(usb_fake, argument or (), world, seed, conceal)
            return
        serve(
            clock=SystemClock(),
            announce=announce,
            tcp=tcp,
            tcp_raw=tcp_raw,
            pty=pty,
            world=world,
            seed=seed,
            profile=profile,
            change=concealing(conceal),
            bodies=world_bodies,
        )


def _run_on_usb(
    script: Path, arguments: Sequence[str], world: Path | None, seed: int, conceal: str | None
) -> None:
    """Run a program with the brick on its USB; exit status 1 if it fails."""
    from nxt_twin.mock.serve.program import serve_script

    if not script.is_file():
        raise typer.BadParameter(f"there is no program {script}", param_hint="--usb-fake")
    ending, said = serve_script(
        script,
        arguments,
        SystemClock(),
        world=world,
        seed=seed,
        change=concealing(conceal),
        bodies=world_bodies,
    )
    if ending != "done":
        fail(said)
        raise typer.Exit(1)
