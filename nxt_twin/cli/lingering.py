"""A dashboard in the browser outlives its session, until the user has seen enough."""

from __future__ import annotations

import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Final, final

from nxt_twin.cli.output import fail
from nxt_twin.cli.wanted import tidy_end
from nxt_twin.twin.records import Event, Tick

if TYPE_CHECKING:
    # It brings in what is wanted by an option alone.
    from nxt_twin.view.dashboard import Dashboard

_LOOK_S: Final = 0.5


@final
class Outliving:
    """Tells a dashboard of a session; the session's end is not the end of what a browser looks at."""

    def __init__(self, dashboard: Dashboard) -> None:
        self._dashboard = dashboard

    def tick(self, tick: Tick) -> None:
        """Hand a poll on."""
        self._dashboard.tick(tick)

    def event(self, event: Event) -> None:
        """Hand an event on."""
        self._dashboard.event(event)

    def close(self) -> None:
        """The session is over."""
        self._dashboard.rest()


def linger(dashboards: Sequence[Dashboard], *, until_interrupted: bool) -> None:
    """End the dashboards; one that is served goes on until Ctrl-C, if so wanted, and says so.

    Troubles are told, one line each.
    """
    pause = threading.Event()
    try:
        for dashboard in dashboards if until_interrupted else ():
            if dashboard.serving:
                print(f"the dashboard is served until Ctrl-C: {dashboard.url}", file=sys.stderr, flush=True)
            with suppress(KeyboardInterrupt), tidy_end():
                while dashboard.serving:
                    pause.wait(_LOOK_S)
    finally:
        for dashboard in dashboards:
            dashboard.close()
        for trouble in (trouble for dashboard in dashboards for trouble in dashboard.troubles):
            fail(trouble)
