"""Every example in the docstrings of the public face, run as it stands."""

import doctest
import inspect

import pytest

import nxt_twin as nt
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.recording import Recording

FUNCTIONS = [name for name in nt.__all__ if inspect.isfunction(getattr(nt, name))]
PLACES = {"nxt_twin": nt, "Plant.adding": Plant.adding, "Recording.from_arrow": Recording.from_arrow}


def examples(name, thing):
    text, where = inspect.getdoc(thing), inspect.getmodule(thing)
    return doctest.DocTestParser().get_doctest(text, dict(vars(where)), name, None, 0)


@pytest.mark.parametrize("name", [*PLACES, *FUNCTIONS])
def test_the_examples_give_what_they_say(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    test = examples(name, PLACES[name] if name in PLACES else getattr(nt, name))
    assert test.examples, f"{name} has no example"
    told = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    runner.run(test, out=told.append)
    assert not runner.failures, "".join(told)
