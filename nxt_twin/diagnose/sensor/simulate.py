"""The readings that a sensor model predicts along a rig's recording."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.sensor.runs import COLUMNS, TRUTHS, filled
from nxt_twin.diagnose.sensor.ultrasonic_problem import predicted_cm
from nxt_twin.errors import RecordingError
from nxt_twin.recording.recording import Recording
from nxt_twin.sensors.converter import HIGHEST_RAW
from nxt_twin.sensors.light import LightParameters, LightTruth, mean_raw
from nxt_twin.sensors.touch import TouchParameters, TouchTruth, predict
from nxt_twin.sensors.ultrasonic import UltrasonicParameters

_USUAL_COLUMN: Final[Mapping[str, str]] = {
    "ultrasonic_sensor": "s4_ultrasonic_cm",
    "light_sensor": "s3_light_raw",
    "touch_sensor": "s1_touch",
}
_UNITS: Final[Mapping[str, str]] = {
    "ultrasonic_sensor": "cm",
    "light_sensor": "raw",
    "touch_sensor": "pressed",
}


@final
@dataclass(frozen=True)
class ExpectedReadings:
    """The expected reading at each row, and its error where there is a measured one.

    Attributes:
        channel: the sensor's column; the port on which LEGO ships it where the recording has none.
        values: shape (rows,), in `unit`.
        rmse: against the measured readings; NaN where there are none.
        readings: how many there are.
    """

    channel: str
    unit: str
    values: FloatArray
    rmse: float
    readings: int


def expected_readings(config: Mapping[str, Any], recording: Recording) -> ExpectedReadings:
    """SensorRun a sensor model over the true values of a recording.

    Args:
        config: the model's keys.
        recording: with the rig's columns.

    Raises:
        SensorError: a key or value that is none.
        RecordingError: no rig column.
    """
    kind = str(config["kind"])
    columns, time_s = recording.columns, recording.time_s
    truth = next((n for n in TRUTHS[kind] if n in columns and np.isfinite(columns[n]).any()), None)
    if truth is None:
        mend = f"record {' or '.join(TRUTHS[kind])}"
        raise RecordingError("nothing says what the sensor was shown", where=recording.name, mend=mend)
    values = _expected(kind, config, truth, {n: filled(time_s, v) for n, v in columns.items() if n[:4] == "rig_"
                       and np.isfinite(v).any()}, time_s)  # fmt: skip
    found = sorted(name for name in columns if re.fullmatch(COLUMNS[kind], name))
    channel = found[0] if found else _USUAL_COLUMN[kind]
    error = columns[channel] - values if found else np.full(values.size, np.nan)
    counted = np.isfinite(error)
    rmse = float(np.sqrt(np.mean(error[counted] ** 2))) if counted.any() else float("nan")
    return ExpectedReadings(channel, _UNITS[kind], values, rmse, int(counted.sum()))


def _expected(
    kind: str, config: Mapping[str, Any], truth: str, rig: Mapping[str, FloatArray], time_s: FloatArray
) -> FloatArray:
    true = rig[truth]
    match kind:
        case "ultrasonic_sensor":
            angle = rig.get("rig_angle_deg", np.zeros_like(true))
            return predicted_cm(UltrasonicParameters.from_config(config), true, angle)
        case "light_sensor":
            mean = mean_raw(LightParameters.from_config(config), LightTruth(true, time_s))
            return np.asarray(np.clip(mean, 0.0, HIGHEST_RAW), dtype=np.float64)
        case _:
            by_force = truth == "rig_force_g"
            shown = TouchTruth(true, "force_g" if by_force else "travel_mm")
            return predict(TouchParameters.from_config(config), shown)
