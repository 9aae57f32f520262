"""Diagnose and fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from nxt_twin.api.files import ModelSource, read_case
from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.dispatch import changed_any, changed_since
from nxt_twin.diagnose.engine import diagnose, fit_as_it_stands
from nxt_twin.diagnose.robot.engine import diagnose_robot, is_robot_case
from nxt_twin.diagnose.sensor.engine import diagnose_sensor, is_sensor_case
from nxt_twin.errors import CaseError
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.case import Case, case_of
from nxt_twin.recording.columns import Port
from nxt_twin.recording.recording import Recording

Data = Case | Recording | Sequence[Recording] | str | Path
"""A case, recordings of one thing, or the path of a case or a recording."""


def find_missing_physics(
    data: Data, plant: ModelSource | None = None, *, port: Port | None = None, seed: int = 0
) -> Diagnosis | Changes:
    """Find the physics that a model leaves out: the command `nxt-twin diagnose` as a function.

    The diagnosis first re-fits the parameters. It then tries every known effect, and judges them on held-out data.
    A case that names recordings of `before` asks for changes since; the answer then is a `Changes`.

    Args:
        data: a case, one or more recordings, or the path of a case or a recording.
        plant: the baseline model: a plant, a name, a path or a mapping. None takes the data's own, or `nxt_motor`.
        port: the motor to diagnose, `a`, `b` or `c`, if the recordings hold several.
        seed: of the random shifts that give p-values.

    Returns:
        The diagnosis; its `plant` is the improved model.

    Raises:
        NxtTwinError: the data cannot be diagnosed; the text says why.

    >>> import nxt_twin as nt
    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> time_s = np.arange(0.0, 4.0, 0.01)
    >>> power = np.repeat(rng.integers(-80, 80, 10), 40)
    >>> truth = nt.load_plant("nxt_motor").adding("constant_load", load_torque_nm=0.05)
    >>> run = nt.simulate(truth, nt.Recording("run", {"time_s": time_s, "a_power_pct": power}))
    >>> run = nt.Recording("run", {**run.columns, "a_tacho_deg": np.floor(run.columns["a_tacho_deg"])})
    >>> found = nt.find_missing_physics(run)
    >>> found
    <Diagnosis run: explained by constant_load>
    >>> found.plant
    <Plant dc_motor: coulomb_friction, viscous_friction, inductance, constant_load>
    """
    case = _case(data, plant, port)
    if case.before:
        return changed_since(case)
    if is_sensor_case(case):
        return diagnose_sensor(case, seed=seed).diagnosis
    if is_robot_case(case):
        return diagnose_robot(case).diagnosis
    answer = diagnose(case, seed=seed)
    return replace(answer.diagnosis, plant=answer.plant)


def find_changes(
    before: Data, after: Data, plant: ModelSource | None = None, *, port: Port | None = None
) -> Changes:
    """Say which parameters or effects differ between recordings: the command `nxt-twin changed` as a function.

    Args:
        before: a case, one or more recordings, or the path of a case or a recording.
        after: likewise; a plant that it names is ignored.
        plant: the model of both sides: a plant, a name, a path or a mapping. None takes the one that `before` names.
        port: the motor to compare, `a`, `b` or `c`, if the recordings hold several.

    Returns:
        The verdict and the changes; their `plant` is the model of the side after.

    Raises:
        NxtTwinError: the sides cannot be compared; the text says why.

    >>> import nxt_twin as nt
    >>> import numpy as np
    >>> time_s = np.arange(0.0, 6.0, 0.01)
    >>> power = np.repeat([30, -60, 90, -20, 50, -80], 100)
    >>> commands = nt.Recording("run", {"time_s": time_s, "a_power_pct": power})
    >>> before = nt.simulate("nxt_motor", commands)
    >>> nt.find_changes(before, before, "nxt_motor").verdict
    'unchanged'
    """
    return changed_any(_case(before, plant, port), [_case(after, plant, port)])[0]


def fit(data: Data, plant: ModelSource | None = None, *, port: Port | None = None) -> Plant:
    """Fit a plant's parameters to the recordings that are not held out, and look for no effect.

    Args:
        data: a case, one or more recordings, or the path of a case or a recording.
        plant: the model to fit: a plant, a name, a path or a mapping. None takes the data's own, or `nxt_motor`.
        port: the motor to fit, `a`, `b` or `c`, if the recordings hold several.

    Returns:
        The plant with the fitted parameters.

    Raises:
        NxtTwinError: the data cannot be fitted; the text says why.

    >>> import nxt_twin as nt
    >>> import numpy as np
    >>> time_s = np.arange(0.0, 6.0, 0.01)
    >>> power = np.repeat([30, -60, 90, -20, 50, -80], 100)
    >>> truth = nt.load_plant({**nt.load_plant("nxt_motor").to_config(), "inertia_kg_m2": 2e-3})
    >>> run = nt.simulate(truth, nt.Recording("run", {"time_s": time_s, "a_power_pct": power}))
    >>> 1.8e-3 < nt.fit(run, "nxt_motor").to_config()["inertia_kg_m2"] < 2.2e-3
    True
    """
    case = _case(data, plant, port)
    if is_sensor_case(case):
        raise CaseError("is about a sensor", where=case.name, mend="fit it by nxt-twin fit")
    return fit_as_it_stands(case).plant


def _case(data: Data, plant: ModelSource | None, port: Port | None) -> Case:
    model: str | dict[str, Any] | None = None
    if plant is not None:
        config = plant.to_config() if isinstance(plant, Plant) else plant
        model = str(config) if isinstance(config, str | Path) else dict(config)
    if isinstance(data, str | Path):
        data = read_case(data)
    if isinstance(data, Case):
        return replace(data, plant=model or data.plant, port=port or data.port)
    recordings = (data,) if isinstance(data, Recording) else tuple(data)
    return case_of(recordings, model, port)
