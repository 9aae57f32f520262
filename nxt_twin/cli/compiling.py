"""The first command on a machine compiles the model: it says so, for a person who waits."""

from __future__ import annotations

import sys

_FIRST = (
    "the first command on this machine compiles the motor's model: half a minute of an idle core, once; "
    "later ones start at once"
)


def tell_of_compiling() -> None:
    """Say on a terminal what is compiled and for how long, where no earlier command has done it."""
    from nxt_twin.physics.kernel import is_compiled
    from nxt_twin.physics.layout import layout

    if sys.stderr.isatty() and not is_compiled(layout("dc_motor", "motor")):
        print(f"nxt-twin: {_FIRST}", file=sys.stderr, flush=True)
