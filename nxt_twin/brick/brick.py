"""A brick: its commands by theme, over one link that is let go safely."""

from __future__ import annotations

import atexit
from types import TracebackType
from typing import Self, final

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.commands.device import Device
from nxt_twin.brick.commands.files import Files
from nxt_twin.brick.commands.low_speed import LowSpeed
from nxt_twin.brick.commands.messages import Messages
from nxt_twin.brick.commands.modules import Modules
from nxt_twin.brick.commands.motors import Motors
from nxt_twin.brick.commands.programs import Programs
from nxt_twin.brick.commands.radio import Radio
from nxt_twin.brick.commands.sensors import Sensors
from nxt_twin.brick.commands.sound import SoundPlayer
from nxt_twin.brick.commands.transfer import FileTransfer
from nxt_twin.brick.commands.ultrasonic import Ultrasonic
from nxt_twin.brick.exchange import Exchange, Health
from nxt_twin.brick.link import Link
from nxt_twin.brick.policy import PACKET_POLICY, Policy


@final
class Brick:
    """A brick at the end of a link: one method a command, by theme.

    A context manager. On leaving, the motors that it engaged coast, and the link closes. The end of the
    interpreter does this too, also after an exception or Ctrl-C that nobody caught. A lost link cannot reach the
    brick, and the firmware does not stop motors by itself. Give each motor that can hit something a tacho limit.

    Args:
        link: the open link, which the brick takes over.
        clock: stamps requests and replies, and waits.
        policy: how long to wait, and how much fits the link.

    Attributes:
        motors: drive, coast, brake, read.
        sensors: touch, light, sound, and the type of every port.
        low_speed: transactions with digital sensors.
        ultrasonic: the ultrasonic sensor.
        files: the file commands.
        transfer: whole files.
        programs: start, stop.
        messages: mailboxes and datalog.
        sound: tones and sound files.
        device: name, versions, battery, sleep.
        radio: the brick's Bluetooth.
        modules: IO maps.
    """

    def __init__(self, link: Link, clock: Clock, policy: Policy = PACKET_POLICY) -> None:
        self._exchange = Exchange(link, clock, policy)
        self.motors = Motors(self._exchange)
        self.sensors = Sensors(self._exchange)
        self.low_speed = LowSpeed(self._exchange)
        self.ultrasonic = Ultrasonic(self._exchange, self.low_speed)
        self.files = Files(self._exchange)
        self.transfer = FileTransfer(self._exchange, self.files)
        self.programs = Programs(self._exchange)
        self.messages = Messages(self._exchange)
        self.sound = SoundPlayer(self._exchange)
        self.device = Device(self._exchange)
        self.radio = Radio(self._exchange)
        self.modules = Modules(self._exchange)
        atexit.register(self.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let the motors coast, if any was engaged, and close the link; closing again does nothing."""
        atexit.unregister(self.close)
        self._exchange.close()

    @property
    def health(self) -> Health:
        """What went wrong so far, and was survived."""
        return self._exchange.health

    def describe(self) -> str:
        """The link's name for a person."""
        return self._exchange.describe()
