"""The program run in this process, as a user's shell would run it."""

import contextlib
import io
import json
import sys
from typing import NamedTuple
from unittest.mock import patch

import numpy as np

from nxt_twin.cli import main
from nxt_twin.recording.files import read_recording


class Outcome(NamedTuple):
    status: int
    out: str
    err: str

    def json(self):
        """The whole of standard output as one JSON value."""
        return json.loads(self.out)


def run(*arguments):
    """`nxt-twin ARGUMENTS…`: exit status, standard output and standard error."""
    out, err = io.StringIO(), io.StringIO()
    status = 0
    with (
        patch.object(sys, "argv", ["nxt-twin", *map(str, arguments)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as leaving:
            status = leaving.code or 0
    return Outcome(status, out.getvalue(), err.getvalue())


def succeed(*arguments):
    """The same, for what has to end well."""
    outcome = run(*arguments)
    assert outcome.status == 0, outcome.err
    return outcome


def column(path, name):
    """A column of a recording on disk."""
    return np.array(read_recording(path).columns[name])
