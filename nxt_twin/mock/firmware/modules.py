"""System commands for firmware modules: searching them, and their IO maps.

Source: LEGO NXT firmware 1.29, c_loader.c cLoaderFileRq and c_comm.c cCommInterpreteCmd.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import firmware_protocol as fp
from firmware_protocol import ReplyData, Status
from nxt_twin.mock.firmware.channel import Channel
from nxt_twin.mock.firmware.module import Module, overlay
from nxt_twin.mock.firmware.refusal import RefusedReply


@final
class ModuleCommands:
    """Executes module commands; one search at a time, taken until it is closed.

    Only its start asks whether a search is on: FIND_NEXT_MODULE without one goes on where the last one stopped,
    and lists all modules if there was none.

    Args:
        modules: in the order in which a search lists them.
    """

    def __init__(self, modules: Sequence[Module]) -> None:
        self._modules = modules
        self._by_id = {int(module.module_id): module for module in modules}
        self._searching = False
        self._pattern: str | None = None
        self._next = 0

    def find_first(self, request: fp.FindFirstModule, channel: Channel) -> ReplyData:
        """FIND_FIRST_MODULE."""
        del channel
        if self._searching:
            raise RefusedReply(Status.NO_MORE_HANDLES, fp.blank_reply(fp.FindFirstModule))
        self._searching = True
        self._pattern = request.pattern
        self._next = 0
        return self._find()

    def find_next(self, request: fp.FindNextModule, channel: Channel) -> ReplyData:
        """FIND_NEXT_MODULE."""
        del request, channel
        return self._find()

    def close(self, request: fp.CloseModule, channel: Channel) -> ReplyData:
        """CLOSE_MODULE."""
        del request, channel
        self._searching = False
        return fp.CloseModule.Reply(0)

    def read(self, request: fp.IoMapRead, channel: Channel) -> ReplyData:
        """IOMAP_READ: what does not fit the reply is cut off."""
        length = min(request.length, channel.sizes.io_map)
        end = request.offset + length
        try:
            memory = self._memory(request.module_id, end).export()
        except RefusedReply as refusal:
            reply = fp.IoMapRead.Reply(request.module_id, 0, bytes(length))
            raise RefusedReply(refusal.status, reply) from None
        return fp.IoMapRead.Reply(request.module_id, length, memory[request.offset : end])

    def write(self, request: fp.IoMapWrite, channel: Channel) -> ReplyData:
        """IOMAP_WRITE."""
        del channel
        try:
            module = self._memory(request.module_id, request.offset + request.length)
        except RefusedReply as refusal:
            raise RefusedReply(refusal.status, fp.IoMapWrite.Reply(request.module_id, 0)) from None
        module.adopt(overlay(module.export(), request.offset, request.data))
        return fp.IoMapWrite.Reply(request.module_id, request.length)

    def _find(self) -> ReplyData:
        for index in range(self._next, len(self._modules)):
            module = self._modules[index]
            if self._pattern is None or fp.pattern_matches(self._pattern, module.name):
                self._next = index + 1
                return fp.ModuleFound(0, module.name, module.module_id, 0, len(module.export()))
        raise RefusedReply(Status.MODULE_NOT_FOUND, fp.blank_reply(fp.FindFirstModule))

    def _memory(self, module_id: int, end: int) -> Module:
        module = self._by_id.get(int(module_id))
        if module is None:
            raise RefusedReply(Status.MODULE_NOT_FOUND)
        if end > len(module.export()):
            raise RefusedReply(Status.OUT_OF_BOUNDS)
        return module
