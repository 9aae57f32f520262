"""The whole steps in which a bridge takes its duty."""

import numpy as np
import pytest

from nxt_twin.errors import RecordingError
from nxt_twin.physics.recorded import signals_of
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.lags import RowLags
from nxt_twin.recording.pulses import PULSE_STEPS, pulsed
from nxt_twin.twin.bridge import firmware_bridge

ROWS = "".join(f"{0.01 * row:.2f},33,{row}\n" for row in range(20))


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(f"time_s,a_power_pct,a_tacho_deg\n{ROWS}")
    return path


def test_every_whole_percent_is_what_the_live_twins_bridge_makes_of_it():
    powers = np.arange(-100, 101)
    bridge = [firmware_bridge(int(power), "drive", 0.0)[-1].duty for power in powers]
    np.testing.assert_allclose(pulsed(powers / 100.0, PULSE_STEPS), bridge, atol=1e-15)


def test_without_steps_a_duty_is_what_was_commanded(path):
    assert signals_of(read_recording(path), "a").command[0] == 0.33


def test_a_sidecar_that_tells_the_steps_is_gone_by(path):
    path.with_suffix(".yaml").write_text("pulse_steps: 125\n")
    assert signals_of(read_recording(path), "a").command[0] == 41 / 125


def test_what_records_a_brick_tells_the_steps(path):
    lags = RowLags()
    lags.taken("a", 0.005, 1e-4)
    lags.row(0.01)
    lags.write_beside(path)
    lags.write_beside(path)  # once more, over its own
    assert read_recording(path).pulse_steps == PULSE_STEPS


@pytest.mark.parametrize("told", ["many", "-1", "1.5", "yes", "[125]"])
def test_nonsense_about_the_steps_is_told_with_its_place(path, told):
    path.with_suffix(".yaml").write_text(f"pulse_steps: {told}\n")
    with pytest.raises(RecordingError, match=r"run\.yaml, key pulse_steps: is no number of steps"):
        read_recording(path)
