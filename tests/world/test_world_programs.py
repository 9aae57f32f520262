"""What programs do, judged from the world, never from the program's word."""

from __future__ import annotations

import numpy as np
from world_runs import run


def test_a_castor_bot_drives_a_square():
    driven = run("playground", "drive_square.py")
    corners = np.array([(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0)])
    nearest = np.linalg.norm(driven.trace.places_m[:, None] - corners, axis=2).min(axis=0)
    assert nearest.max() < 0.03
    assert np.linalg.norm(driven.trace.places_m[-1]) < 0.03
    assert abs(driven.trace.column("heading_deg")[-1] - 360.0) < 8.0
    assert abs(driven.trace.column("z_m")).max() < 1e-3
