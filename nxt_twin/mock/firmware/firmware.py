"""The whole firmware: its modules, and the scheduler that runs each once a millisecond.

Source: LEGO NXT firmware 1.29, m_sched.c.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Final, final

from firmware_protocol import ModuleId
from firmware_protocol.limits import IO_MAP_SIZES
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.comm import Comm
from nxt_twin.mock.firmware.direct import DirectCommands
from nxt_twin.mock.firmware.flash import StoredFile
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.input import InputModule
from nxt_twin.mock.firmware.launcher import Launcher
from nxt_twin.mock.firmware.loader import Loader
from nxt_twin.mock.firmware.lowspeed import LowSpeedModule
from nxt_twin.mock.firmware.module import MemoryModule
from nxt_twin.mock.firmware.modules import ModuleCommands
from nxt_twin.mock.firmware.output import OutputModule
from nxt_twin.mock.firmware.program import ProgramModule
from nxt_twin.mock.firmware.radio import RadioModule
from nxt_twin.mock.firmware.settings import restore_settings
from nxt_twin.mock.firmware.sound import SoundModule
from nxt_twin.mock.firmware.system import SystemCommands
from nxt_twin.mock.firmware.ui import UiModule

DEFAULT_NAME: Final = "NXT"
DEFAULT_ADDRESS: Final = bytes.fromhex("0016530A0B0C")
SLEEP_TIMEOUT_MIN: Final = 10
_DISPLAY_SIZE: Final = 1720


@final
@dataclass(frozen=True)
class Identity:
    """What tells one brick from another, and its settings at power-on.

    Attributes:
        name: up to 15 characters.
        address: the six bytes of the Bluetooth address.
        sleep_timeout_min: after so long without KEEP_ALIVE the brick switches itself off; 0 is never.
        rename_loses_telegrams: whether telegrams over Bluetooth are lost for a second after SET_BRICK_NAME.
    """

    name: str = DEFAULT_NAME
    address: bytes = DEFAULT_ADDRESS
    sleep_timeout_min: int = SLEEP_TIMEOUT_MIN
    rename_loses_telegrams: bool = False


class Power(Enum):
    """The brick's power state."""

    ON = "on"
    OFF = "off"
    DOWNLOAD = "firmware download mode"


@final
class Firmware:
    """A brick's software on some hardware, deterministic to the byte.

    Args:
        hardware: motors, sensors and battery.
        identity: name, address and settings.
        files: what is in flash already.
    """

    def __init__(
        self, hardware: Hardware, identity: Identity | None = None, files: Iterable[StoredFile] = ()
    ) -> None:
        identity = identity or Identity()
        self.ticks = 0
        self.hardware = hardware
        self.radio = RadioModule(identity.name, identity.address)
        self.inputs = InputModule(hardware)
        self.loader = Loader(files)
        self.outputs = OutputModule(hardware)
        self.low_speed = LowSpeedModule(hardware, self.inputs)
        self.sound = SoundModule(self.loader)
        self.ui = UiModule(hardware, sleep_timeout_min=identity.sleep_timeout_min)
        self.program = ProgramModule(
            self.loader, self.outputs, self.inputs, self.low_speed, self.sound, self.ui
        )
        self._launcher = Launcher(self.ui, self.program, self.sound)
        self._system = SystemCommands(self.loader, self.radio, self._modules())
        direct = DirectCommands(
            self.outputs,
            self.inputs,
            self.low_speed,
            self.loader,
            self.program,
            self.sound,
            self.ui,
            self.radio,
        )
        lossy = identity.rename_loses_telegrams
        self._comm = Comm(self.loader, self.radio, direct, self._system, lossy=lossy)
        volume = restore_settings(self.loader, sleep_timeout_min=identity.sleep_timeout_min)
        self.ui.volume = self.sound.volume = volume

    def _modules(self) -> ModuleCommands:
        return ModuleCommands(
            (
                self.radio,
                self.inputs,
                MemoryModule(ModuleId.BUTTON, "Button.mod", IO_MAP_SIZES[ModuleId.BUTTON]),
                MemoryModule(ModuleId.DISPLAY, "Display.mod", _DISPLAY_SIZE),
                self.loader,
                self.low_speed,
                self.outputs,
                self.sound,
                MemoryModule(ModuleId.IO_CTRL, "IOCtrl.mod", IO_MAP_SIZES[ModuleId.IO_CTRL]),
                self.program,
                self.ui,
            )
        )

    @property
    def power(self) -> Power:
        """Whether the brick still runs this firmware."""
        if self._system.booted:
            return Power.DOWNLOAD
        return Power.OFF if self.ui.switched_off else Power.ON

    def switch_off(self) -> None:
        """Switch the brick off, as its button or an empty battery does."""
        self.ui.switched_off = True

    def tick(self) -> None:
        """Let one millisecond pass: the hardware's, then one pass of every module in the firmware's order."""
        self.ticks += 1
        self.hardware.step()
        if self._system.stall_ms:
            self._system.stall_ms -= 1
            return
        if self.ui.switched_off or self._system.booted:
            return
        self._comm.tick()
        self.radio.tick()
        self.inputs.tick()
        self.low_speed.tick()
        self.outputs.tick()
        self.sound.tick()
        self.program.tick()
        self._launcher.tick()
        self.ui.tick()

    def receive(self, transport: Transport, data: bytes) -> None:
        """Bytes arrive from the host: over USB one packet, over Bluetooth any part of the stream."""
        if self.power is Power.ON:
            self._comm.channels[transport].arrive(data)

    def transmit(self, transport: Transport) -> list[bytes]:
        """The brick's output since the last call; each item is one packet, or one frame."""
        if self._system.stall_ms:
            return []
        return self._comm.channels[transport].fetch()

    def unplug_usb(self) -> None:
        """Pull the cable: file handles opened over USB are closed."""
        self._comm.unplug_usb()

    def disconnect_bluetooth(self) -> None:
        """End the Bluetooth connection: file handles stay open."""
        self._comm.disconnect_bluetooth()
