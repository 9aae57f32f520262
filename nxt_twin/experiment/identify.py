"""An experiment from beginning to end: run what is missing, fit, write down."""

from __future__ import annotations

from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified
from nxt_twin.experiment.identify_motor import identify_motor
from nxt_twin.experiment.identify_sensor import identify_sensor
from nxt_twin.experiment.plan import Experiment, MotorIdentification, TwoSensors
from nxt_twin.experiment.run_motor import run_motor
from nxt_twin.experiment.run_sweep import Apparatus, run_sweep
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.experiment.two_sensors import identify_two_sensors


def carry_out(experiment: Experiment, folder: RunFolder, around: Apparatus) -> None:
    """Record everything that the folder does not hold yet.

    Raises:
        ExperimentError, PositionerError, BrickError: what kept it from being done; run it again to go on.
    """
    if isinstance(experiment, MotorIdentification):
        run_motor(experiment, folder, around)
    else:
        run_sweep(sweep_of(experiment), folder, around)


def conclude(experiment: Experiment, folder: RunFolder) -> Identified:
    """Fit what was recorded.

    Raises:
        ExperimentError, SensorError, DiagnosisError: the recordings are not enough for it.
    """
    match experiment:
        case MotorIdentification():
            return identify_motor(experiment, folder)
        case TwoSensors():
            return identify_two_sensors(experiment, folder)
        case _:
            return identify_sensor(experiment, folder)
