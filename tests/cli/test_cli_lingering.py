"""A dashboard in the browser goes on after its session."""

import os
import signal

import pytest

from nxt_twin.cli import lingering
from nxt_twin.cli.lingering import Outliving, linger


class Dashboard:
    """Serves for so many looks, and interrupts its user at one of them."""

    url = "http://127.0.0.1:9/"

    def __init__(self, looks, interrupt_at=-1, troubles=()):
        self.troubles = troubles
        self.said = []
        self._looks = looks
        self._interrupt_at = interrupt_at

    @property
    def serving(self):
        if len(self.said) == self._interrupt_at:
            os.kill(os.getpid(), signal.SIGINT)
        self.said.append("look")
        return len(self.said) <= self._looks

    def rest(self):
        self.said.append("rest")

    def close(self):
        self.said.append("close")


@pytest.fixture(autouse=True)
def _no_pause(monkeypatch):
    monkeypatch.setattr(lingering, "_LOOK_S", 0.0)


def test_the_end_of_a_session_is_not_the_end_of_what_a_browser_looks_at():
    dashboard = Dashboard(0)
    Outliving(dashboard).close()
    assert dashboard.said == ["rest"]


@pytest.mark.parametrize(
    "dashboard", [Dashboard(10**9, interrupt_at=5), Dashboard(5)], ids=["ctrl-c", "gone"]
)
def test_it_is_served_until_an_interrupt_or_its_own_end_and_says_so(dashboard, capsys):
    linger([dashboard], until_interrupted=True)
    assert capsys.readouterr().err == "the dashboard is served until Ctrl-C: http://127.0.0.1:9/\n"
    assert dashboard.said[-1] == "close"
    assert 5 <= dashboard.said.count("look") <= 6


def test_who_has_interrupted_the_session_has_seen_enough(capsys):
    dashboard = Dashboard(10**9, troubles=("the dashboard's file ended with status 1",))
    linger([dashboard], until_interrupted=False)
    assert dashboard.said == ["close"]
    assert capsys.readouterr().err == "nxt-twin: the dashboard's file ended with status 1\n"
