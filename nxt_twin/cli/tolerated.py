"""What commands that judge simulations share: `--tolerance`."""

from __future__ import annotations

from typing import Annotated

import typer

from nxt_twin.cli.output import fail
from nxt_twin.errors import NxtTwinError

ToleranceOption = Annotated[
    str | None,
    typer.Option(
        "--tolerance", help="Error that does not matter (2deg, 0.5mm); else half a step of the encoder or so."
    ),
]


def tolerated(text: str | None) -> float | None:
    """The tolerance in SI units; wrong use where it is none."""
    from nxt_twin.diagnose.tolerance import parse_tolerance

    try:
        return None if text is None else parse_tolerance(text)
    except NxtTwinError as error:
        fail(str(error))
        raise typer.Exit(2) from None
