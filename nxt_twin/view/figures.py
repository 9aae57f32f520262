"""Single pictures for whoever works in Python rather than with a report."""

from __future__ import annotations

from matplotlib.figure import Figure

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.errors import DiagnosisError
from nxt_twin.view.robot_plot import robot_figure
from nxt_twin.view.run_plot import run_figure
from nxt_twin.view.sensor_plot import is_of_sensor, sensor_figure
from nxt_twin.view.telling import most_telling
from nxt_twin.view.traces import RunPicture, picture_of


def diagnosis_figure(diagnosis: Diagnosis, number: int) -> Figure:
    """The picture of one held-out run, the most telling being number 0.

    Raises:
        DiagnosisError: there is no such run.
    """
    runs = most_telling(diagnosis)
    if not 0 <= number < len(runs):
        mend = f"number them from 0 to {len(runs) - 1}" if runs else "record for longer"
        raise DiagnosisError(f"has no held-out run {number}", where=diagnosis.name, mend=mend)
    return held_out_figure(picture_of(diagnosis, runs[number]))


def held_out_figure(picture: RunPicture) -> Figure:
    """The picture of a held-out run: of a sensor, of a robot's path, or of a motor or an axis."""
    if picture.run.path is not None:
        return robot_figure(picture, picture.run.path)
    return sensor_figure(picture) if is_of_sensor(picture.run) else run_figure(picture)
