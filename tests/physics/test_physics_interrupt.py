"""A run of any length heeds an interrupt."""

import os
import signal

import numpy as np
import pytest
from physics_samples import commanded, nxt

from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest


@pytest.mark.skipif(os.name == "nt", reason="no process can be sent an interrupt alone")
@pytest.mark.parametrize("way", ["trace", "run"])
def test_an_interrupt_ends_a_run_that_would_take_an_hour(way, monkeypatch):
    plant = nxt()
    endless = commanded([(0.0, 40.0)], seconds=0.0, stamps=np.arange(1_000_000) * 100.0)
    job = free_job(endless, at_rest(endless))
    call = Simulator._call

    def interrupted(self, *arguments):
        os.kill(os.getpid(), signal.SIGINT)
        call(self, *arguments)

    monkeypatch.setattr(Simulator, "_call", interrupted)
    values, active = plant.vectors()
    with pytest.raises(KeyboardInterrupt), Simulator(plant.layout, workers=1) as simulator:
        if way == "trace":
            simulator.trace(plant, job)
        else:
            simulator.run(values[None], active[None], [job])
