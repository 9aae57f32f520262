"""The command module: the program that runs, its mailboxes and its datalog. Programs are not interpreted.

Source: LEGO NXT firmware 1.29, c_cmd.c.
"""

from __future__ import annotations

from collections import deque
from typing import Final, final

from firmware_protocol import CommandMap, ModuleId, Status, decode_io_map, encode_io_map
from firmware_protocol.layout import fixed_size_of
from nxt_twin.mock.firmware.input import InputModule
from nxt_twin.mock.firmware.loader import Loader
from nxt_twin.mock.firmware.mailboxes import Mailboxes
from nxt_twin.mock.firmware.module import Module, overlay
from nxt_twin.mock.firmware.output import OutputModule

FORMAT_STRING: Final = b"MindstormsNXT\0"
"""What a program file starts with."""
IO_MAP_SIZE: Final = 32828
"""Head, 32 KiB of memory pool, and the clock behind it."""

_IDLE, _OK, _RUNNING, _ERROR = range(4)


@final
class ProgramModule(Module):
    """Runs a program, in that it is running until it is stopped."""

    module_id = ModuleId.COMMAND
    name = "Command.mod"

    def __init__(self, loader: Loader, outputs: OutputModule, inputs: InputModule) -> None:
        self.running: str | None = None
        self.mailboxes = Mailboxes()
        self.datalog: deque[bytes] = deque()
        self.sync_time = 0
        self._status = _IDLE
        self._tick_ms = 0
        self._stop_wanted = False
        self._start_wanted = ""
        self._loader = loader
        self._outputs = outputs
        self._inputs = inputs
        self._memory = overlay(bytes(IO_MAP_SIZE), 0, FORMAT_STRING)

    def start(self, name: str) -> None:
        """Start a program in the module's next pass; a running one ends first."""
        self._start_wanted = name

    def stop(self) -> None:
        """Stop the program in the module's next pass."""
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
        if self._stop_wanted:
            self._stop_wanted = False
            self._end()
        if self._start_wanted:
            name, self._start_wanted = self._start_wanted, ""
            self._end()
            self._begin(name)

    def _begin(self, name: str) -> None:
        file = self._loader.find(name)
        if file is None or not file.linear or not file.data.startswith(FORMAT_STRING):
            self._status = _ERROR
            return
        self._reset_devices()
        self.mailboxes.clear()
        self.datalog.clear()
        self.running = file.name
        self._status = _RUNNING

    def _end(self) -> None:
        if self.running is None:
            return
        self.running = None
        self._status = _OK
        self._reset_devices()

    def _reset_devices(self) -> None:
        self._outputs.reset()
        self._inputs.reset()

    def export(self) -> bytes:
        """The IO map."""
        head = CommandMap(
            format_string=FORMAT_STRING.ljust(16, b"\0"),
            handler_pointer=0,
            tick_ms=self._tick_ms & 0xFFFFFFFF,
            data_space_offset=0xFFFF,
            dope_vector_offset=0xFFFF,
            program_status=self._status,
            awake=True,
            activate_flag=0,
            deactivate_flag=0,
            file_name=self.running or "",
        )
        return overlay(self._memory, 0, encode_io_map(head))

    def adopt(self, data: bytes) -> None:
        """Take over the memory pool, and a wish to stop; the rest of the head is the module's own."""
        size = fixed_size_of(CommandMap) or 0
        head = decode_io_map(CommandMap, data[:size])
        self._memory = data
        if head.deactivate_flag:
            self._stop_wanted = self.running is not None
