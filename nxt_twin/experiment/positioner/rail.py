"""A rail that an NXT motor drives, with a rack, a belt or a thread."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import BrickError
from nxt_twin.experiment.errors import PositionerError
from nxt_twin.experiment.positioner.positioner import Limits, OneAxis, PositionerAxis, within

_POLL_S: Final = 0.005
_STUCK_S: Final = 0.6
_SETTLE_S: Final = 0.15
_HOMING_LIMIT_S: Final = 60.0
_TRIES: Final = 12
_LEAST_POWER_PCT: Final = 15
_LEAST_CREEP_DEG: Final = 15.0
_RUN_ON_DEG_PER_PCT: Final = 1.0
"""The last stretch goes at the least power; it is longer than a motor with this power, shorted, runs on."""
_FIRST_RUN_ON_DEG: Final = 4.0


@final
@dataclass(frozen=True)
class RailSetUp:
    """How a rail is built and where it stands.

    Attributes:
        mm_per_deg: how far the carriage goes for a degree of the hub; negative if forward makes the value less.
        play_deg: play in the gears, which is taken out by arriving at every place from the same side.
        power_pct: the most power used.
        home_value: the axis' value where the rail begins.
        homing: `here`: the carriage stands at `home_value` now, last moved forward; `touch`: it drives
            backward until a touch sensor is pressed, and `home_value` is there.
        touch_slot: the touch sensor's port, 0 to 3.
        tolerance_deg: how near to the place is near enough; what is left is in the value that is told.
    """

    mm_per_deg: float
    play_deg: float = 0.0
    power_pct: int = 40
    home_value: float = 0.0
    homing: Literal["here", "touch"] = "here"
    touch_slot: int = 0
    tolerance_deg: float = 2.0


@final
class Rail(OneAxis):
    """A carriage on a rail, moved by a motor of a brick that it shares with the experiment.

    Args:
        brick: the brick whose motor it is.
        port: the motor's port, 0 to 2.
        set_up: how the rail is built.
        axis: what it moves.
        clock: waits between polls.
        limits: where it may go.

    Raises:
        PositionerError: no end was found when homing, or the set-up has no meaning.
    """

    def __init__(
        self,
        brick: Brick,
        port: int,
        set_up: RailSetUp,
        axis: PositionerAxis,
        clock: Clock,
        limits: Limits | None = None,
    ) -> None:
        super().__init__(axis, limits)
        if set_up.mm_per_deg == 0.0 or not _LEAST_POWER_PCT <= set_up.power_pct <= 100:
            what = f"mm_per_deg {set_up.mm_per_deg:g}, power_pct {set_up.power_pct}"
            mend = f"mm_per_deg is not 0, power_pct {_LEAST_POWER_PCT} to 100"
            raise PositionerError(f"no rail moves with {what}", where=axis, mend=mend)
        self._brick = brick
        self._port = port
        self._set_up = set_up
        self._clock = clock
        self._run_on_deg = _FIRST_RUN_ON_DEG
        self._home_deg = self._home() if set_up.homing == "touch" else self._count()

    def move_to(self, value: float) -> float:
        """Drive there, the last stretch always forward, and let the motor coast.

        Raises:
            PositionerError: out of the limits, or the carriage is stuck.
        """
        within(self._limits, self._axis, value)
        target = (value - self._set_up.home_value) / self._set_up.mm_per_deg
        try:
            self._approach(target)
            return self._set_up.home_value + self._turned() * self._set_up.mm_per_deg
        finally:
            self.stop()

    def stop(self) -> None:
        """Let the motor coast, if the brick can still be reached."""
        try:
            self._brick.motors.coast(self._port)
        except BrickError:
            return

    def close(self) -> None:
        """Stop; the brick is the experiment's."""
        self.stop()

    def _count(self) -> int:
        return self._brick.motors.tacho_deg(self._port).value

    def _turned(self) -> float:
        return float(self._count() - self._home_deg)

    def _approach(self, target_deg: float) -> None:
        """Come from below: fast at first, then slowly; how far the motor runs on is learned from each try."""
        tolerance = self._set_up.tolerance_deg
        creep_deg = _LEAST_CREEP_DEG + _RUN_ON_DEG_PER_PCT * self._set_up.power_pct
        back_deg = self._set_up.play_deg + creep_deg
        for _ in range(_TRIES):
            left = target_deg - self._turned()
            if left < _LEAST_CREEP_DEG:
                # Where the carriage stands after a move backward depends on the play: go further and come again.
                self._drive(-(back_deg - left), self._set_up.power_pct)
                left = target_deg - self._turned()
            if left > creep_deg:
                self._drive(left - creep_deg, self._set_up.power_pct)
            left = target_deg - self._turned()
            if left <= self._run_on_deg:
                continue
            self._drive(left - self._run_on_deg, _LEAST_POWER_PCT)
            missed = self._turned() - target_deg
            if abs(missed) <= tolerance:
                return
            self._run_on_deg += 0.7 * missed
        what = f"does not come to rest within {tolerance:g} degrees of its place"
        raise PositionerError(what, where=f"rail on {self._axis}", mend="allow more tolerance_deg")

    def _drive(self, by_deg: float, power_pct: int) -> None:
        """Drive until it has turned so far, brake, and wait until it stands."""
        sign = 1.0 if by_deg > 0.0 else -1.0
        start = last = self._turned()
        since_s = self._clock.now_s()
        self._brick.motors.drive(self._port, int(sign) * power_pct)
        while sign * (last - start) < abs(by_deg):
            self._clock.sleep(_POLL_S)
            now = self._turned()
            if now != last:
                since_s, last = self._clock.now_s(), now
            elif self._clock.now_s() - since_s > _STUCK_S:
                what = f"is stuck {abs(by_deg) - sign * (now - start):.0f} degrees before its place"
                raise PositionerError(
                    what, where=f"rail on {self._axis}", mend="look what blocks the carriage"
                )
        self._brick.motors.brake(self._port)
        self._clock.sleep(_SETTLE_S)

    def _home(self) -> int:
        slot = self._set_up.touch_slot
        self._brick.sensors.set_up_touch(slot)
        self._brick.sensors.read_valid(slot)
        give_up_s = self._clock.now_s() + _HOMING_LIMIT_S
        try:
            self._brick.motors.drive(self._port, -max(_LEAST_POWER_PCT, self._set_up.power_pct // 2))
            while not self._brick.sensors.pressed(slot).value:
                if self._clock.now_s() > give_up_s:
                    what = f"found no end within {_HOMING_LIMIT_S:g} s"
                    mend = "check the touch sensor's port and on which side it is"
                    raise PositionerError(what, where=f"rail on {self._axis}", mend=mend)
                self._clock.sleep(_POLL_S)
            self._brick.motors.brake(self._port)
            self._clock.sleep(_SETTLE_S)
            # It came backward; on the way forward the play has to be taken out before the carriage follows.
            return self._count() + round(self._set_up.play_deg)
        finally:
            self.stop()
