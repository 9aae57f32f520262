"""The repetitions of `benchmarks.identify`: a truth that the fit does not know, and what an experiment makes of it.

Whole experiments run on a mock brick in virtual time - wire, firmware and rig included. Motors are of the fit's own
family, but for those of the blind benchmark's simulator; sensors are the rig's own mechanisms. The resistance and the
disc that a fit is told of are off by their own stated doubt. Where only a sensor is tried, nothing turns on the brick's
motors.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands, true_run
from nxt_twin.blind.truth.sensing import Sensing, read_battery
from nxt_twin.experiment import identify_motor
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified
from nxt_twin.experiment.identify import carry_out, conclude
from nxt_twin.experiment.plan import (
    Anchor,
    AngleSweep,
    DistanceSweep,
    Experiment,
    GradientSweep,
    MotorIdentification,
    TouchCycles,
    TwoSensors,
    read_experiment,
)
from nxt_twin.experiment.positioner.by_hand import Ask
from nxt_twin.experiment.run_sweep import Apparatus
from nxt_twin.experiment.standin.hand import Hand
from nxt_twin.experiment.standin.rig import (
    Button,
    Diode,
    Echo,
    RigMover,
    Transducers,
    place_button,
    place_light,
    place_transducers,
    place_ultrasonic,
)
from nxt_twin.experiment.standin.workbench import Workbench, helper, mount, workbench
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.mock.body.world import World
from nxt_twin.recording.program import commands
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.settings import PACES, Pace

EACH_PING: Final = {"settle_s": 0.05, "every_s": 0.05}
"""So that each reading sees a ping of its own."""
QUICK: Final = {"settle_s": 0.005, "every_s": 0.003}
"""For sensors on the converter, which is read every other ms."""

Truth = dict[str, float]
Repetition = Callable[[int], tuple[Identified, Truth]]


@final
class Parked:
    """Three motors that nothing turns; they satisfy the mock's `Plants` and cost no time."""

    def __init__(self) -> None:
        self.angle: FloatArray = np.zeros(3)
        self.shown = self.current = self.angle

    def step(self, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float) -> None:
        """Stand still."""


@final
class Waits:
    """A clock for whoever waits: the world's time passes meanwhile, and so the next ping comes, at no cost.

    Args:
        bench: whose brick passes these waits without a tick; its own clock goes on with each telegram.
    """

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self._waited_s = 0.0

    def now_s(self) -> float:
        """The time, s."""
        return self._bench.clock.now_s() + self._waited_s

    def sleep(self, duration_s: float) -> None:
        """Let time pass."""
        self._waited_s += duration_s
        self._bench.body.time_s += duration_s


def _bench(seed: int) -> Workbench:
    bench = workbench(seed=seed)
    bench.body.motors = MotorBank(Parked())
    return bench


def _carried_out(
    experiment: Experiment, bench: Workbench, ask: Ask | None = None, pace: Pace | None = None
) -> Identified:
    axes = () if isinstance(experiment, MotorIdentification) else sweep_of(experiment).axes
    movers = {axis: RigMover(bench.rig, axis) for axis in axes}
    pinged = isinstance(experiment, DistanceSweep | AngleSweep | TwoSensors)
    clock = Waits(bench) if pinged else bench.clock
    helping = ask or helper(bench, experiment)
    around = Apparatus(bench.brick, clock, movers, helping, pace=pace or Pace())
    with tempfile.TemporaryDirectory() as path:
        folder = RunFolder(Path(path) / "run", experiment)
        carry_out(experiment, folder, around)
        bench.brick.close()
        return conclude(experiment, folder)


def _motor_truth(random: np.random.Generator) -> dict[str, float]:
    """A motor as the eight or so that were measured by others differ."""
    return {
        "resistance_ohm": 7.6 * random.uniform(0.9, 1.1),
        "inertia_kg_m2": 1.2e-3 * random.uniform(0.8, 1.3),
        "torque_constant_nm_per_a": 0.4908 * random.uniform(0.96, 1.04),
        "viscous_friction_nm_s_per_rad": 1.92e-3 * random.uniform(0.6, 1.5),
        "coulomb_friction_nm": 8.45e-3 * random.uniform(0.6, 1.8),
    }


def _world(truth: Truth, random: np.random.Generator, internal_ohm: float) -> World:
    plant = {
        "kind": "dc_motor",
        **truth,
        "inductance_h": 4.88e-3 * random.uniform(0.8, 1.2),
        "back_emf_v_s_per_rad": truth["torque_constant_nm_per_a"],
    }
    battery = {"voltage_v": random.uniform(7.2, 8.8), "internal_resistance_ohm": internal_ohm}
    return World.model_validate({"motors": {"a": plant}, "battery": battery})


def _with_ratios(truth: Truth) -> Truth:
    inertia = truth["inertia_kg_m2"]
    return {
        **truth,
        "resistance_times_inertia": truth["resistance_ohm"] * inertia,
        "viscous_over_inertia": truth["viscous_friction_nm_s_per_rad"] / inertia,
        "coulomb_over_inertia": truth["coulomb_friction_nm"] / inertia,
    }


def _anchored(
    experiment: MotorIdentification, truth: Truth, random: np.random.Generator
) -> MotorIdentification:
    """The resistance as a meter of 5 % showed it."""
    shown = truth["resistance_ohm"] * (1.0 + 0.05 * random.standard_normal())
    return experiment.model_copy(update={"resistance_ohm": Anchor(value=shown, std=0.05 * shown)})


def _motor(name: str, internal_ohm: float = 0.0, profile: str = "none") -> Repetition:
    def repeat(seed: int) -> tuple[Identified, Truth]:
        random = np.random.default_rng([seed, 11])
        truth = _motor_truth(random)
        experiment = read_experiment(name)
        assert isinstance(experiment, MotorIdentification)
        experiment = _anchored(experiment, truth, random)
        bench = workbench(_world(truth, random, internal_ohm), seed, profile)
        off = experiment.loads[-1].added_inertia_std_kg_m2 * random.standard_normal()

        def put(inertia: float) -> None:
            """A disc that is off by its own stated doubt."""
            mount(bench, experiment.port, inertia + off if inertia else 0.0)

        pace = PACES["bt" if profile == "bluetooth" else "usb"]
        return _carried_out(experiment, bench, Hand(put), pace), _with_ratios(truth)

    return repeat


def _independent_motor(**extra: float) -> Repetition:
    """Recordings from the benchmark's own simulator, which shares nothing with the fit."""

    def repeat(seed: int) -> tuple[Identified, Truth]:
        random = np.random.default_rng([seed, 12])
        truth = _motor_truth(random)
        motor = replace(
            Motor(),
            resistance_ohm=truth["resistance_ohm"],
            inertia_kg_m2=truth["inertia_kg_m2"],
            torque_constant_nm_per_a=truth["torque_constant_nm_per_a"],
            back_emf_v_s_per_rad=truth["torque_constant_nm_per_a"],
            viscous_friction_nm_s_per_rad=truth["viscous_friction_nm_s_per_rad"],
            coulomb_forward_nm=truth["coulomb_friction_nm"],
            coulomb_reverse_nm=truth["coulomb_friction_nm"],
            **extra,
        )
        experiment = read_experiment("motor_steps")
        assert isinstance(experiment, MotorIdentification)
        experiment = _anchored(experiment, truth, random)
        runs = [_recorded(motor, experiment, index, random) for index in range(len(experiment.runs))]
        found = identify_motor.identified_from(experiment, {"bare": runs})
        return found, _with_ratios(truth)

    return repeat


def _recorded(
    motor: Motor, experiment: MotorIdentification, index: int, random: np.random.Generator
) -> Recording:
    run = experiment.runs[index]
    due = list(commands(run))
    steps = 0.010 + 0.001 * random.random(int((run.duration_s + 0.06) / 0.0105))
    read_s = np.cumsum(steps) - steps[0]
    in_force = np.searchsorted([command.start_s + 0.05 for command in due], read_s, side="right") - 1
    codes = {"drive": 0, "float": 1, "coast": 2, "brake": 3}
    power = np.array([0 if n < 0 else due[n].power_pct for n in in_force], dtype=np.float64)
    mode = np.array([2 if n < 0 else codes[due[n].mode] for n in in_force], dtype=np.int64)
    given = Commands(read_s, power, mode, random.uniform(0.0, 360.0), 0.0, np.zeros(read_s.size))
    true = true_run(motor, Sensing(delay_s=0.002), given)
    battery = np.where(read_s < 0.05, read_battery(true.terminal_v, np.zeros(read_s.size)), np.nan)
    return Recording(
        f"bare-{run.name}.csv",
        {
            "time_s": true.stamp_s,
            "a_power_pct": power,
            "a_mode": mode.astype(np.float64),
            "a_tacho_deg": np.floor(true.encoder_deg),
            "battery_v": battery,
        },
    )


def _distance(seed: int) -> tuple[Identified, Truth]:
    random = np.random.default_rng([seed, 13])
    echo = Echo(
        stretch=random.uniform(0.97, 1.03),
        shift=random.uniform(-5.0, 5.0),
        jitter=random.uniform(2.0, 5.0),
        jitter_per_mm=random.uniform(0.002, 0.008),
        deaf_below=random.uniform(30.0, 60.0),
        early_below=random.uniform(200.0, 300.0),
        early_shift=random.uniform(15.0, 30.0),
        early_share=random.uniform(0.6, 0.95),
    )
    experiment = DistanceSweep.model_validate(
        {
            "kind": "distance_sweep",
            "name": "proof",
            "distance_mm": {"first": 12, "last": 1540, "step": 8},
            "samples": 2,
            "pace": EACH_PING,
        }
    )
    bench = _bench(seed)
    place_ultrasonic(bench.body, 3, bench.rig, echo, bench.random)
    return _carried_out(experiment, bench), {
        "scale": echo.stretch,
        "zero_mm": echo.shift,
        "noise_mm": echo.jitter,
        "noise_per_distance": echo.jitter_per_mm,
        "blind_distance_mm": echo.deaf_below,
        "near_below_mm": echo.early_below,
        "near_offset_mm": echo.early_shift,
        "near_share": echo.early_share,
    }


def _angle(seed: int) -> tuple[Identified, Truth]:
    random = np.random.default_rng([seed, 14])
    near, best, far, where = (
        random.uniform(*r) for r in ((22.0, 38.0), (48.0, 62.0), (8.0, 22.0), (380.0, 520.0))
    )
    echo = Echo(jitter=3.0, beam=((0.0, near), (where, best), (1538.0, far)), wobble=random.uniform(2.0, 4.0))
    experiment = AngleSweep.model_validate(
        {
            "kind": "angle_sweep",
            "name": "proof",
            "distance_mm": {"first": 138, "last": 1538, "step": 200},
            "angle_deg": {"first": 0, "last": 90, "step": 5},
            "samples": 8,
            "pace": EACH_PING,
        }
    )
    bench = _bench(seed)
    place_ultrasonic(bench.body, 3, bench.rig, echo, bench.random)
    return _carried_out(experiment, bench), {
        "max_angle_deg": best,
        "best_distance_mm": where,
        "contact_angle_deg": near,
        "far_angle_deg": far,
        "scale": echo.stretch,
        "zero_mm": echo.shift,
    }


def _gradient(seed: int) -> tuple[Identified, Truth]:
    random = np.random.default_rng([seed, 15])
    diode = Diode(random.uniform(-1.4, -0.6), random.uniform(560.0, 680.0), grain=random.uniform(0.7, 4.0))
    rooms = {"dark": 0.0, "lamp": random.uniform(-120.0, 0.0)}
    experiment = GradientSweep.model_validate(
        {
            "kind": "gradient_sweep",
            "name": "proof",
            "position_mm": {"first": 0, "last": 290, "step": 10},
            "lightings": list(rooms),
            "samples": 8,
            "pace": QUICK,
        }
    )
    bench = _bench(seed)
    light = {"now": 0.0}

    def set_light(request: str) -> str:
        light["now"] = next(level for name, level in rooms.items() if f"'{name}'" in request)
        return ""

    place_light(bench.body, 2, bench.rig, lambda: replace(diode, room=light["now"]), bench.random)
    identified = _carried_out(experiment, bench, set_light)
    zeros = {f"zero_raw[{name}]": diode.dark + level for name, level in rooms.items()}
    return identified, {"slope_raw_per_mm": diode.per_mm, **zeros, "noise_raw": diode.grain}


def _touch(axis: str) -> Repetition:
    unit, kind = (1.0, 16) if axis == "force_g" else (0.02, 18)

    def repeat(seed: int) -> tuple[Identified, Truth]:
        random = np.random.default_rng([seed, kind])
        press = unit * random.uniform(55.0, 70.0)
        release = press - unit * random.uniform(3.0, 6.0)
        # As the paper's sensors: from far less than a step to about one.
        scatter = unit * math.exp(random.uniform(math.log(0.1), math.log(1.0)))
        experiment = TouchCycles.model_validate(
            {
                "kind": "touch_cycles",
                "name": "proof",
                "axis": axis,
                "push": {"first": 40 * unit, "last": 80 * unit, "step": unit},
                "cycles": 8,
                "pace": QUICK,
            }
        )
        bench = _bench(seed)
        place_button(bench.body, 0, bench.rig, axis, Button(press, release, scatter, bench.random))  # type: ignore[arg-type]
        names = ("press_force_g", "release_force_g", "force_noise_g")
        if axis != "force_g":
            names = ("press_travel_mm", "release_travel_mm", "travel_noise_mm")
        return _carried_out(experiment, bench), dict(zip(names, (press, release, scatter), strict=True))

    return repeat


def _two_sensors(seed: int) -> tuple[Identified, Truth]:
    random = np.random.default_rng([seed, 17])
    sign = random.choice([-1.0, 1.0])
    pair = Transducers(
        receiver=-sign * random.uniform(14.0, 18.0),
        emitter=sign * random.uniform(14.0, 18.0),
        enough=random.uniform(0.2, 0.5),
        chance=random.uniform(0.9, 0.99),
    )
    experiment = TwoSensors.model_validate(
        {
            "kind": "two_sensors",
            "name": "proof",
            "position_mm": {"first": -42, "last": 42, "step": 2},
            "samples": 4,
            "pace": EACH_PING,
        }
    )
    bench = _bench(seed)
    place_transducers(bench.body, (3, 0), bench.rig, pair, bench.random)
    return _carried_out(experiment, bench), {"receiver_mm": pair.receiver, "emitter_mm": pair.emitter}


STUDIES: dict[str, Repetition] = {
    "motor, resistance as the anchor": _motor("motor_steps"),
    "motor, disc as the anchor": _motor("motor_steps_disc"),
    "motor over USB's delays": _motor("motor_steps", profile="usb"),
    "motor over Bluetooth's delays": _motor("motor_steps", profile="bluetooth"),
    "ultrasonic, distance sweep": _distance,
    "ultrasonic, angle sweep": _angle,
    "light, gradient under two lights": _gradient,
    "touch, force": _touch("force_g"),
    "touch, travel": _touch("compression_mm"),
    "ultrasonic, two sensors": _two_sensors,
    "NOT the fit's model: motor of the independent simulator": _independent_motor(),
    "NOT the fit's model: the same with Stribeck friction": _independent_motor(
        stiction_excess_nm=0.012, stribeck_speed_rad_s=2.0
    ),
    "NOT the fit's model: mock battery of 0.35 ohm, disc": _motor("motor_steps_disc", 0.35),
}
