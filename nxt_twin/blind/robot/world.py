"""Concealed robots: which effects, how large, which paths, and what a camera sees."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.robot.truth.body import TrueRobot
from nxt_twin.blind.robot.truth.integrator import drive_robot, terminal_v
from nxt_twin.recording.recording import Recording

NEEDS_POWER: Final = ("caster_drag", "floor_slope", "payload_mass", "centre_of_mass_offset")
_RUNS: Final = 6
_LEGS: Final = 14
_SPREAD: Final = 0.1
_RAMP_PCT_PER_S: Final = 250.0


@final
@dataclass(frozen=True)
class Concealed:
    """The changes that an effect makes, and its true parameters.

    Attributes:
        robot: attributes of the true robot that it replaces.
        seen: what it changes in the camera's view: `ahead_m`, `left_m`, `heading_deg`, `compass_deg`, `stretch`.
        spells: how many spells of slip each run has, and their ratio.
        truth: parameters by the names that a diagnosis uses.
    """

    robot: Mapping[str, Any] = field(default_factory=dict)
    seen: Mapping[str, float] = field(default_factory=dict)
    slip_ratio: float = 0.0
    truth: Mapping[str, float] = field(default_factory=dict)


@final
@dataclass(frozen=True)
class RobotWorld:
    """A concealed case: what a solver gets, and the truth."""

    content: Mapping[str, Any]
    recordings: tuple[Recording, ...]
    effects: Mapping[str, Mapping[str, float]]


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _unequal(rng: Generator) -> Concealed:
    ratio = 1.0 + _sign(rng) * float(rng.uniform(0.006, 0.02))
    left = 2.0 * TrueRobot().left_radius_m / (1.0 + ratio)
    changes = {"left_radius_m": left, "right_radius_m": left * ratio}
    return Concealed(changes, truth={"wheel_radius_ratio": ratio})


def _radius(rng: Generator) -> Concealed:
    radius = TrueRobot().left_radius_m * (1.0 + _sign(rng) * float(rng.uniform(0.01, 0.04)))
    changes = {"left_radius_m": radius, "right_radius_m": radius}
    return Concealed(changes, truth={"mean_wheel_radius_m": radius})


def _track(rng: Generator) -> Concealed:
    track = TrueRobot().track_m * (1.0 + _sign(rng) * float(rng.uniform(0.02, 0.07)))
    return Concealed({"track_m": track}, truth={"track_m": track})


def _markers(rng: Generator) -> Concealed:
    ahead, left = (_sign(rng) * float(rng.uniform(0.005, 0.025)) for _ in range(2))
    heading = _sign(rng) * float(rng.uniform(1.0, 4.0))
    seen = {"ahead_m": ahead, "left_m": left, "heading_deg": heading}
    truth = {"offset_forward_m": ahead, "offset_left_m": left, "heading_offset_deg": heading}
    return Concealed(seen=seen, truth=truth)


def _slip(rng: Generator) -> Concealed:
    ratio = float(rng.uniform(0.25, 0.6))
    return Concealed(slip_ratio=ratio, truth={"slip_ratio": ratio})


def _caster(rng: Generator) -> Concealed:
    drag = float(rng.uniform(0.35, 0.9))
    return Concealed({"caster_drag_n": drag}, truth={"drag_force_n": drag})


def _slope(rng: Generator) -> Concealed:
    slope, uphill = float(rng.uniform(1.5, 5.0)), float(rng.uniform(-180.0, 180.0))
    changes = {"slope_rad": np.radians(slope), "uphill_rad": np.radians(uphill)}
    return Concealed(changes, truth={"slope_deg": slope, "uphill_heading_deg": uphill})


def _payload(rng: Generator) -> Concealed:
    added = float(rng.uniform(0.4, 1.0))
    return Concealed({"mass_kg": added}, truth={"added_mass_kg": added})  # added to the body's own mass


def _of_side(side: int, rng: Generator, low: float, high: float) -> tuple[float, float]:
    """A size between two for the motor on one side (0: left, 1: right), none for the other."""
    size = float(rng.uniform(low, high))
    return (size, 0.0) if side == 0 else (0.0, size)


def _uneven(side: int) -> Callable[[Generator], Concealed]:
    def made(rng: Generator) -> Concealed:
        way, both = _sign(rng), _of_side(side, rng, 3.5e-3, 6e-3)
        return Concealed(
            {"uneven_nm": (way * both[0], way * both[1])}, truth={"half_difference_nm": way * max(both)}
        )

    return made


def _fan(side: int) -> Callable[[Generator], Concealed]:
    def made(rng: Generator) -> Concealed:
        both = _of_side(side, rng, 8e-4, 2e-3)
        return Concealed({"fan_nm_s2": both}, truth={"quadratic_drag_nm_s2_per_rad2": max(both)})

    return made


def _brushes(side: int) -> Callable[[Generator], Concealed]:
    def made(rng: Generator) -> Concealed:
        both = _of_side(side, rng, 0.6, 1.2)
        return Concealed({"brush_v": both}, truth={"drop_v": max(both)})

    return made


def _weak_cells(rng: Generator) -> Concealed:
    cells_ohm = float(rng.uniform(1.0, 2.5))
    return Concealed({"cells_ohm": cells_ohm}, truth={"internal_resistance_ohm": cells_ohm})


def _lopsided(rng: Generator) -> Concealed:
    aside, ahead = _sign(rng) * float(rng.uniform(0.015, 0.035)), _sign(rng) * float(rng.uniform(0.015, 0.04))
    changes = {"aside_m": aside, "ahead_m": ahead}
    return Concealed(changes, truth={"offset_left_m": aside, "offset_forward_m": ahead})


ROBOT_EFFECTS: Final[Mapping[str, Callable[[Generator], Concealed]]] = MappingProxyType(
    {
        "unequal_wheels": _unequal,
        "wheel_radius": _radius,
        "wrong_track": _track,
        "pose_offset": _markers,
        "wheel_slip": _slip,
        "caster_drag": _caster,
        "floor_slope": _slope,
        "payload_mass": _payload,
        "centre_of_mass_offset": _lopsided,
        "battery_sag": _weak_cells,
        "left_motor.asymmetric_friction": _uneven(0),
        "right_motor.asymmetric_friction": _uneven(1),
        "left_motor.quadratic_drag": _fan(0),
        "right_motor.quadratic_drag": _fan(1),
        "left_motor.voltage_drop": _brushes(0),
        "right_motor.voltage_drop": _brushes(1),
    }
)
"""By id; what one motor has stands behind its side."""

OF_MOTORS: Final = tuple(name for name in ROBOT_EFFECTS if "motor." in name or name == "battery_sag")

ROBOT_SURPRISES: Final[Mapping[str, Concealed]] = MappingProxyType(
    {
        "unknown_nap": Concealed({"nap": 0.04}),
        "unknown_compass": Concealed(seen={"compass_deg": 4.0}),
        "unknown_stretch": Concealed(seen={"stretch": 0.05}),
        "unknown_patch": Concealed({"patch_drag_n": 1.2}),
        "unknown_tether": Concealed({"tether_n_per_m": 1.5}),
    }
)
"""What no library holds: a floor that pushes one way, a bent compass, a stretched picture, a patch of felt, a cable."""


def make_world(effects: Sequence[str], seed: int) -> RobotWorld:
    """Make a concealed case; equal arguments make an equal case.

    Args:
        effects: ids out of `ROBOT_EFFECTS` or `ROBOT_SURPRISES`; none is a clean case.
        seed: of everything random.
    """
    rng = np.random.default_rng(seed)
    made = {
        one: ROBOT_SURPRISES[one] if one in ROBOT_SURPRISES else ROBOT_EFFECTS[one](rng) for one in effects
    }
    powered = any(one in NEEDS_POWER or one in OF_MOTORS for one in effects) or bool(rng.random() < 0.6)
    powered = powered or bool({"unknown_patch", "unknown_tether"} & set(effects))
    robot = built_robot(drawn_robot(rng), made)
    seen = {name: value for one in made.values() for name, value in one.seen.items()}
    ratio = max((one.slip_ratio for one in made.values()), default=0.0)
    recordings = tuple(
        recorded_run(f"r{n + 1}.csv", robot, seen, ratio, rng, powered=powered) for n in range(_RUNS)
    )
    names = [one.name for one in recordings]
    held = 2 if rng.random() < 0.5 else 0
    content: dict[str, Any] = {"plant": nominal_robot(powered=powered), "recordings": names[: _RUNS - held]}
    if held:
        content["holdout"] = names[_RUNS - held :]
    return RobotWorld(content, recordings, {name: dict(one.truth) for name, one in made.items()})


def drawn_robot(rng: Generator) -> TrueRobot:
    """A robot whose motors are off their nominal numbers, the two a little more alike than any two."""
    plain = TrueRobot()

    def both(nominal: tuple[float, float]) -> tuple[float, float]:
        common = 1.0 + rng.uniform(-_SPREAD, _SPREAD)
        left, right = (nominal[0] * common * (1.0 + rng.uniform(-0.04, 0.04)) for _ in range(2))
        return float(left), float(right)

    return replace(
        plain,
        resistance_ohm=both(plain.resistance_ohm),
        back_emf_v_s=both(plain.back_emf_v_s),
        dry_nm=both(plain.dry_nm),
        wet_nm_s=both(plain.wet_nm_s),
        rotor_kg_m2=both(plain.rotor_kg_m2),
        mass_kg=plain.mass_kg * float(1.0 + rng.uniform(-0.02, 0.02)),
        spin_kg_m2=plain.spin_kg_m2 * float(1.0 + rng.uniform(-0.04, 0.04)),
    )


def built_robot(robot: TrueRobot, made: Mapping[str, Concealed]) -> TrueRobot:
    """A robot with what effects change of it; where two change one wheel, both factors act."""
    changes: dict[str, Any] = {}
    factor = {"left_radius_m": 1.0, "right_radius_m": 1.0}
    for one in made.values():
        for name, value in one.robot.items():
            if name in factor:
                factor[name] *= value / getattr(robot, name)
            elif name == "mass_kg":
                changes[name] = robot.mass_kg + value
            else:
                changes[name] = value
    radii = {name: getattr(robot, name) * value for name, value in factor.items()}
    return replace(robot, **{**changes, **radii})


def nominal_robot(*, powered: bool) -> dict[str, Any]:
    """The model that a solver is given: with motors and body where powers are recorded."""
    plain = TrueRobot()
    plant: dict[str, Any] = {
        "kind": "differential_drive",
        "left": "b",
        "right": "c",
        "left_wheel_radius_m": plain.left_radius_m,
        "right_wheel_radius_m": plain.right_radius_m,
        "track_m": plain.track_m,
    }
    if not powered:
        return plant
    motor = {
        "resistance_ohm": plain.resistance_ohm[0],
        "torque_constant_nm_per_a": plain.back_emf_v_s[0],
        "back_emf_v_s_per_rad": plain.back_emf_v_s[0],
        "coulomb_friction_nm": plain.dry_nm[0],
        "viscous_friction_nm_s_per_rad": plain.wet_nm_s[0],
        "inertia_kg_m2": plain.rotor_kg_m2[0],
        "supply_v": 8.0,
    }
    body = {
        "mass_kg": plain.mass_kg,
        "yaw_inertia_kg_m2": plain.spin_kg_m2,
        "caster_back_m": plain.caster_back_m,
    }
    return {**plant, "motor": motor, **body}


def recorded_run(
    name: str,
    robot: TrueRobot,
    seen: Mapping[str, float],
    slip_ratio: float,
    rng: Generator,
    *,
    powered: bool,
) -> Recording:
    """A run of about 25 s: powers, counts, and what a camera sees; slip at a ratio above 0."""
    legs = _legs(rng)
    length_s = float(sum(leg[0] for leg in legs))
    time_s = np.cumsum(0.04 + rng.gamma(2.0, 1e-3, int(length_s / 0.042)))
    time_s -= time_s[0]
    starts = np.cumsum([0.0, *(leg[0] for leg in legs)])
    index = np.clip(np.searchsorted(starts, time_s, side="right") - 1, 0, len(legs) - 1)
    power = _ramped(time_s, np.array([leg[1:] for leg in legs])[index])
    lost = _lost(time_s, power, slip_ratio, rng)
    battery = 8.0 + float(rng.uniform(-0.5, 0.3))
    push = _pushes(time_s, rng)
    robot = replace(robot, cells_v=battery)
    packed, volts = np.array(robot.packed()), battery * power / 100.0
    states = drive_robot(packed, time_s, volts, lost, push)
    x, y, heading = _camera(states, seen, rng)
    columns = {
        "time_s": time_s,
        "b_tacho_deg": np.floor(np.degrees(states[:, 6])),
        "c_tacho_deg": np.floor(np.degrees(states[:, 8])),
        "pose_x_m": x,
        "pose_y_m": y,
        "pose_heading_deg": heading,
    }
    if powered:
        voltage = np.full(time_s.size, np.nan)
        before = np.concatenate(
            [np.zeros((1, 2)), volts[:-1]]
        )  # a reading is taken before the row's command acts
        read = [terminal_v(before[n], states[n, 5], states[n, 7], packed) for n in range(0, time_s.size, 25)]
        voltage[::25] = np.round(np.array(read) + 0.02 * rng.standard_normal(len(read)), 3)
        columns |= {"b_power_pct": power[:, 0], "c_power_pct": power[:, 1], "battery_v": voltage}
    return Recording(name, columns)


def _legs(rng: Generator) -> list[tuple[float, float, float]]:
    """Duration and the two powers of each leg: straight, arcs, turns on the spot, both ways, with rests."""
    legs: list[tuple[float, float, float]] = [(0.6, 0.0, 0.0)]
    way = _sign(rng)
    for number in range(_LEGS):
        power = float(np.round(rng.uniform(40.0, 90.0)))
        way = -way if number % 2 else way
        kind = number % 4
        if kind == 0:
            legs.append((float(rng.uniform(1.2, 2.2)), power, power))
        elif kind == 1:
            legs.append((float(rng.uniform(0.6, 1.4)), -way * power, way * power))
        elif kind == 2:
            inner = float(np.round(power * rng.uniform(0.3, 0.7)))
            legs.append((float(rng.uniform(1.2, 2.2)), *((inner, power) if way > 0 else (power, inner))))
        else:
            legs.append((float(rng.uniform(0.8, 1.6)), -power, -power))
        if rng.random() < 0.6:
            legs.append((0.5, 0.0, 0.0))
    return [*legs, (0.8, 0.0, 0.0)]


def _ramped(time_s: FloatArray, wanted: FloatArray) -> FloatArray:
    """The powers that a program commands which changes them gently, whole percents."""
    power = np.zeros_like(wanted)
    for row in range(1, time_s.size):
        most = _RAMP_PCT_PER_S * (time_s[row] - time_s[row - 1])
        power[row] = power[row - 1] + np.clip(wanted[row] - power[row - 1], -most, most)
    return np.asarray(np.round(power), dtype=np.float64)


def _lost(time_s: FloatArray, power: FloatArray, ratio: float, rng: Generator) -> FloatArray:
    """Spells of a second or two in which one wheel slips while it is driven."""
    lost = np.zeros((time_s.size, 2))
    if ratio == 0.0:
        return lost
    for _ in range(2):
        driven = np.flatnonzero(
            (np.abs(power).min(axis=1) > 0.0) & (time_s > 2.0) & (time_s < time_s[-1] - 4.0)
        )
        begin = float(time_s[rng.choice(driven)])
        lost[(time_s >= begin) & (time_s < begin + rng.uniform(0.8, 1.8)), int(rng.integers(2))] = ratio
    return lost


def _pushes(time_s: FloatArray, rng: Generator) -> FloatArray:
    """What an uneven floor does: a force and a torque that wander over a tenth of a second."""
    white = rng.standard_normal((time_s.size, 2)) * np.array([0.03, 0.001])
    pushes = np.zeros_like(white)
    for row in range(1, len(white)):
        pushes[row] = 0.7 * pushes[row - 1] + 0.71 * white[row]
    return np.asarray(pushes, dtype=np.float64)


def _camera(
    states: FloatArray, seen: Mapping[str, float], rng: Generator
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The measured pose: from where the recording began, with the markers' place and noise."""
    heading = states[:, 2]
    lever = complex(seen.get("ahead_m", 0.0), seen.get("left_m", 0.0))
    place = states[:, 0] + 1j * states[:, 1] + lever * np.exp(1j * heading)
    place = place - place[0]
    stretch = 1.0 + seen.get("stretch", 0.0)
    bent = np.degrees(heading) + seen.get("heading_deg", 0.0)
    bent = bent + seen.get("compass_deg", 0.0) * np.sin(heading)
    noise = rng.standard_normal((3, heading.size))
    return (
        np.round(stretch * place.real + 5e-4 * noise[0], 5),
        np.round(place.imag + 5e-4 * noise[1], 5),
        np.round(bent + 0.15 * noise[2], 3),
    )
