"""An industrial robot on an NX100 controller as a positioner: one axis of its hand, in base coordinates."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Final, Literal, final

from nxt_twin.brick.clock import Clock
from nxt_twin.experiment.errors import PositionerError
from nxt_twin.experiment.positioner.nx100_session import Nx100Session
from nxt_twin.experiment.positioner.positioner import Limits, OneAxis, PositionerAxis, within

Along = Literal["x", "y", "z", "rx", "ry", "rz"]

FASTEST_MM_PER_S: Final = 250.0
"""The speed at which people may be near a robot that is being taught (ISO 10218-1); never more here."""
FASTEST_DEG_PER_S: Final = 30.0
_ORDER: Final[tuple[Along, ...]] = ("x", "y", "z", "rx", "ry", "rz")
_POLL_S: Final = 0.05
_NEAR: Final = 0.05
_ARRIVED: Final = 0.2
"""How near to its place, mm or deg, a move has ended, and at which distance it is a failure."""
_STARTS_WITHIN_S: Final = 1.0
_SPARE_S: Final = 5.0


@final
@dataclass(frozen=True)
class RobotSetUp:
    """How the robot's hand moves the axis.

    Attributes:
        along: the coordinate that is changed.
        sign: 1 if it grows with the axis' value, -1 if it falls.
        value_now: the axis' value where the robot stands when the program takes it over.
        speed: mm/s, or deg/s for a rotation.
    """

    along: Along = "z"
    sign: int = 1
    value_now: float = 0.0
    speed: float = 20.0


@final
class Nx100Robot(OneAxis):
    """A robot that is given linear moves one at a time.

    Before a move it checks that the controller is in remote mode, without alarm and error. It
    switches servo power on if it is off. All moves keep the pose that it found but for the one coordinate.

    Args:
        session: an open session, which is taken over.
        set_up: what is moved and from where.
        axis: the rig's axis.
        clock: waits for moves to end.
        limits: where it may go.

    Raises:
        PositionerError: the controller is not ready, the speed is too high, or it does not answer.
    """

    def __init__(
        self,
        session: Nx100Session,
        set_up: RobotSetUp,
        axis: PositionerAxis,
        clock: Clock,
        limits: Limits | None = None,
    ) -> None:
        super().__init__(axis, limits)
        self._session = session
        self._set_up = set_up
        self._clock = clock
        self._index = _ORDER.index(set_up.along)
        self._switched_on = False
        fastest = FASTEST_MM_PER_S if self._index < 3 else FASTEST_DEG_PER_S
        try:
            if not 0.0 < set_up.speed <= fastest:
                what = f"a speed of {set_up.speed:g} is not allowed"
                raise PositionerError(what, where=axis, mend=f"at most {fastest:g}")
            self._make_ready()
            self._start = session.position()
        except PositionerError:
            session.close()
            raise

    def move_to(self, value: float) -> float:
        """Send one linear move, wait until it has ended, and give where the robot says it is.

        Raises:
            PositionerError: out of the limits; refused; ended elsewhere; no answer. The robot is put on hold.
        """
        within(self._limits, self._axis, value)
        pose = list(self._start[:6])
        pose[self._index] += self._set_up.sign * (value - self._set_up.value_now)
        before = self._session.position()[self._index]
        try:
            self._session.request("MOVL", self._move(pose))
            self._wait(pose[self._index], abs(pose[self._index] - before) / self._set_up.speed)
            reached = self._session.position()[self._index]
        except BaseException:
            self.stop()
            raise
        if abs(reached - pose[self._index]) > _ARRIVED:
            self.stop()
            what = f"ended {reached - pose[self._index]:+.2f} from its place"
            raise PositionerError(what, where=f"robot on {self._axis}", mend="look what stopped the robot")
        return self._set_up.value_now + self._set_up.sign * (reached - self._start[self._index])

    def stop(self) -> None:
        """Put motion on hold, if the controller can still be reached."""
        with suppress(PositionerError):
            self._session.request("HOLD", "1")

    def close(self) -> None:
        """Put motion on hold, switch off servo power if it was switched on from here, and end the session."""
        self.stop()
        if self._switched_on:
            with suppress(PositionerError):
                self._session.request("SVON", "0")
            self._switched_on = False
        self._session.close()

    def _make_ready(self) -> None:
        status = self._session.status()
        if not status.command_remote:
            mend = "turn its key to REMOTE and allow command remote"
            raise PositionerError("the controller is not in remote mode", where="nx100", mend=mend)
        if status.alarm or status.error:
            what = f"the controller reports an {'alarm' if status.alarm else 'error'}"
            raise PositionerError(what, where="nx100", mend="find its cause and clear it at the controller")
        if status.held:
            self._session.request("HOLD", "0")
        if not status.servo_on:
            self._session.request("SVON", "1")
            self._switched_on = True

    def _move(self, pose: list[float]) -> str:
        """MOVL's data: which speed, the speed, base coordinates, the pose, type and tool, no external axes."""
        by_posture = int(self._index >= 3)
        place = ",".join(f"{value:.3f}" for value in pose[:3]) + "," + ",".join(f"{v:.4f}" for v in pose[3:])
        kind, tool = (int(value) for value in self._start[6:8])
        return f"{by_posture},{self._set_up.speed:.1f},0,{place},{kind},{tool},0,0,0,0,0,0"

    def _wait(self, target: float, travel_s: float) -> None:
        """Wait until the robot stands at the place; whether MOVL answers before or after the move is left open."""
        began_s = self._clock.now_s()
        while True:
            status = self._session.status()
            if status.alarm or status.error or not status.servo_on:
                what = "an alarm, an error or a loss of servo power stopped the robot"
                raise PositionerError(what, where=f"robot on {self._axis}", mend="look at the controller")
            elapsed_s = self._clock.now_s() - began_s
            if not status.running:
                if (
                    abs(self._session.position()[self._index] - target) <= _NEAR
                    or elapsed_s > _STARTS_WITHIN_S
                ):
                    return
            elif elapsed_s > 2.0 * travel_s + _SPARE_S:
                raise PositionerError("does not arrive", where=f"robot on {self._axis}", mend="look at it")
            self._clock.sleep(_POLL_S)
