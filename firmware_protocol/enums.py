"""Named values of the NXT: ports, motor and sensor settings, properties, modules. All are integers."""

from __future__ import annotations

from enum import IntEnum, IntFlag


class TelegramType(IntEnum):
    """The first byte of a telegram, without the no-reply bit."""

    DIRECT = 0x00
    SYSTEM = 0x01
    REPLY = 0x02


class OutputPort(IntEnum):
    """A motor port. ``ALL`` is for SET_OUT_STATE only; elsewhere it is an error."""

    A = 0
    B = 1
    C = 2
    ALL = 0xFF


class InputPort(IntEnum):
    """A sensor port: what the housing numbers 1 to 4 is 0 to 3 on the wire."""

    S1 = 0
    S2 = 1
    S3 = 2
    S4 = 3


class MotorMode(IntFlag):
    """Bits of a motor's mode; the upper four (``METHOD``) become the IO map's regulation options."""

    COAST = 0x00
    ON = 0x01
    BRAKE = 0x02
    REGULATED = 0x04
    METHOD = 0xF0


class RegulationMode(IntEnum):
    """The quantity that a motor's regulation holds; ``POSITION`` needs an enhanced firmware (1.29 builds)."""

    IDLE = 0
    SPEED = 1
    SYNC = 2
    POSITION = 4


class RunState(IntEnum):
    """A motor's phase; ``HOLD`` is internal and becomes ``RUNNING`` within the tick."""

    IDLE = 0x00
    RAMP_UP = 0x10
    RUNNING = 0x20
    RAMP_DOWN = 0x40
    HOLD = 0x60


class OutputFlags(IntFlag):
    """Which changes of the output IO map the firmware is to take over in its next tick."""

    MODE = 0x01
    SPEED = 0x02
    TACHO_LIMIT = 0x04
    RESET_COUNT = 0x08
    PID = 0x10
    RESET_BLOCK_COUNT = 0x20
    RESET_ROTATION_COUNT = 0x40
    PENDING = 0x80


class SensorType(IntEnum):
    """The sensor on a port."""

    NO_SENSOR = 0x00
    SWITCH = 0x01
    TEMPERATURE = 0x02
    REFLECTION = 0x03
    ANGLE = 0x04
    LIGHT_ACTIVE = 0x05
    LIGHT_INACTIVE = 0x06
    SOUND_DB = 0x07
    SOUND_DBA = 0x08
    CUSTOM = 0x09
    LOW_SPEED = 0x0A
    LOW_SPEED_9V = 0x0B
    HIGH_SPEED = 0x0C
    COLOR_FULL = 0x0D
    COLOR_RED = 0x0E
    COLOR_GREEN = 0x0F
    COLOR_BLUE = 0x10
    COLOR_NONE = 0x11
    COLOR_EXIT = 0x12


class SensorMode(IntEnum):
    """How a reading is scaled (upper three bits); add a slope of 0 to 31 in the lower five (0: absolute)."""

    RAW = 0x00
    BOOLEAN = 0x20
    TRANSITION_COUNT = 0x40
    PERIOD_COUNT = 0x60
    PERCENT = 0x80
    CELSIUS = 0xA0
    FAHRENHEIT = 0xC0
    ANGLE_STEPS = 0xE0


class LowSpeedState(IntEnum):
    """The state of a digital sensor's channel in the low-speed IO map."""

    IDLE = 0
    INIT = 1
    LOAD_BUFFER = 2
    COMMUNICATING = 3
    ERROR = 4
    DONE = 5


class LowSpeedMode(IntEnum):
    """The direction of a digital sensor's channel in the low-speed IO map."""

    IDLE = 0
    TRANSMITTING = 1
    RECEIVING = 2
    DATA_RECEIVED = 3


class LowSpeedFault(IntEnum):
    """Why a digital sensor's channel is in the error state, in the low-speed IO map."""

    NO_ERROR = 0
    CHANNEL_NOT_READY = 1
    TRANSMIT_ERROR = 2
    RECEIVE_ERROR = 3


class PropertyId(IntEnum):
    """A setting of the brick; the sleep timeout is in ms, the others are one byte."""

    BLUETOOTH_ON = 0
    VOLUME = 1
    SLEEP_TIMEOUT = 2


class PollBuffer(IntEnum):
    """A buffer that POLL reads."""

    USB = 0
    HIGH_SPEED = 1


class ModuleId(IntEnum):
    """A firmware module, in the order in which the brick lists them."""

    COMM = 0x00050001
    INPUT = 0x00030001
    BUTTON = 0x00040001
    DISPLAY = 0x000A0001
    LOADER = 0x00090001
    LOW_SPEED = 0x000B0001
    OUTPUT = 0x00020001
    SOUND = 0x00080001
    IO_CTRL = 0x00060001
    COMMAND = 0x00010001
    UI = 0x000C0001
