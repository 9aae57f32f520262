"""Hold a live session for `live` and `demo`, from the open link to its verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import typer

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import Opener, open_brick
from nxt_twin.cli.lingering import linger
from nxt_twin.cli.output import fail
from nxt_twin.cli.showing import Showing
from nxt_twin.cli.since import differing
from nxt_twin.cli.watching import audience, conclude_watch, get_ready, watch
from nxt_twin.twin.live import LiveOptions, live_sitting
from nxt_twin.twin.outcome import Outcome
from nxt_twin.twin.records import Sink

if TYPE_CHECKING:
    from nxt_twin.api.robots import WatchedRobot

LIVE_SCHEMA = "nxt-twin/live/1"


def hold(
    url: str,
    options: LiveOptions,
    seconds: float | None,
    showing: Showing,
    also: Sequence[Sink] = (),
    robot: WatchedRobot | None = None,
) -> tuple[Outcome, dict[str, Any]]:
    """Hold a session with the brick at `url`, and conclude it; the sinks `also` get its polls and events too.

    A `robot` is watched in the world of a `mock:` URL, and drawn in the dashboard.

    Returns:
        The outcome, and its JSON.

    Raises:
        typer.BadParameter: the URL is wrong.
        typer.Exit: the brick answered no poll.
        NxtTwinError: the link, the model or the recorder failed.
    """
    get_ready(options.plants, adopting=options.adopt)
    clock = SystemClock()
    watching = () if robot is None else (robot,)
    told = audience(tuple(options.plants), options.channels, showing, (*also, *watching))
    openers: Mapping[str, Opener] = OPENERS
    if robot is not None:
        openers = {"mock": robot.open}
        for dashboard in told.dashboards:
            robot.show_in(dashboard.show)
    sitting = live_sitting(options, lambda: open_brick(url, clock, openers), clock, told.sink())
    ended = watch(sitting, seconds, told)
    outcome = sitting.outcome()
    since = differing(sitting, showing.since, options.plants) if showing.since and outcome.polls else None
    document = conclude_watch(outcome, told, showing, since)
    linger(told.dashboards, until_interrupted=ended)
    if not outcome.polls:
        fail("the brick answered no poll, so nothing is recorded; give it more --seconds")
        raise typer.Exit(1)
    return outcome, document
