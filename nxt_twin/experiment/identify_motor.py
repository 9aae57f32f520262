"""A motor's parameters from steps and coast-downs, and what they rest on.

Encoder and voltage alone show this motion of a driven motor:

    dω/dt = (K/RJ)·u - (K²/RJ + B/J)·ω - (T/J)·sign ω

While coasting, the first term and K²/RJ are absent. So the data give K, R·J, B/J and T/J, but not R, J, B and T. One
of these, or a known added inertia, must come from elsewhere (an anchor).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.evidence import torque_share
from nxt_twin.diagnose.judging.verdict import LIMITS
from nxt_twin.errors import PlantError
from nxt_twin.experiment.combine import combined, propagated
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified, normal_value
from nxt_twin.experiment.plan import Load, MotorIdentification
from nxt_twin.experiment.replicates import fit_covariance
from nxt_twin.experiment.run_motor import recording_name
from nxt_twin.experiment.steady import steady_state
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import STEP_S, Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import BATTERY, Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import Recording

_DELAY_S: Final = 20e-3
"""Of a command in the fit, which dates commands so much sooner than the sidecars tell: what is left of the link's delay
may be less than nothing, and a delay in a fit may not."""
_FITTED: Final = ("resistance", "inertia", "torque_constant", "viscous", "coulomb")
_KEYS: Final = (
    "resistance_ohm",
    "inertia_kg_m2",
    "torque_constant_nm_per_a",
    "viscous_friction_nm_s_per_rad",
    "coulomb_friction_nm",
)
_UNITS: Final = ("Ω", "kg·m²", "N·m/A", "N·m·s/rad", "N·m")
_RATIOS: Final = (
    "torque_constant_nm_per_a",
    "resistance_times_inertia",
    "viscous_over_inertia",
    "coulomb_over_inertia",
)
_RATIO_UNITS: Final = ("N·m/A", "Ω·kg·m²", "1/s", "rad/s²")
_BATTERY_STEP_V: Final = 0.013848
"""Of the brick's converter, which cuts off: the voltage lies anywhere within a step above its reading."""
_QUIETER: Final = (1.0, 0.03)
"""Shares of the first guess of an unknown torque from which the fit begins: a large one can hold parameters where they
explain nothing, and so itself."""
_ROUNDS: Final = 2
"""Of fitting everything once more, since noise and parameters are suited to each other in turn."""
_LEAST_DIFFERENCE: Final = 5.0
"""Between R·J with and without the disc, in standard deviations; a disc that makes less of one anchors nothing."""
_ODD_SQUARES: Final = 11.3
"""What two fits may differ by, in units of their doubt squared, before it is said: 1 % of chance for three."""


@final
@dataclass(frozen=True)
class Ratios:
    """What encoder and voltage tell of one set of runs.

    Attributes:
        values: K (N·m/A), R·J (Ω·kg·m²), B/J (1/s), T/J (rad/s²), shape (4,).
        covariance: shape (4, 4), but for the battery.
        by_voltage: how far they move by the doubt of the battery's reading, shape (4,).
        structure: the fit itself.
        unknown_torque: that the fit leaves, as a fraction of one that is ordinary for the motor.
    """

    values: FloatArray
    covariance: FloatArray
    by_voltage: FloatArray
    structure: Structure
    unknown_torque: float

    @property
    def spread(self) -> FloatArray:
        """The whole covariance, shape (4, 4)."""
        return self.covariance + np.outer(self.by_voltage, self.by_voltage)


def identify_motor(experiment: MotorIdentification, folder: RunFolder) -> Identified:
    """Fit each set of runs, and put them together.

    Raises:
        ExperimentError: the sets contradict each other so far that no inertia comes out.
        DiagnosisError: nothing moved.
    """
    sets = {
        load.name: [folder.read(recording_name(load, run)) for run in experiment.runs]
        for load in experiment.loads
    }
    return identified_from(experiment, sets)


def identified_from(experiment: MotorIdentification, sets: Mapping[str, Sequence[Recording]]) -> Identified:
    """The same from recordings in memory, by the loads' names."""
    sets = {name: [_mid_step(recording) for recording in runs] for name, runs in sets.items()}
    fits = [ratios_of(experiment, sets[load.name]) for load in experiment.loads]
    bare = fits[0]
    ratio_values = tuple(
        normal_value(name, value, std, unit)
        for name, value, std, unit in zip(
            _RATIOS, bare.values, np.sqrt(np.diag(bare.spread)), _RATIO_UNITS, strict=True
        )
    )
    if len(fits) == 2:
        x, spread, left = _by_disc(bare, fits[1], experiment.loads[1])
        rests = f"the added inertia of {experiment.loads[1].added_inertia_kg_m2:.4g} kg·m²"
        notes = _disc_notes(x, spread, left, experiment)
    else:
        x, spread = _by_resistance(bare, experiment)
        rests = f"the resistance of {experiment.resistance_ohm.value:g} Ω"
        notes = (
            "Encoder and voltage give the torque constant, R·J, B/J and T/J; R, J, B and T themselves scale"
            " together with the resistance that was given. A second set of runs with a disc of known inertia on"
            " the hub tells them apart without it.",
        )
    stds = np.sqrt(np.diag(spread))
    values = tuple(
        normal_value(name, value, std, unit, "" if name == _RATIOS[0] else rests)
        for name, value, std, unit in zip(_KEYS, x, stds, _UNITS, strict=True)
    )
    compared, steady_notes = steady_state(sets[experiment.loads[0].name], experiment.port, x, spread)
    return Identified(
        experiment.kind,
        (*values, *ratio_values[1:]),
        compared,
        (*_doubts(fits), *notes, *steady_notes, _SUPPLY_NOTE),
        _config(x, bare),
        tuple(f"recordings/{recording.name}" for recording in sets[experiment.loads[0].name]),
    )


_SUPPLY_NOTE: Final = (
    "The resistance is the whole circuit's: winding, bridge and, by the duty squared, the battery's own."
)


def _doubts(fits: Sequence[Ratios]) -> tuple[str, ...]:
    """That physics is missing, where the fitted model takes a torque that nothing explains."""
    left = max(fit.unknown_torque for fit in fits)
    if left <= LIMITS.structured_torque:
        return ()
    return (
        f"WARNING: this model leaves an unknown torque of {100.0 * left:.1f} % of an ordinary one: physics is missing,"
        " and the intervals do not hold. `nxt-twin diagnose` on the run's folder says what it is, where these runs can"
        " tell.",
    )


def ratios_of(experiment: MotorIdentification, recordings: Sequence[Recording]) -> Ratios:
    """Fit a set of runs, and keep of the fit what needs no anchor.

    The fit also estimates the rest of the link's delay, which shifts commands against readings, and leaves it out.
    """
    config = {
        **load_plant_config(experiment.plant),
        "resistance_ohm": experiment.resistance_ohm.value,
        "effects": {"command_delay": {"delay_s": _DELAY_S}},
    }
    missing = [key for key in _KEYS if key not in config]
    if missing:
        raise PlantError(f"lacks {', '.join(missing)}", where=experiment.plant, mend="begin with nxt_motor")
    sooner = tuple(_sooner(recording, experiment.port) for recording in recordings)
    case = Case(experiment.name, Path(), config, sooner, (), experiment.port)
    problem = problem_for(case)
    lag_std_s = {each.name: each.lags.acted_after_s(experiment.port)[1] for each in recordings}
    structure, covariance = _fitted(problem, lag_std_s)
    fitted = structure.fitted
    symbols = [variable.slots[0].symbol for variable in fitted.variables]
    order = [symbols.index(symbol) for symbol in _FITTED]
    values = np.array([structure.plant.values[fitted.variables[index].slots[0]] for index in order])
    ratios, spread = propagated(_ratios, values, covariance[np.ix_(order, order)])
    by_voltage = ratios * np.array([1.0, 2.0, 0.0, 0.0]) * _battery_doubt(recordings)
    return Ratios(ratios, spread, by_voltage, structure, torque_share(problem, structure))


def _sooner(recording: Recording, port: Port) -> Recording:
    return replace(recording, lags=recording.lags.acting_sooner(port, _DELAY_S))


def _fitted(problem: Problem, lag_std_s: Mapping[str, float]) -> tuple[Structure, FloatArray]:
    """The fit with the noise that suits it, and its covariance."""
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        guess = first_noise(problem.plant, problem.signals, problem.scale.torque)
        found = [
            _settled(fitter, replace(guess, disturbance_std=q * guess.disturbance_std)) for q in _QUIETER
        ]
        structure = min(found, key=lambda each: each.fitted.cost + each.fitted.prior_cost)
        linear = linearise(simulator, problem, structure, STEP_S)
        rng = np.random.default_rng(0)
        return structure, fit_covariance(simulator, linear, problem.everything(), lag_std_s, rng)


def _settled(fitter: Fitter, noise: Noise) -> Structure:
    structure = fit_everything(fitter, fitter.problem.plant, noise)
    for _ in range(_ROUNDS):
        structure = fit_everything(fitter, structure.plant, structure.noise)
    return structure


def _mid_step(recording: Recording) -> Recording:
    """The recording with the battery in the middle of the step that its reading begins."""
    columns = dict(recording.columns)
    if BATTERY in columns:
        columns[BATTERY] = columns[BATTERY] + 0.5 * _BATTERY_STEP_V
    return replace(recording, columns=columns)


def _battery_doubt(recordings: Sequence[Recording]) -> float:
    """The voltage's relative standard deviation by the steps in which it is read; 0 if it was not."""
    readings = np.concatenate([recording.columns.get(BATTERY, np.empty(0)) for recording in recordings])
    known = readings[np.isfinite(readings)]
    return float(_BATTERY_STEP_V / np.sqrt(12.0) / np.median(known)) if known.size else 0.0


def _ratios(x: FloatArray) -> FloatArray:
    resistance, inertia, constant, viscous, coulomb = x
    return np.array([constant, resistance * inertia, viscous / inertia, coulomb / inertia])


def _by_resistance(bare: Ratios, experiment: MotorIdentification) -> tuple[FloatArray, FloatArray]:
    """All five from the ratios and the resistance that was given."""
    anchor = experiment.resistance_ohm
    given = np.array([anchor.value, *bare.values])
    covariance = np.zeros((5, 5))
    covariance[0, 0] = anchor.std**2
    covariance[1:, 1:] = bare.spread

    def five(m: FloatArray) -> FloatArray:
        resistance, constant, product, viscous, coulomb = m
        inertia = product / resistance
        return np.array([resistance, inertia, constant, viscous * inertia, coulomb * inertia])

    return propagated(five, given, covariance)


def _by_disc(bare: Ratios, loaded: Ratios, load: Load) -> tuple[FloatArray, FloatArray, float]:
    """All five from two sets, between which only the inertia is known to differ; friction may differ too."""
    added = load.added_inertia_kg_m2
    product = loaded.values[1] / bare.values[1]
    doubt = product * float(np.hypot(*(np.sqrt(r.spread[1, 1]) / r.values[1] for r in (bare, loaded))))
    if product - 1.0 < _LEAST_DIFFERENCE * doubt:
        raise ExperimentError(
            f"with the disc the motor was no slower to speed up than without (R·J by {100 * (product - 1):+.0f} %)",
            where=load.name,
            mend="check that the disc was on the hub; take one of at least half the motor's inertia",
        )
    inertia = added / (product - 1.0)
    constant, _, viscous, coulomb = bare.values
    loaded_viscous, loaded_coulomb = loaded.values[2:] * (inertia + added)
    own = (bare.values[1] / inertia, inertia, constant, viscous * inertia, coulomb * inertia)
    start = np.array([*own, loaded_viscous, loaded_coulomb, added])
    measured = np.concatenate([bare.values, loaded.values, [added]])
    covariance = np.zeros((9, 9))
    covariance[:4, :4] = bare.covariance
    covariance[4:8, 4:8] = loaded.covariance
    # One battery and one converter: what its reading cuts off is cut off in both sets alike.
    shared = np.concatenate([bare.by_voltage, loaded.by_voltage])
    covariance[:8, :8] += np.outer(shared, shared)
    covariance[8, 8] = max(load.added_inertia_std_kg_m2, 1e-6 * added) ** 2

    def nine(x: FloatArray) -> FloatArray:
        with_disc = np.array([x[0], x[1] + x[7], x[2], x[5], x[6]])
        return np.concatenate([_ratios(x[:5]), _ratios(with_disc), [x[7]]])

    x, spread, left = combined(measured, covariance, nine, start)
    return x[:5], spread[:5, :5], left


def _disc_notes(
    x: FloatArray, spread: FloatArray, left: float, experiment: MotorIdentification
) -> tuple[str, ...]:
    anchor = experiment.resistance_ohm
    apart = (x[0] - anchor.value) / float(np.hypot(np.sqrt(spread[0, 0]), anchor.std))
    notes = [
        "The disc's inertia told R, J, B and T apart; the resistance that was given was not used. It is"
        f" {abs(apart):.1f} standard deviations from what came out."
    ]
    if left > _ODD_SQUARES:
        notes.append(
            "The two sets disagree about the torque constant: something else than the disc has changed."
        )
    return tuple(notes)


def _config(x: FloatArray, bare: Ratios) -> dict[str, Any]:
    plant = bare.structure.plant.without(["command_delay"]).to_config()
    plant |= {key: float(f"{value:.6g}") for key, value in zip(_KEYS, x, strict=True)}
    plant["back_emf_v_s_per_rad"] = plant["torque_constant_nm_per_a"]
    return plant
