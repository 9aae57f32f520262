"""The command module: the program that runs, its mailboxes and its datalog. Programs are not interpreted.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdCtrl, cCmdActivateProgram and cCmdResetDevices.
"""

from __future__ import annotations

from collections import deque
from enum import Enum, IntEnum
from typing import Final, final

from firmware_protocol import CommandMap, ModuleId, Status, decode_io_map, encode_io_map, limits
from firmware_protocol.layout import fixed_size_of
from nxt_twin.mock.firmware.input import InputModule
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
from nxt_twin.mock.firmware.lowspeed import LowSpeedModule
from nxt_twin.mock.firmware.mailboxes import Mailboxes
from nxt_twin.mock.firmware.module import Module, overlay
from nxt_twin.mock.firmware.output import OutputModule
from nxt_twin.mock.firmware.sound import SoundModule
from nxt_twin.mock.firmware.ui import UiModule

FORMAT_STRING: Final = b"MindstormsNXT\0"
"""What a program file starts with."""


_POOL_SIZE: Final = 32_768
_BLANK: Final = 0xDEADBEEF.to_bytes(4, "little")
"""What the memory pool is filled with before a program uses it."""


class ProgramStatus(IntEnum):
    """How the last program does, or did, as the IO map says."""

    IDLE = 0
    OK = 1
    RUNNING = 2
    ERROR = 3
    ABORT = 4
    RESET = 5
    """The user interface has shown the end long enough."""


class _State(Enum):
    IDLE = "idle"
    RUNNING = "running"
    ENDING = "ending"
    SHOWN = "its end is shown"


@final
class ProgramModule(Module):
    """Runs a program, in that it is running until it is stopped.

    Attributes:
        running: the name of the program, from the pass that opens its file to the one that closes it.
        status: what the IO map says about it; the user interface sets RESET.
    """

    module_id = ModuleId.COMMAND
    name = "Command.mod"

    def __init__(
        self,
        loader: Loader,
        outputs: OutputModule,
        inputs: InputModule,
        low_speed: LowSpeedModule,
        sound: SoundModule,
        ui: UiModule,
    ) -> None:
        self.running: str | None = None
        self.status = ProgramStatus.IDLE
        self.mailboxes = Mailboxes()
        self.datalog: deque[bytes] = deque()
        self.sync_time = 0
        self._state = _State.IDLE
        self._tick_ms = 0
        self._file_name = ""
        self._start_wanted = False
        self._stop_wanted = False
        self._handle = 0
        self._loader = loader
        self._devices = (outputs, inputs, low_speed)
        self._sound = sound
        self._ui = ui
        self._memory = bytes(limits.IO_MAP_SIZES[ModuleId.COMMAND])
        self._clear_pool()

    def start(self, name: str) -> None:
        """Start a program in the module's next pass, if none runs then."""
        self._file_name = name
        self._start_wanted = True

    def stop(self) -> None:
        """Stop the program: it counts as aborted after the module's next pass, and is gone after the one behind."""
        self._stop_wanted = True

    def store(self, mailbox: int, message: bytes) -> Status:
        """Put a message into a mailbox; there are none without a program."""
        if self.running is None:
            return Status.NO_ACTIVE_PROGRAM
        self.mailboxes.put(mailbox, message)
        return Status.OK

    def tick(self) -> None:
        """One pass."""
        self._tick_ms += 1
        match self._state:
            case _State.RUNNING if self._stop_wanted:
                self._stop_wanted = False
                self.status = ProgramStatus.ABORT
                self._state = _State.ENDING
            case _State.IDLE if self._start_wanted:
                self._start_wanted = False
                self._begin()
            case _State.ENDING:
                self._end()
            case _State.SHOWN if self.status is ProgramStatus.RESET:
                self._reset_devices()
                self.status = ProgramStatus.IDLE
                self._state = _State.IDLE
            case _:
                pass

    def _begin(self) -> None:
        if not self._activate():
            self.status = ProgramStatus.ERROR
            self._state = _State.ENDING
            return
        self.status = ProgramStatus.RUNNING
        self._state = _State.RUNNING
        self._reset_devices()
        self._ui.lock_buttons(locked=True)

    def _activate(self) -> bool:
        """Open the program's file; an empty one keeps its handle for ever, any other until its end."""
        try:
            handle, file = self._loader.open_linear(self._file_name)
        except LoaderRefusal:
            return False
        if not file.data:
            return False
        self._clear_pool()
        self._handle = handle
        self.running = self._file_name
        self.mailboxes.clear()
        self.datalog.clear()
        return file.data.startswith(FORMAT_STRING)

    def _clear_pool(self) -> None:
        at = fixed_size_of(CommandMap) or 0
        self._memory = overlay(self._memory, at, _BLANK * (_POOL_SIZE // len(_BLANK)))

    def _end(self) -> None:
        if self.status is ProgramStatus.ABORT:
            self._reset_devices()
        self._ui.lock_buttons(locked=False)
        if self.running is not None:
            self._loader.close(self._handle)
            self.running = None
        self._sound.stop()
        self._sound.volume = self._ui.volume
        self._state = _State.SHOWN

    def _reset_devices(self) -> None:
        for device in self._devices:
            device.reset()

    def export(self) -> bytes:
        """The IO map."""
        head = CommandMap(
            format_string=FORMAT_STRING.ljust(16, b"\0"),
            handler_pointer=0,
            tick_ms=self._tick_ms & 0xFFFFFFFF,
            data_space_offset=0xFFFF,
            dope_vector_offset=0xFFFF,
            program_status=self.status,
            awake=True,
            activate_flag=self._start_wanted,
            deactivate_flag=self._stop_wanted,
            file_name=self._file_name,
        )
        return overlay(self._memory, 0, encode_io_map(head))

    def adopt(self, data: bytes) -> None:
        """Take over the memory pool, and wishes to start and stop; the rest of the head is the module's own."""
        size = fixed_size_of(CommandMap) or 0
        head = decode_io_map(CommandMap, data[:size])
        self._memory = data
        self._file_name = head.file_name
        self._start_wanted = bool(head.activate_flag)
        self._stop_wanted = bool(head.deactivate_flag)
