"""The residual of the wheels and the geometry: errors of short windows, and their causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import RegimeFinding, Spell
from nxt_twin.diagnose.robot.fit import robust_nats, sandwich
from nxt_twin.diagnose.robot.rolled import body_motion
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry

LENGTH_S: Final = 1.0  # of each window whose errors are examined
STRUCTURED_NATS: Final = 6.0  # least gain from letting an error go with a covariate
STRUCTURED_SHARE: Final = 0.1
"""What is left is more than noise where letting it go with something gains so much and accounts for such a share."""
LEAST_M: Final = 1e-4  # least error of place in a window of a second
LEAST_RAD: Final = 5e-4
"""Less in a second is nobody's physics. A simulated pose without noise shows a tyre that creeps by 15 µm."""
_CHANNELS: Final = ("along", "sideways", "turn")
_CLIP: Final = 5.0  # standard deviations to which scores farther out are drawn in
_MAD: Final = 1.4826  # standard deviation of normal values over their median absolute deviation
_FEWEST: Final = 30  # windows below which no residual is examined
_SPELL_SIGMA: Final = 6.0  # standard deviations above which a window's error belongs to a spell
_MOST_SPELLS: Final = 12  # that are told, the strongest
_TURNS_RAD_S: Final = 0.25  # rate above which a window turns; below a fifth of it, a window is straight
_FAST_SHARE: Final = 0.7  # of the highest speed, above which a window is fast


@final
@dataclass(frozen=True)
class ShortErrors:
    """Errors of windows of a second, none overlapping, and what the robot did in them.

    Attributes:
        run: index of each window's run, shape (windows,).
        start_s, end_s: on the recording's clock.
        errors: measured minus predicted, along the robot (m), to its left (m) and in heading (rad), shape (3, windows).
        scores: errors over their robust standard deviation.
        travel_m, turn_rad, took_s: what was made by the wheels, and in which time.
        heading_rad, x_m, y_m: where, at the middle.
        ends: heading at begin and end, shape (2, windows).
        wheel_ends: angle of the left and the right wheel at begin and end, shape (2, 2, windows).
    """

    run: IntArray
    start_s: FloatArray
    end_s: FloatArray
    errors: FloatArray
    scores: FloatArray
    travel_m: FloatArray
    turn_rad: FloatArray
    took_s: FloatArray
    heading_rad: FloatArray
    x_m: FloatArray
    y_m: FloatArray
    ends: FloatArray
    wheel_ends: FloatArray


@final
@dataclass(frozen=True)
class RobotLeft:
    """The residual along one covariate.

    Attributes:
        along: what it goes with.
        channel: which error does.
        nats: what letting the error go with it gains.
        size: the share of the error's variance that it accounts for.
        amount: its root mean square over a second, m or rad; infinite where it is none of a pose.
    """

    along: str
    channel: str
    nats: float
    size: float
    amount: float = np.inf

    @property
    def is_structured(self) -> bool:
        """Whether it is more than noise, and more than nothing."""
        least = LEAST_RAD if self.channel == "turn" else LEAST_M
        return self.nats > STRUCTURED_NATS and self.size > STRUCTURED_SHARE and self.amount > least


def short_errors(
    runs: Sequence[RobotRun],
    geometry: Geometry,
    wheels: Sequence[tuple[FloatArray, FloatArray]],
    scale: FloatArray | None = None,
) -> ShortErrors:
    """Errors of a geometry over windows of a second, each begun at its measured pose.

    Args:
        runs: the recordings.
        geometry: the model.
        wheels: of each run, the angles of its wheels when the poses were taken.
        scale: standard deviations to measure the scores by, shape (3,); None for the errors' own.
    """
    parts = [
        _of_run(index, run, geometry, angles)
        for index, (run, angles) in enumerate(zip(runs, wheels, strict=True))
    ]
    table = np.concatenate(parts, axis=1)
    errors = table[3:6]
    own = (
        _MAD * np.median(np.abs(errors - np.median(errors, axis=1)[:, None]), axis=1)
        if scale is None
        else scale
    )
    scores = errors / np.maximum(own, 1e-5)[:, None]
    travel, turn, took_s, heading, x_m, y_m = table[6:12]
    return ShortErrors(
        table[0].astype(np.int64), table[1], table[2], errors, scores, travel, turn, took_s, heading, x_m, y_m,
        table[12:14], table[14:18].reshape(2, 2, -1),
    )  # fmt: skip


def scale_of(short: ShortErrors) -> FloatArray:
    """The standard deviations by which the scores were measured, shape (3,)."""
    return np.asarray(np.median(np.abs(short.errors) / np.maximum(np.abs(short.scores), 1e-12), axis=1))


def _of_run(
    index: int, run: RobotRun, geometry: Geometry, wheels: tuple[FloatArray, FloatArray]
) -> FloatArray:
    count = max(1, int(run.duration_s / LENGTH_S))
    edges = np.searchsorted(run.time_s, run.time_s[0] + LENGTH_S * np.arange(count + 1))
    edges = np.unique(np.minimum(edges, run.time_s.size - 1))
    begin, end = edges[:-1], edges[1:]
    motion = body_motion(run.pose, geometry)
    left = geometry.left_wheel_radius_m * (wheels[0][end] - wheels[0][begin])
    right = geometry.right_wheel_radius_m * (wheels[1][end] - wheels[1][begin])
    turn, travel = (right - left) / geometry.track_m, 0.5 * (left + right)
    heading = motion.heading_rad
    middle = (begin + end) // 2
    return np.array(
        [
            np.full(begin.size, float(index)),
            run.time_s[begin],
            run.time_s[end],
            motion.along_m[end] - motion.along_m[begin] - travel,
            motion.aside_m[end] - motion.aside_m[begin],
            heading[end] - heading[begin] - turn,
            travel,
            turn,
            run.time_s[end] - run.time_s[begin],
            0.5 * (heading[begin] + heading[end]),
            run.pose.x_m[middle],
            run.pose.y_m[middle],
            heading[begin],
            heading[end],
            *(angles[edge] for angles in wheels for edge in (begin, end)),
        ]
    )


def what_is_left(short: ShortErrors) -> list[RobotLeft]:
    """The covariates that the errors depend on beyond chance, most first."""
    if short.run.size < _FEWEST:
        return []
    base = base_columns(short)
    found = []
    for channel, scores, unit in zip(_CHANNELS, short.scores, scale_of(short), strict=True):
        for along, columns in _covariates(short).items():
            one = _along(along, channel, clipped(scores), base, columns, short.run)
            found.append(replace(one, amount=float(unit * one.amount)))
    return sorted(found, key=lambda left: -left.nats)


def base_columns(short: ShortErrors) -> FloatArray:
    """The travel and turn that a geometry scales, as columns of unit size, shape (windows, 4)."""
    columns = [short.travel_m, short.turn_rad, np.abs(short.travel_m), np.abs(short.turn_rad)]
    return _unit(np.array(columns).T)


def clipped(scores: FloatArray) -> FloatArray:
    """Scores, the farthest drawn in."""
    return np.clip(scores, -_CLIP, _CLIP)


def _covariates(short: ShortErrors) -> Mapping[str, list[FloatArray]]:
    """The covariates that an error may depend on; all are zero for a robot at rest."""
    travel, heading = short.travel_m, short.heading_rad
    begin, end = short.ends
    return {
        "direction": [np.abs(travel) * wave(k * heading) for k in (1, 2) for wave in (np.cos, np.sin)],
        "axis of travel": [travel * wave(2.0 * heading) for wave in (np.cos, np.sin)],
        "heading": [wave(k * end) - wave(k * begin) for k in (1, 2) for wave in (np.cos, np.sin)],
        "place": [
            amount * place
            for amount in (travel, short.turn_rad)
            for place in (short.x_m - short.x_m.mean(), short.y_m - short.y_m.mean())
        ],
        "speed": [
            travel * np.abs(travel) / short.took_s,
            short.turn_rad * np.abs(short.turn_rad) / short.took_s,
        ],
        "time": [travel * short.start_s, short.turn_rad * short.start_s],
        **{
            f"angle of the {side} wheel": [wave(stop) - wave(start) for wave in (np.cos, np.sin)]
            for side, (start, stop) in zip(("left", "right"), short.wheel_ends, strict=True)
        },
    }


def _along(
    along: str,
    channel: str,
    scores: FloatArray,
    plain: FloatArray,
    columns: list[FloatArray],
    run: IntArray,
) -> RobotLeft:
    """A linear law in the columns beside the base's, tested with the runs as independent parts."""
    table = _unit(np.array(columns).T)
    freed = table - plain @ np.linalg.lstsq(plain, table, rcond=None)[0]
    rest = scores - plain @ np.linalg.lstsq(plain, scores, rcond=None)[0]
    kept = np.std(freed, axis=0) > 0.05
    if not kept.any():
        return RobotLeft(along, channel, 0.0, 0.0, 0.0)
    freed = freed[:, kept]
    curvature = freed.T @ freed + 1e-6 * len(freed) * np.eye(freed.shape[1])
    inverse: FloatArray = np.asarray(np.linalg.inv(curvature), dtype=np.float64)
    effect = inverse @ freed.T @ rest
    explained = freed @ effect
    after = rest - explained
    cluster = run if np.unique(run).size >= 3 * freed.shape[1] else np.arange(run.size) // 5
    doubt, clusters = sandwich((freed * after[:, None]).T, cluster, inverse)
    plain_doubt = inverse * float(np.mean(after**2))
    wider = max(1.0, float(np.mean(np.diag(doubt) / np.diag(plain_doubt))))
    squared = float(effect @ np.linalg.solve(wider * plain_doubt, effect))
    nats = robust_nats(squared, clusters) - 2.0 * freed.shape[1]
    varies = float(np.var(explained))
    return RobotLeft(along, channel, nats, varies / max(float(np.var(rest)), 1e-12), float(np.sqrt(varies)))


def _unit(table: FloatArray) -> FloatArray:
    return np.asarray(table / np.maximum(np.sqrt(np.mean(table**2, axis=0)), 1e-12))


def regimes_of(short: ShortErrors) -> tuple[RegimeFinding, ...]:
    """In which ways of driving the errors gather, strongest first."""
    rate = short.turn_rad / short.took_s
    speed = np.abs(short.travel_m) / short.took_s
    fast = _FAST_SHARE * float(np.max(speed, initial=0.0))
    rests = (speed < 5e-3) & (np.abs(rate) < 0.02)
    regimes = {
        "rest": rests,
        "straight": ~rests & (np.abs(rate) < 0.2 * _TURNS_RAD_S),
        "turning_left": rate > _TURNS_RAD_S,
        "turning_right": rate < -_TURNS_RAD_S,
        "high_speed": speed > fast,
        "backwards": short.travel_m < -5e-3,
    }
    found = [_regime(name, short.scores[:, inside]) for name, inside in regimes.items() if inside.sum() >= 5]
    return tuple(sorted(found, key=lambda finding: -finding.strength))


def _regime(name: str, scores: FloatArray) -> RegimeFinding:
    means = clipped(scores).mean(axis=1)
    beyond = float(np.max(np.abs(means) * np.sqrt(scores.shape[1])))
    return RegimeFinding(name, beyond, float(min(1.0, 3.0 * np.exp(-0.5 * beyond**2))))


def spells_of(short: ShortErrors, runs: Sequence[RobotRun]) -> tuple[Spell, ...]:
    """Stretches of time in which the model is far off, strongest first."""
    strength = np.max(np.abs(short.scores), axis=0)
    found: list[Spell] = []
    for index, run in enumerate(runs):
        here = np.flatnonzero(short.run == index)
        flags = np.concatenate([[0], (strength[here] > _SPELL_SIGMA).astype(np.int8), [0]])
        edges = np.flatnonzero(np.diff(flags)).reshape(-1, 2)
        found += [
            Spell(
                run.name,
                float(short.start_s[here[first]]),
                float(short.end_s[here[last - 1]]),
                float(np.max(strength[here[first:last]])),
            )
            for first, last in edges
        ]
    return tuple(sorted(found, key=lambda spell: -spell.strength)[:_MOST_SPELLS])
