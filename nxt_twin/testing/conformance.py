"""Checks that any brick has to pass, real or mock, over any link.

Each check takes an opener, which gives a connected `Brick`. It leaves the brick as it found it: motors turn for a
moment, and one file is made and deleted. Port 4 needs an ultrasonic sensor. Nothing here needs pytest:

    for check in CHECKS:
        check(lambda: nxt_twin.open_brick("usb:"))
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Final, final

from firmware_protocol import InputPort, MotorMode, OutputPort, RunState, SensorMode, SensorType, Status
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import CommandRefusedError, RequestError

OpenBrick = Callable[[], Brick]
"""Connects to the brick; called more than once, one connection after the other."""

FILE_NAME: Final = "conformance.txt"


@final
class NotConformingError(AssertionError):
    """A brick that does not do what any brick does; the text says what it did instead."""


def check_says_who_it_is(open_brick: OpenBrick) -> None:
    """It has a name of 1 to 15 characters, an address of LEGO's, and firmware 1.x."""
    with open_brick() as brick:
        info = brick.device.info().value
        _within(len(info.name), 1, 15, "characters of the name")
        _equal(info.bluetooth_address[:9], "00:16:53:", "maker in the address")
        _equal(brick.device.versions().value.firmware[:2], "1.", "firmware")


def check_tells_a_battery_voltage_that_can_be(open_brick: OpenBrick) -> None:
    """Its battery gives 5 to 10 V."""
    with open_brick() as brick:
        _within(brick.device.battery_v().value, 5.0, 10.0, "battery voltage")


def check_stamps_frame_each_reply_and_never_go_back(open_brick: OpenBrick) -> None:
    """Every reply is stamped when it was asked for and when it came, and stamps never go back."""
    with open_brick() as brick:
        before_s = 0.0
        for _ in range(5):
            reply = brick.motors.read(OutputPort.A)
            _in_order("stamps", before_s, reply.sent_s, reply.received_s)
            before_s = reply.received_s


def check_takes_what_a_motor_is_set_to(open_brick: OpenBrick) -> None:
    """A motor that was told to run says so, with the power and mode it was given."""
    with open_brick() as brick:
        brick.motors.drive(OutputPort.B, 20)
        state = brick.motors.read(OutputPort.B).value
        told = (state.port, state.power_pct, state.mode)
        _equal(told, (OutputPort.B, 20, MotorMode.ON | MotorMode.BRAKE), "port, power and mode")
        _equal(state.run_state, RunState.RUNNING, "run state")
        brick.motors.coast(OutputPort.B)


def check_takes_commands_that_want_no_reply(open_brick: OpenBrick) -> None:
    """A command that wants no reply is executed like any other."""
    with open_brick() as brick:
        brick.motors.drive(OutputPort.C, -20, confirm=False)
        _equal(brick.motors.read(OutputPort.C).value.power_pct, -20, "power")


def check_leaving_lets_motors_coast(open_brick: OpenBrick) -> None:
    """Leaving the `with` block lets motors coast."""
    with open_brick() as brick:
        brick.motors.drive(OutputPort.A, 15)
    with open_brick() as brick:
        state = brick.motors.read(OutputPort.A).value
        _equal(state.mode & MotorMode.ON, 0, "motor-on bit")
        _equal(state.run_state, RunState.IDLE, "run state")


def check_an_exception_lets_motors_coast(open_brick: OpenBrick) -> None:
    """So does an exception that leaves it."""
    try:
        with open_brick() as brick:
            brick.motors.brake(OutputPort.A)
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        pass
    with open_brick() as brick:
        _equal(brick.motors.read(OutputPort.A).value.mode & MotorMode.ON, 0, "motor-on bit")


def check_refuses_ports_that_there_are_not(open_brick: OpenBrick) -> None:
    """Ports that do not exist are refused, and the link goes on."""
    with open_brick() as brick:
        for ask in (lambda: brick.motors.read(7), lambda: brick.sensors.read(9)):
            _refused(ask, Status.VALUE_OUT_OF_RANGE)
        _equal(brick.motors.read(OutputPort.A).value.port, OutputPort.A, "port afterwards")


def check_takes_what_a_sensor_port_is_set_to(open_brick: OpenBrick) -> None:
    """A sensor port keeps type and mode, and reads within the converter's range."""
    with open_brick() as brick:
        brick.sensors.set_mode(InputPort.S1, SensorType.SWITCH, SensorMode.BOOLEAN)
        reading = brick.sensors.read_valid(InputPort.S1).value
        told = (reading.sensor_type, reading.sensor_mode)
        _equal(told, (SensorType.SWITCH, SensorMode.BOOLEAN), "type and mode")
        _within(reading.raw, 0, 1023, "raw reading")


def check_measures_a_distance_on_port_4(open_brick: OpenBrick) -> None:
    """The ultrasonic sensor on port 4 gives distances of 0 to 255 cm."""
    with open_brick() as brick:
        brick.ultrasonic.set_up(InputPort.S4)
        for _ in range(3):
            distance = brick.ultrasonic.distance_cm(InputPort.S4)
            _within(distance.value, 0, 255, "distance")
            _in_order("stamps", distance.sent_s, distance.received_s)


def check_a_port_that_is_not_digital_is_not_ready(open_brick: OpenBrick) -> None:
    """A port with an analogue type refuses I2C."""
    with open_brick() as brick:
        brick.sensors.set_mode(InputPort.S2, SensorType.SWITCH)
        _refused(lambda: brick.low_speed.write(InputPort.S2, b"\x02\x42"), Status.CHANNEL_NOT_READY)


def check_keeps_files_of_any_size(open_brick: OpenBrick) -> None:
    """Files of any size are kept to the byte, found and deleted."""
    with open_brick() as brick:
        for size in (1, 58, 59, 122, 300):
            content = bytes(number % 251 for number in range(size))
            brick.transfer.write(FILE_NAME, content, replace=True)
            _equal(brick.transfer.read(FILE_NAME).value, content, f"file of {size} bytes")
            names = [entry.name for entry in brick.transfer.list("*.txt").value]
            _equal(names.count(FILE_NAME), 1, "entries of the file in the list")
        brick.files.delete(FILE_NAME)
        _equal(brick.transfer.list(FILE_NAME).value, (), "files after the deletion")


def check_a_file_is_not_overwritten_unasked(open_brick: OpenBrick) -> None:
    """A file that exists is refused, and keeps its content."""
    with open_brick() as brick:
        brick.transfer.write(FILE_NAME, b"first", replace=True)
        _refused(lambda: brick.transfer.write(FILE_NAME, b"second"), Status.FILE_EXISTS)
        _equal(brick.transfer.read(FILE_NAME).value, b"first", "content")
        brick.files.delete(FILE_NAME)


def check_a_missing_file_is_named_so(open_brick: OpenBrick) -> None:
    """Reading or deleting a file that is not there is refused as such."""
    with open_brick() as brick:
        _refused(lambda: brick.transfer.read("nobody.txt"), Status.FILE_NOT_FOUND)
        _refused(lambda: brick.files.delete("nobody.txt"), Status.FILE_NOT_FOUND)


def check_files_leave_no_handle_open(open_brick: OpenBrick) -> None:
    """More files are read and listed than the brick has handles."""
    with open_brick() as brick:
        brick.transfer.write(FILE_NAME, b"content", replace=True)
        for _ in range(20):
            brick.transfer.read(FILE_NAME)
            brick.transfer.list()
        brick.files.delete(FILE_NAME)


def check_without_a_program_there_are_no_mailboxes(open_brick: OpenBrick) -> None:
    """Without a program there is no current one, and no mailbox."""
    with open_brick() as brick:
        _equal(brick.programs.current().value, None, "current program")
        _refused(lambda: brick.messages.read(10), Status.NO_ACTIVE_PROGRAM)


def check_keeps_a_setting(open_brick: OpenBrick) -> None:
    """The volume that was set is the volume that is told."""
    with open_brick() as brick:
        before = brick.device.volume().value
        brick.device.set_volume(1)
        _equal(brick.device.volume().value, 1, "volume")
        brick.device.set_volume(before)


def check_tells_its_sleep_timeout(open_brick: OpenBrick) -> None:
    """Both commands that tell the sleep timeout agree."""
    with open_brick() as brick:
        _equal(brick.device.keep_awake().value, brick.device.sleep_timeout_s().value, "sleep timeout")


def check_a_value_that_fits_no_field_is_not_sent(open_brick: OpenBrick) -> None:
    """A value that fits no field raises before anything is sent."""
    with open_brick() as brick:
        try:
            brick.motors.drive(OutputPort.A, 1000)
        except RequestError:
            pass
        else:
            raise NotConformingError("a power of 1000 % was sent")
        _within(brick.device.battery_v().value, 0.1, 10.0, "battery voltage afterwards")


def check_serves_one_client_after_the_other(open_brick: OpenBrick) -> None:
    """Clients may come and go."""
    for _ in range(3):
        with open_brick() as brick:
            _within(brick.device.battery_v().value, 0.1, 10.0, "battery voltage")


def _refused(ask: Callable[[], object], status: Status) -> None:
    try:
        ask()
    except CommandRefusedError as error:
        _equal(error.status, status, "reason of the refusal")
        return
    raise NotConformingError(f"the brick did not refuse; {status.name} was to be expected")


def _equal(found: object, wanted: object, what: str) -> None:
    if found != wanted:
        raise NotConformingError(f"{what}: {found!r}, not {wanted!r}")


def _within(found: float, least: float, most: float, what: str) -> None:
    if not least <= found <= most:
        raise NotConformingError(f"{what}: {found}, not {least} to {most}")


def _in_order(what: str, *values: float) -> None:
    if any(later < sooner for sooner, later in pairwise(values)):
        raise NotConformingError(f"{what}: {values} go back")


CHECKS: Final[tuple[Callable[[OpenBrick], None], ...]] = tuple(
    check for name, check in sorted(globals().items()) if name.startswith("check_")
)
"""All of them, by name."""
