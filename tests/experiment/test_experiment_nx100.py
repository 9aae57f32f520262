import pytest
from experiment_bench import Impatient

from nxt_twin.experiment.errors import PositionerError
from nxt_twin.experiment.positioner.nx100 import Nx100Robot, RobotSetUp
from nxt_twin.experiment.positioner.nx100_session import Nx100Session, TcpWire, status_of
from nxt_twin.experiment.positioner.positioner import Limits
from nxt_twin.experiment.standin.nx100 import InMemoryWire, Nx100Server, Nx100Standin, RobotState
from nxt_twin.mock.serve.clock import VirtualClock


class Told:
    """A wire whose answers are given in advance, byte by byte as they may come."""

    def __init__(self, *answers: bytes) -> None:
        self.sent: list[bytes] = []
        self._answers = list(answers)

    def send(self, data: bytes) -> None:
        self.sent.append(data)

    def receive(self, timeout_s: float) -> bytes:
        if not self._answers:
            raise TimeoutError(f"{timeout_s} s")
        return self._answers.pop(0)

    def close(self) -> None:
        self.sent.append(b"closed")


HELLO = b"OK: NX Information Server(1.10) Keep-Alive:-1.\r\n"


def robot_on(state: RobotState, set_up: RobotSetUp | None = None, **limits: float) -> Nx100Robot:
    session = Nx100Session(InMemoryWire(Nx100Standin(state)))
    box = Limits(**limits) if limits else None
    return Nx100Robot(session, set_up or RobotSetUp(value_now=100.0), "distance_mm", state.clock, box)


def test_the_bytes_of_a_request_with_data() -> None:
    wire = Told(HELLO, b"OK: RPOSC\r\n", b"353.769,202.779,", b"120.658,-1.34,35.78,27.84,0,0\r")
    position = Nx100Session(wire).position()
    assert wire.sent == [
        b"CONNECT Robot_access Keep-Alive:-1\r\n",
        b"HOSTCTRL_REQUEST RPOSC 4\r\n",
        b"0,0\r",
    ]
    assert position == (353.769, 202.779, 120.658, -1.34, 35.78, 27.84, 0.0, 0.0)


def test_answers_may_come_together_or_in_pieces() -> None:
    together = Nx100Session(Told(HELLO, b"OK: RSTATS\r\n194,64\r"))
    assert together.status() == status_of("194,64")
    pieces = Nx100Session(Told(HELLO, b"OK: RST", b"ATS\r", b"\n19", b"4,64\r"))
    status = pieces.status()
    assert (status.command_remote, status.servo_on, status.alarm, status.running) == (
        True,
        True,
        False,
        False,
    )


def test_status_bits() -> None:
    assert status_of("136,0").running
    assert status_of("128,32").error
    assert status_of("128,16").alarm
    assert all(status_of(f"128,{bit}").held for bit in (8, 4, 2))
    assert not status_of("64,0").command_remote


@pytest.mark.parametrize(
    ("answers", "says"),
    [
        ((b"NG: HTTP Error Response\r\n",), "refuses the session"),
        ((HELLO, b"NG: No such command\r\n"), "is refused"),
        ((HELLO, b"OK: RSTATS\r\n", b"ERROR: RSTATS is not successful(2100).\r\n"), "REMOTE"),
        ((HELLO, b"OK: RSTATS\r\n", b"ERROR:[RSTATS] is not successful(2060).\r\n"), "alarm"),
        ((HELLO, b"OK: RSTATS\r\n", b"nonsense\r"), "RSTATS gave"),
        ((HELLO, b"OK: RSTATS\r\n", b""), "lost"),
        ((HELLO,), "did not answer"),
        ((HELLO, b"x" * 5000, b"x" * 5000), "lost"),
    ],
)
def test_every_refusal_is_named(answers: tuple[bytes, ...], says: str) -> None:
    with pytest.raises(PositionerError, match=says):
        Nx100Session(Told(*answers)).status()


def test_a_robot_goes_there_and_takes_its_time() -> None:
    state = RobotState(VirtualClock())
    start = state.pose
    robot = robot_on(state)
    assert robot.move_to(300.0) == pytest.approx(300.0, abs=0.01)
    assert state.clock.now_s() == pytest.approx(10.0, abs=0.3)
    assert state.now()[2] - start[2] == pytest.approx(200.0)
    assert state.now()[3:] == pytest.approx(start[3:])
    robot.close()
    assert state.held
    assert not state.servo_on


def test_a_robot_turns_by_posture_speed() -> None:
    state = RobotState(VirtualClock())
    session = Nx100Session(InMemoryWire(Nx100Standin(state)))
    robot = Nx100Robot(session, RobotSetUp("ry", speed=10.0), "angle_deg", state.clock)
    assert robot.move_to(30.0) == pytest.approx(30.0, abs=0.01)
    assert state.now()[4] == pytest.approx(35.78 + 30.0, abs=0.01)


def test_servo_power_that_was_on_stays_on_and_a_hold_is_released() -> None:
    state = RobotState(VirtualClock(), servo_on=True, held=True)
    robot = robot_on(state)
    assert not state.held
    robot.close()
    assert state.servo_on


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        ({"remote": False}, "remote mode"),
        ({"alarm": True}, "alarm"),
        ({"refuse_session": True}, "refuses the session"),
    ],
)
def test_a_controller_that_is_not_ready_is_left_alone(fault: dict[str, bool], says: str) -> None:
    state = RobotState(VirtualClock(), **fault)  # type: ignore[arg-type]
    with pytest.raises(PositionerError, match=says):
        robot_on(state)
    assert not state.servo_on
    assert state.moves == 0


def test_too_fast_is_refused() -> None:
    with pytest.raises(PositionerError, match="not allowed"):
        robot_on(RobotState(VirtualClock()), RobotSetUp(speed=300.0))


def test_limits_are_kept_without_a_move() -> None:
    state = RobotState(VirtualClock())
    robot = robot_on(state, lowest=0.0, highest=200.0)
    with pytest.raises(PositionerError, match="outside"):
        robot.move_to(201.0)
    assert state.moves == 0


def test_out_of_reach_is_refused_by_the_controller() -> None:
    state = RobotState(VirtualClock(), reach_mm=50.0)
    with pytest.raises(PositionerError, match=r"5200.*out of range"):
        robot_on(state).move_to(300.0)
    assert state.held


def test_an_alarm_on_the_way_stops_everything() -> None:
    state = RobotState(VirtualClock(), alarm_after=1)
    with pytest.raises(PositionerError, match="alarm"):
        robot_on(state).move_to(300.0)
    assert state.held


def test_servo_power_lost_before_a_move_is_named() -> None:
    state = RobotState(VirtualClock())
    robot = robot_on(state)
    state.servo_on = False
    with pytest.raises(PositionerError, match="servo power is off"):
        robot.move_to(120.0)


def test_remote_mode_lost_before_a_move_is_named() -> None:
    state = RobotState(VirtualClock())
    robot = robot_on(state)
    state.remote = False
    with pytest.raises(PositionerError, match="command remote"):
        robot.move_to(120.0)


def test_an_interrupt_on_the_way_puts_the_robot_on_hold() -> None:
    state = RobotState(Impatient(VirtualClock(), 1.0))
    with pytest.raises(KeyboardInterrupt):
        robot_on(state).move_to(300.0)
    assert state.held
    assert not state.running
    assert state.now()[2] < 120.658 + 30.0


@pytest.mark.parametrize("moment", range(14))
def test_an_interrupt_amid_an_exchange_still_puts_the_robot_on_hold(moment: int) -> None:
    state = RobotState(VirtualClock())
    inner = InMemoryWire(Nx100Standin(state))
    left = [10**6]

    class Interrupted:
        def send(self, data: bytes) -> None:
            inner.send(data)

        def receive(self, timeout_s: float) -> bytes:
            left[0] -= 1
            if left[0] == 0:
                raise KeyboardInterrupt
            return inner.receive(timeout_s)

        def close(self) -> None:
            inner.close()

    robot = Nx100Robot(Nx100Session(Interrupted()), RobotSetUp(), "distance_mm", state.clock)
    left[0] = (
        moment + 3
    )  # the first two are of the position before the move, of which nothing has to be stopped
    with pytest.raises(KeyboardInterrupt):
        robot.move_to(200.0)
    assert state.held
    assert not state.running
    assert state.now()[2] < 120.658 + 200.0


def test_a_lost_link_is_named_and_closing_does_not_fail() -> None:
    state = RobotState(VirtualClock())
    wire = InMemoryWire(Nx100Standin(state))
    robot = Nx100Robot(Nx100Session(wire), RobotSetUp(), "distance_mm", state.clock)
    wire.cut = True
    with pytest.raises(PositionerError, match="lost"):
        robot.move_to(10.0)
    robot.close()


def test_over_real_tcp() -> None:
    state = RobotState(VirtualClock())
    with Nx100Server(state) as server:
        robot = Nx100Robot(Nx100Session(TcpWire(*server.address)), RobotSetUp(), "distance_mm", state.clock)
        assert robot.move_to(25.0) == pytest.approx(25.0, abs=0.01)
        robot.close()
    assert state.moves == 1


def test_nobody_there_is_named() -> None:
    with Nx100Server(RobotState(VirtualClock())) as server:
        address = server.address
    with pytest.raises(PositionerError, match="cannot be reached"):
        TcpWire(*address)
