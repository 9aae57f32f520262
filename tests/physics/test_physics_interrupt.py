"""A run of any length heeds an interrupt."""

import os
import signal

import numpy as np
import pytest
from physics_samples import commanded, nxt

from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest


@pytest.mark.skipif(os.name == "nt", reason="no process can be sent an interrupt alone")
@pytest.mark.parametrize(
    "go",
    [
        lambda simulator, plant, job: simulator.trace(plant, job),
        lambda simulator, plant, job: simulator.run(*(each[None] for each in plant.vectors()), [job]),
    ],
    ids=["trace", "run"],
)
def test_an_interrupt_ends_a_run_that_would_take_an_hour(go, monkeypatch):
    plant = nxt()
    endless = commanded([(0.0, 40.0)], seconds=0.0, stamps=np.arange(1_000_000) * 100.0)
    job = free_job(endless, at_rest(endless))
    call = Simulator._call

    def interrupted(self, *arguments):
        os.kill(os.getpid(), signal.SIGINT)
        call(self, *arguments)

    monkeypatch.setattr(Simulator, "_call", interrupted)
    with pytest.raises(KeyboardInterrupt), Simulator(plant.layout, workers=1) as simulator:
        go(simulator, plant, job)


@pytest.mark.skipif(os.name == "nt", reason="no process can be sent an interrupt alone")
def test_an_interrupt_ends_what_goes_on_abreast():
    plant = nxt()
    endless = commanded([(0.0, 40.0)], seconds=0.0, stamps=np.arange(1_000_000) * 100.0)
    job = free_job(endless, at_rest(endless))

    def endlessly(_):
        os.kill(os.getpid(), signal.SIGINT)
        return simulator.trace(plant, job)

    with pytest.raises(KeyboardInterrupt), Simulator(plant.layout, workers=2) as simulator:
        simulator.abreast(endlessly, range(5))
