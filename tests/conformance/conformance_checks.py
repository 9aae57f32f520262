"""What any brick has to do, whatever it is made of and however it is reached.

Each check takes an opener, which gives a connected `Brick`, and leaves the brick as it found it: motors turn
for a moment, one file is made and deleted. Nothing here needs pytest, so that others can use it too.
"""

from __future__ import annotations

from collections.abc import Callable

from firmware_protocol import InputPort, MotorMode, OutputPort, RunState, SensorMode, SensorType, Status
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import CommandRefusedError, RequestError

OpenBrick = Callable[[], Brick]

FILE_NAME = "conformance.txt"


def check_says_who_it_is(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        info = brick.device.info().value
        assert 0 < len(info.name) <= 15
        assert info.bluetooth_address.startswith("00:16:53:")
        assert brick.device.versions().value.firmware.startswith("1.")


def check_tells_a_battery_voltage_that_can_be(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        assert 5.0 < brick.device.battery_v().value < 10.0


def check_stamps_frame_each_reply_and_never_go_back(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        before_s = 0.0
        for _ in range(5):
            reply = brick.motors.read(OutputPort.A)
            assert before_s <= reply.sent_s <= reply.received_s
            before_s = reply.received_s


def check_takes_what_a_motor_is_set_to(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.motors.drive(OutputPort.B, 20)
        state = brick.motors.read(OutputPort.B).value
        assert (state.port, state.power_pct, state.mode) == (OutputPort.B, 20, MotorMode.ON | MotorMode.BRAKE)
        assert state.run_state == RunState.RUNNING
        brick.motors.coast(OutputPort.B)


def check_takes_commands_that_want_no_reply(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.motors.drive(OutputPort.C, -20, confirm=False)
        assert brick.motors.read(OutputPort.C).value.power_pct == -20


def check_leaving_lets_motors_coast(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.motors.drive(OutputPort.A, 15)
    with open_brick() as brick:
        state = brick.motors.read(OutputPort.A).value
        assert not state.mode & MotorMode.ON
        assert state.run_state == RunState.IDLE


def check_an_exception_lets_motors_coast(open_brick: OpenBrick) -> None:
    try:
        with open_brick() as brick:
            brick.motors.brake(OutputPort.A)
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        pass
    with open_brick() as brick:
        assert not brick.motors.read(OutputPort.A).value.mode & MotorMode.ON


def check_refuses_ports_that_there_are_not(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        for ask in (lambda: brick.motors.read(7), lambda: brick.sensors.read(9)):
            assert _refusal(ask) is Status.VALUE_OUT_OF_RANGE
        assert brick.motors.read(OutputPort.A).value.port == OutputPort.A


def check_takes_what_a_sensor_port_is_set_to(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.sensors.set_mode(InputPort.S1, SensorType.SWITCH, SensorMode.BOOLEAN)
        reading = brick.sensors.read_valid(InputPort.S1).value
        assert (reading.sensor_type, reading.sensor_mode) == (SensorType.SWITCH, SensorMode.BOOLEAN)
        assert 0 <= reading.raw <= 1023


def check_measures_a_distance_on_port_4(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.ultrasonic.set_up(InputPort.S4)
        for _ in range(3):
            distance = brick.ultrasonic.distance_cm(InputPort.S4)
            assert 0 <= distance.value <= 255
            assert distance.sent_s <= distance.received_s


def check_a_port_that_is_not_digital_is_not_ready(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.sensors.set_mode(InputPort.S2, SensorType.SWITCH)
        assert _refusal(lambda: brick.low_speed.write(InputPort.S2, b"\x02\x42")) is Status.CHANNEL_NOT_READY


def check_keeps_files_of_any_size(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        for size in (1, 58, 59, 122, 300):
            content = bytes(number % 251 for number in range(size))
            brick.transfer.write(FILE_NAME, content, replace=True)
            assert brick.transfer.read(FILE_NAME).value == content
            assert FILE_NAME in [entry.name for entry in brick.transfer.list("*.txt").value]
        brick.files.delete(FILE_NAME)
        assert brick.transfer.list(FILE_NAME).value == ()


def check_a_file_is_not_overwritten_unasked(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.transfer.write(FILE_NAME, b"first", replace=True)
        assert _refusal(lambda: brick.transfer.write(FILE_NAME, b"second")) is Status.FILE_EXISTS
        assert brick.transfer.read(FILE_NAME).value == b"first"
        brick.files.delete(FILE_NAME)


def check_a_missing_file_is_named_so(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        assert _refusal(lambda: brick.transfer.read("nobody.txt")) is Status.FILE_NOT_FOUND
        assert _refusal(lambda: brick.files.delete("nobody.txt")) is Status.FILE_NOT_FOUND


def check_files_leave_no_handle_open(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        brick.transfer.write(FILE_NAME, b"content", replace=True)
        for _ in range(20):
            brick.transfer.read(FILE_NAME)
            brick.transfer.list()
        brick.files.delete(FILE_NAME)


def check_without_a_program_there_are_no_mailboxes(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        assert brick.programs.current().value is None
        assert _refusal(lambda: brick.messages.read(10)) is Status.NO_ACTIVE_PROGRAM


def check_keeps_a_setting(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        before = brick.device.volume().value
        brick.device.set_volume(1)
        assert brick.device.volume().value == 1
        brick.device.set_volume(before)


def check_tells_its_sleep_timeout(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        assert brick.device.keep_awake().value == brick.device.sleep_timeout_s().value


def check_a_value_that_fits_no_field_is_not_sent(open_brick: OpenBrick) -> None:
    with open_brick() as brick:
        try:
            brick.motors.drive(OutputPort.A, 1000)
        except RequestError:
            pass
        else:
            raise AssertionError("a power of 1000 % was sent")
        assert brick.device.battery_v().value > 0


def check_serves_one_client_after_the_other(open_brick: OpenBrick) -> None:
    for _ in range(3):
        with open_brick() as brick:
            assert brick.device.battery_v().value > 0


def _refusal(ask: Callable[[], object]) -> Status:
    try:
        ask()
    except CommandRefusedError as error:
        return error.status
    raise AssertionError("the brick did not refuse")


CHECKS: tuple[Callable[[OpenBrick], None], ...] = tuple(
    check for name, check in sorted(globals().items()) if name.startswith("check_")
)
