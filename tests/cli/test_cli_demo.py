"""When the demo has shown all, and how it scores itself; the whole of it runs in `make demo`."""

from types import SimpleNamespace

import pytest

from nxt_twin.cli.demonstration import _score
from nxt_twin.twin.ending import Ending
from nxt_twin.twin.records import Event, Tick


def _at(time_s):
    return Tick(0, time_s, time_s, (), ())


def _told(ending, *events):
    for time_s, kind in events:
        ending.tick(_at(time_s))
        ending.event(Event(time_s, kind, ""))


def test_it_ends_a_while_after_the_divergence_is_gone_with_what_was_adopted():
    ending = Ending()
    _told(ending, (5.0, "divergence"), (9.0, "calm"))
    ending.tick(_at(30.0))
    assert not ending.enough()  # gone by itself: nothing was shown yet
    _told(ending, (31.0, "divergence"), (44.0, "adopted"), (55.0, "calm"))
    assert not ending.enough()
    ending.tick(_at(58.5))
    assert ending.enough()


def test_a_new_divergence_is_waited_for():
    ending = Ending()
    _told(ending, (5.0, "divergence"), (20.0, "adopted"), (30.0, "calm"), (31.0, "divergence"))
    ending.tick(_at(50.0))
    assert not ending.enough()


@pytest.mark.parametrize(
    ("found", "near", "truth", "words"),
    [
        (["spring_load"], [], ["spring_load"], "named exactly"),
        ([], [], [], "rightly, nothing was named"),
        (["spring_load", "stiction"], [], ["spring_load"], "named, but not alone"),
        (["stiction"], ["presliding"], ["presliding"], "named, but not alone"),
        (["stiction"], [], ["backlash"], "missed"),
    ],
)
def test_it_says_how_near_it_came(found, near, truth, words):
    alike = [SimpleNamespace(id=other) for other in near]
    effects = [SimpleNamespace(id=each, confusable_with=alike) for each in found]
    assert _score([SimpleNamespace(effects=effects)], truth).startswith(words)
