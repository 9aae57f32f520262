"""A reading is doubted where a fault explains it and the motion does not."""

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.fitting.doubted import is_doubted
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.49])
def test_a_reading_that_motion_and_fault_explain_alike_is_believed(share):
    plant = PLAIN.with_effect("stale_samples", {"stale_fraction": share})
    alike = (1.0 - share) / 1.0 * 0.97  # the fault's density is a little higher
    assert is_doubted(plant, np.array([alike, 0.02])).tolist() == [False, True]


def test_without_a_fault_half_a_belief_is_asked():
    assert is_doubted(PLAIN, np.array([0.49, 0.51])).tolist() == [True, False]
