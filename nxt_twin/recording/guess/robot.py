"""The columns of a table that a robot on two wheels fills: pose, wheels and powers, by their names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, final

from nxt_twin.recording.guess.profile import TableColumn
from nxt_twin.recording.guess.vocabulary import has, quantity_and_unit

_WRITTEN: Final = """
outside: pose mocap optitrack vicon camera cam tracker tracking marker tag aruco apriltag gt truth true
outside: ground ref real measured meas base
inside: odom odometry odo est estimate estimated ekf kalman filtered predicted
no place: acc accel acceleration gyro mag imu vel velocity speed omega v w cmd goal target setpoint desired
no place: error err std cov quat quaternion orientation
heading: heading theta th yaw psi phi azimuth bearing orientation angle rotation rot
left: left l lft lhs lw links gauche izquierda izquierdo sinistra sinistro esquerda linker
right: right r rgt rhs rw rechts droite droit derecha derecho destra destro direita rechter
wheel: wheel rad roue rueda ruota roda wiel
"""
_LINES: Final = [line.partition(": ")[::2] for line in _WRITTEN.strip().splitlines()]
_NAMED: Final = {
    subject: frozenset(word for own, words in _LINES if own == subject for word in words.split())
    for subject, _ in _LINES
}
_OUTSIDE, _INSIDE, _NO_PLACE = (_NAMED[subject] for subject in ("outside", "inside", "no place"))
_HEADING, _WHEEL = _NAMED["heading"], _NAMED["wheel"]
_QUATERNION: Final = frozenset(("orientation", "quat", "quaternion"))
_SIDES: Final = (_NAMED["left"], _NAMED["right"])
_SPEEDS: Final = frozenset(["vel", "velocity", "speed", "omega", "rpm", "v", "w", "rate"])


@final
@dataclass(frozen=True)
class RobotColumns:
    """Columns by what they are taken for; None where none is found."""

    x: TableColumn | None
    y: TableColumn | None
    heading: TableColumn | None
    left: TableColumn | None
    right: TableColumn | None
    left_power: TableColumn | None
    right_power: TableColumn | None

    @property
    def is_robots(self) -> bool:
        """Whether a robot filled the table: a place and two wheels, or a whole pose and one wheel."""
        has_place = self.x is not None and self.y is not None
        wheels = (self.left is not None) + (self.right is not None)
        return has_place and (wheels == len(_SIDES) or (wheels > 0 and self.heading is not None))


def robot_columns(columns: Sequence[TableColumn], taken: Sequence[TableColumn | None]) -> RobotColumns:
    """The columns of a robot, each in one role.

    Args:
        columns: those of the table.
        taken: those that are known to be something else.
    """
    left = [column for column in columns if all(column is not each for each in taken)]
    x, y = (_best(_places(left, letter)) for letter in ("x", "y"))
    heading = _best(_headings([column for column in left if column not in (x, y)]))
    rest = [column for column in left if column not in (x, y, heading)]
    angles = [_best(_wheels(rest, side)) for side in _SIDES]
    powers = [_best(_powers(rest, side)) for side in _SIDES]
    both = powers if None not in powers else [None, None]
    return RobotColumns(x, y, heading, angles[0], angles[1], both[0], both[1])


def holds_quaternion(columns: Sequence[TableColumn]) -> bool:
    """Whether a table tells its orientation by a quaternion, which is no heading."""
    return any(_words(column) & _QUATERNION for column in columns)


def _best(rated: Iterator[tuple[float, TableColumn]]) -> TableColumn | None:
    """The column that rates best; of equals the first."""
    return max(rated, key=lambda each: each[0], default=(0.0, None))[1]


def _words(column: TableColumn) -> set[str]:
    return set(column.words)


def _from_outside(words: set[str]) -> float:
    return 2.0 * bool(words & _OUTSIDE) - 2.0 * bool(words & _INSIDE)


def _places(columns: Sequence[TableColumn], letter: str) -> Iterator[tuple[float, TableColumn]]:
    """Columns such as `x`, `x_mm`, `pose.position.x`, `xpos`."""
    for column in columns:
        words = _words(column)
        is_named = letter in words or bool(words & {f"{letter}pos", f"pos{letter}", f"p{letter}"})
        measures, _ = quantity_and_unit(column)
        if is_named and measures in ("", "position") and not words & _NO_PLACE and column.span > 0.0:
            yield 5.0 + _from_outside(words) + (measures == "position"), column


def _headings(columns: Sequence[TableColumn]) -> Iterator[tuple[float, TableColumn]]:
    for column in columns:
        words = _words(column)
        sided = any(words & side for side in _SIDES) or bool(words & _WHEEL - {"rad"})
        measures, _ = quantity_and_unit(column)
        is_quaternion = words & _QUATERNION and words & {"x", "y", "z", "w"}
        fits = (
            words & _HEADING
            and not is_quaternion
            and not sided
            and not words & (_SPEEDS | {"cmd", "goal", "target", "gyro"})
        )
        if fits and measures in ("", "angle") and column.span > 0.0:
            plain = 3.0 * bool(words & {"heading", "theta", "yaw", "th", "psi"})
            yield 1.0 + plain + _from_outside(words), column


def _wheels(columns: Sequence[TableColumn], side: frozenset[str]) -> Iterator[tuple[float, TableColumn]]:
    """Columns of a side that count or are an angle."""
    for column in columns:
        words = _words(column)
        measures, _ = quantity_and_unit(column)
        counts = has(column, "angle") or has(column, "raw") or bool(words & _WHEEL)
        other = words & _SPEEDS or _is_power(column) or measures in ("speed", "time", "voltage", "current")
        if words & side and counts and not other and column.span > 0.0:
            yield 1.0 + 2.0 * (measures in ("angle", "ticks")) + has(column, "raw"), column


def _powers(columns: Sequence[TableColumn], side: frozenset[str]) -> Iterator[tuple[float, TableColumn]]:
    for column in columns:
        words = _words(column)
        if words & side and _is_power(column) and not words & _SPEEDS:
            yield 1.0 + (quantity_and_unit(column)[0] == "power"), column


def _is_power(column: TableColumn) -> bool:
    return has(column, "power") or quantity_and_unit(column)[0] == "power"
