"""`--columns time=ms:ms,power=pwm,angle=ticks:0.088deg`: a mapping in one line."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingType
from math import tau
from types import MappingProxyType
from typing import Any

from nxt_twin.errors import MappingError
from nxt_twin.recording.any_mapping import AnyMapping, any_mapping_of
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.robot_keys import is_robots
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.tables.nested import with_index

WHERE = "--columns"
EXAMPLE = "time=ms:ms,power=pwm,angle=ticks:0.088deg"
ROBOT_EXAMPLE = "time=t:ms,x=px:mm,y=py:mm,heading=th:rad,left_angle=encL:0.5deg,right_angle=encR:0.5deg"

_Units = MappingType[str, tuple[str, float]]
"""By unit: the kind, and how many of the kind's own unit it is."""

TIMES = ("s", "ms", "us", "ns", "iso")
INPUTS: MappingType[str, _Units] = MappingProxyType(
    {
        "power": {"pct": ("power_pct", 1.0), "%": ("power_pct", 1.0), "share": ("power_pct", 100.0)},
        "voltage": {"V": ("voltage_v", 1.0), "mV": ("voltage_v", 1e-3)},
        "current": {"A": ("current_a", 1.0), "mA": ("current_a", 1e-3)},
        "torque": {"Nm": ("torque_nm", 1.0), "mNm": ("torque_nm", 1e-3), "Ncm": ("torque_nm", 1e-2)},
        "force": {"N": ("force_n", 1.0), "kN": ("force_n", 1e3)},
        "goal": {
            "deg": ("goal_position_deg", 1.0),
            "rad": ("goal_position_rad", 1.0),
            "turn": ("goal_position_deg", 360.0),
        },
    }
)
OUTPUTS: MappingType[str, _Units] = MappingProxyType(
    {
        "angle": {
            "deg": ("position_deg", 1.0),
            "rad": ("position_rad", 1.0),
            "turn": ("position_deg", 360.0),
        },
        "position": {
            "m": ("position_m", 1.0),
            "mm": ("position_m", 1e-3),
            "cm": ("position_m", 1e-2),
            "um": ("position_m", 1e-6),
        },
        "speed": {
            "rad/s": ("speed_rad_per_s", 1.0),
            "deg/s": ("speed_deg_per_s", 1.0),
            "rpm": ("speed_rad_per_s", tau / 60.0),
            "m/s": ("speed_m_per_s", 1.0),
            "mm/s": ("speed_m_per_s", 1e-3),
        },
    }
)
_SUPPLY: _Units = MappingProxyType({"V": ("voltage_v", 1.0), "mV": ("voltage_v", 1e-3)})
_MODES: MappingType[str, MappingType[Any, str]] = MappingProxyType(
    {
        "mode": {word: word for word in DRIVE_MODES},
        "coast": {0: "drive", 1: "coast"},
        "brake": {0: "drive", 1: "brake"},
        "enabled": {0: "coast", 1: "drive"},
    }
)
"""Columns that say what the bridge does: by role, the mode that each of its values means."""
_LENGTHS: _Units = MappingProxyType({"m": ("m", 1.0), "mm": ("mm", 1.0), "cm": ("cm", 1.0)})
_ANGLES: _Units = MappingProxyType({"deg": ("deg", 1.0), "rad": ("rad", 1.0), "turn": ("turn", 1.0)})
_DUTIES: _Units = MappingProxyType({"pct": ("", 1.0), "%": ("", 1.0), "share": ("", 100.0)})
ROBOT: MappingType[str, tuple[str, _Units]] = MappingProxyType(
    {
        "x": ("pose_x", _LENGTHS),
        "y": ("pose_y", _LENGTHS),
        "heading": ("pose_heading", _ANGLES),
        "left_angle": ("left_angle", _ANGLES),
        "right_angle": ("right_angle", _ANGLES),
        "left_power": ("left_power", _DUTIES),
        "right_power": ("right_power", _DUTIES),
    }
)
"""By role of a robot's table: the key of the mapping, and its units."""
_ROLES = ("time", "period", *INPUTS, *OUTPUTS, *ROBOT, "supply", "split", *_MODES)
_TIME_NEED = ("time", ("time", "period"))
_WORD = re.compile(r"(?P<role>\w+)=(?P<column>.+?)(?::(?P<unit>[^:]*))?")
_UNIT = re.compile(r"(?P<size>[\d.]+(?:[eE][+-]?\d+)?)?\s*(?P<name>[a-zA-Zµ%][\w/%µ]*)")


def mapping_of_words(text: str) -> AnyMapping:
    """The mapping that `text` states, as ROLE=COLUMN:UNIT between commas.

    Raises:
        MappingError: a word is none, a role or unit is unknown, or time, a command or a reading is missing.
    """
    keys: dict[str, Any] = {}
    for word in filter(None, (each.strip() for each in with_index(text).split(","))):
        parts = _WORD.fullmatch(word)
        if parts is None or parts["role"] not in _ROLES:
            role = word.partition("=")[0]
            mend = f"write ROLE=COLUMN:UNIT, with one of {', '.join(_ROLES)}; nearest: {nearest_name(role, _ROLES)}"
            raise MappingError(f"{quoted(word)} is no column", where=WHERE, mend=mend)
        if parts["role"] in _MODES:
            keys.setdefault("mode", []).append(
                {"column": _whole(parts), "values": dict(_MODES[parts["role"]])}
            )
            continue
        key, value = _read(parts["role"], parts["column"], parts["unit"] or "")
        if key in keys:
            raise MappingError(f"{quoted(word)} is a second {key}", where=WHERE, mend="keep one")
        keys[key] = value
    _check_whole(keys)
    return any_mapping_of(keys, WHERE)


def _check_whole(keys: MappingType[str, Any]) -> None:
    """Refuse words that leave out what a motor's or a robot's mapping needs."""
    if is_robots(keys):
        needed = [(key, (role,)) for role, (key, _) in ROBOT.items() if not role.endswith("_power")]
        needs, example = (_TIME_NEED, *needed), ROBOT_EXAMPLE
        strange = next((key for key in ("input", "output", "mode") if key in keys), None)
        if strange is not None:
            mend = f"a robot's roles are {', '.join(ROBOT)}, as in {ROBOT_EXAMPLE}"
            raise MappingError(f"names both a robot's pose and a motor's {strange}", where=WHERE, mend=mend)
    else:
        needs, example = (_TIME_NEED, ("input", tuple(INPUTS)), ("output", tuple(OUTPUTS))), EXAMPLE
    for key, roles in needs:
        if key not in keys:
            either = "one of " if len(roles) > 1 else ""
            mend = f"write {either}{', '.join(roles)}, as in {example}"
            raise MappingError(f"names no {key}", where=WHERE, mend=mend)


def _whole(parts: re.Match[str]) -> str:
    """A column that has no unit, with the colon that its name may hold."""
    return parts["column"] + ("" if parts["unit"] is None else f":{parts['unit']}")


def _read(role: str, column: str, unit: str) -> tuple[str, dict[str, Any]]:
    """A word as a key of a mapping and what stands under it."""
    if role == "split":
        return "split", {"column": f"{column}:{unit}" if unit else column}
    if role == "period":
        return "time", {"period_s": _period_s(column)}
    _refuse_swapped(role, column, unit)
    if role in ROBOT:
        return ROBOT[role][0], _robots(role, column, unit)
    if role == "time":
        _refuse_unit(unit or "s", TIMES, role)
        return "time", {"column": column, "unit": unit or "s"}
    if role in INPUTS:
        kind, gain, _ = _scaled(unit, INPUTS[role], role)
        return "input", {**_column_or_value(column), "kind": kind, "gain": gain}
    if role in OUTPUTS:
        kind, gain, is_step = _scaled(unit, OUTPUTS[role], role)
        return "output", {"column": column, "kind": kind, "gain": gain, **({"step": gain} if is_step else {})}
    kind, gain, _ = _scaled(unit, _SUPPLY, role)
    return "supply", {"column": column, "gain": gain}


def _robots(role: str, column: str, unit: str) -> dict[str, Any]:
    """What stands under a key of a robot's mapping."""
    name, gain, _ = _scaled(unit, ROBOT[role][1], role)
    return {"column": column, **({"unit": name} if name else {}), "gain": gain}


def _refuse_swapped(role: str, column: str, unit: str) -> None:
    """Refuse `time=ms:c1`, where the unit stands before the column."""
    tables = {**INPUTS, **OUTPUTS, **{one: units for one, (_, units) in ROBOT.items()}, "supply": _SUPPLY}
    known = TIMES if role == "time" else tuple(tables[role])
    parts = _UNIT.fullmatch(unit)
    if unit and column in known and (parts["name"] if parts else unit) not in known:
        mend = f"write {role}={unit}:{column}, the column first"
        raise MappingError(f"{quoted(unit)} is no unit of {role}", where=WHERE, mend=mend)


def _scaled(unit: str, known: _Units, role: str) -> tuple[str, float, bool]:
    """The kind that a unit means, the gain to it, and whether the unit says how large a step is."""
    parts = _UNIT.fullmatch(unit or next(iter(known)))
    if parts is None:
        raise _no_unit(unit, tuple(known), role)
    _refuse_unit(parts["name"], tuple(known), role)
    kind, gain = known[parts["name"]]
    size = _number(parts["size"] or "1", unit)
    return kind, size * gain, parts["size"] is not None


def _column_or_value(column: str) -> dict[str, Any]:
    """A number in the place of a column is a constant."""
    try:
        return {"value": float(column)}
    except ValueError:
        return {"column": column}


def _period_s(text: str) -> float:
    parts = _UNIT.fullmatch(text)
    seconds = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
    if parts is None or parts["size"] is None or parts["name"] not in seconds:
        raise MappingError(f"{quoted(text)} is no period", where=WHERE, mend="write such as period=10ms")
    return _number(parts["size"], text) * seconds[parts["name"]]


def _number(text: str, unit: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise MappingError(f"{quoted(unit)} is no unit", where=WHERE, mend="write such as 0.088deg") from None


def _refuse_unit(unit: str, known: tuple[str, ...], role: str) -> None:
    if unit not in known:
        raise _no_unit(unit, known, role)


def _no_unit(unit: str, known: tuple[str, ...], role: str) -> MappingError:
    sized = ", such as 0.392pct for a duty of 8 bits" if role == "power" else ""
    mend = f"write one of {', '.join(known)}, with a number before it where a step has a size{sized}"
    return MappingError(f"{quoted(unit)} is no unit of {role}", where=WHERE, mend=mend)
