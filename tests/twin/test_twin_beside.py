"""Work beside a session."""

import subprocess
import sys
import threading

import pytest

from nxt_twin.twin.beside import Beside

ENDLESS = """
import threading
from nxt_twin.twin.beside import diagnosing
begun = threading.Event()
diagnosing().submit(lambda: (begun.set(), threading.Event().wait()))
begun.wait()
print("over")
"""


def test_what_is_done_beside_is_done_in_a_thread_of_its_own_and_its_outcome_told():
    names = []
    beside = Beside("diagnosis", lambda: names.append(threading.current_thread().name))
    assert beside.submit(divmod, 7, 2).result(10) == (3, 1)
    assert names == ["diagnosis"]
    with pytest.raises(ZeroDivisionError):
        beside.submit(divmod, 7, 0).result(10)


def test_a_program_ends_without_waiting_for_it():
    ended = subprocess.run(
        [sys.executable, "-c", ENDLESS], capture_output=True, text=True, timeout=60, check=True
    )
    assert ended.stdout == "over\n"
