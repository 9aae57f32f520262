"""The command interpreter for system commands; those for the device itself are here.

Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, final

import firmware_protocol as fp
from firmware_protocol import Command, OpcodeError, ReplyData, Status, TelegramType, limits
from firmware_protocol.commands.device import BOOT_MAGIC
from nxt_twin.mock.firmware.channel import Channel, Transport
from nxt_twin.mock.firmware.files import FileCommands
from nxt_twin.mock.firmware.flash import USER_SECTORS
from nxt_twin.mock.firmware.loader import Loader
from nxt_twin.mock.firmware.modules import ModuleCommands
from nxt_twin.mock.firmware.radio import RadioModule
from nxt_twin.mock.firmware.refusal import RefusedReply

ERASE_MS: Final = 4 * len(USER_SECTORS)
"""Erasing the user flash, 4 ms a sector, during which nothing else happens."""

Handler = Callable[[Any, Channel], ReplyData | None]


@final
class SystemCommands:
    """Executes system commands, but for WRITE, which can come in pieces.

    Attributes:
        stall_ms: for how long the brick does nothing more, but for its motors running on.
        booted: whether the brick was put into firmware download mode.
    """

    def __init__(self, loader: Loader, radio: RadioModule, modules: ModuleCommands) -> None:
        self.stall_ms = 0
        self.booted = False
        self._loader = loader
        self._radio = radio
        files = FileCommands(loader)
        self._handlers: dict[type[Command[Any]], Handler] = {
            fp.OpenRead: files.open_read,
            fp.OpenWrite: files.open_write,
            fp.ReadFile: files.read,
            fp.CloseFile: files.close,
            fp.DeleteFile: files.delete,
            fp.FindFirst: files.find_first,
            fp.FindNext: files.find_next,
            fp.GetVersions: self._versions,
            fp.OpenWriteLinear: files.open_write_linear,
            fp.OpenWriteData: files.open_write_data,
            fp.OpenAppendData: files.open_append,
            fp.CropDataFile: files.crop,
            fp.FindFirstModule: modules.find_first,
            fp.FindNextModule: modules.find_next,
            fp.CloseModule: modules.close,
            fp.IoMapRead: modules.read,
            fp.IoMapWrite: modules.write,
            fp.Boot: self._boot,
            fp.SetBrickName: self._set_name,
            fp.BluetoothGetAddress: self._address,
            fp.GetDeviceInfo: self._device_info,
            fp.DeleteUserFlash: self._delete_all,
            fp.PollLength: self._poll_length,
            fp.Poll: self._poll,
            fp.BluetoothFactoryReset: self._factory_reset,
        }

    def execute(self, channel: Channel, length: int) -> bytes:
        """Execute the telegram in the channel's buffer and give its reply.

        An unknown opcode is answered with as many stale bytes as the telegram has, in place of a status.
        """
        buffer = bytes(channel.buffer)
        try:
            request, _ = fp.decode_request_from_buffer(buffer, length)
        except OpcodeError:
            stale = bytes(channel.stale[2 : 2 + length]).ljust(length, b"\0")
            return bytes((TelegramType.REPLY, buffer[1])) + stale
        try:
            data = self._handlers[type(request)](request, channel)
            return fp.encode_reply(type(request), data)
        except RefusedReply as refusal:
            return fp.encode_reply(type(request), refusal.data, status=refusal.status)

    def _versions(self, request: fp.GetVersions, channel: Channel) -> ReplyData:
        del request, channel
        protocol_major, protocol_minor = limits.PROTOCOL_VERSION
        firmware_major, firmware_minor = limits.FIRMWARE_VERSION
        return fp.GetVersions.Reply(protocol_minor, protocol_major, firmware_minor, firmware_major)

    def _boot(self, request: fp.Boot, channel: Channel) -> ReplyData:
        if channel.transport is not Transport.USB or request.magic[:-1] != BOOT_MAGIC[:-1]:
            raise RefusedReply(Status.UNDEFINED_ERROR, fp.blank_reply(fp.Boot))
        self.booted = True
        return fp.Boot.Reply()

    def _set_name(self, request: fp.SetBrickName, channel: Channel) -> None:
        del channel
        if not self._radio.rename(request.name):
            raise RefusedReply(Status.BLUETOOTH_BUSY)

    def _address(self, request: fp.BluetoothGetAddress, channel: Channel) -> ReplyData:
        del request, channel
        return fp.BluetoothGetAddress.Reply(self._radio.address)

    def _device_info(self, request: fp.GetDeviceInfo, channel: Channel) -> ReplyData:
        del request, channel
        radio = self._radio
        free = self._loader.free_flash
        return fp.GetDeviceInfo.Reply(radio.brick_name, radio.address, radio.link_quality, free)

    def _delete_all(self, request: fp.DeleteUserFlash, channel: Channel) -> None:
        del request, channel
        self._loader.delete_all()
        self.stall_ms = ERASE_MS

    def _poll_length(self, request: fp.PollLength, channel: Channel) -> ReplyData:
        del channel
        return fp.PollLength.Reply(request.buffer, 0)

    def _poll(self, request: fp.Poll, channel: Channel) -> ReplyData:
        if request.length > channel.sizes.poll:
            raise RefusedReply(Status.UNDEFINED_ERROR, fp.Poll.Reply(request.buffer, 0, b""))
        return fp.Poll.Reply(request.buffer, 0, bytes(request.length))

    def _factory_reset(self, request: fp.BluetoothFactoryReset, channel: Channel) -> None:
        del request
        if channel.transport is not Transport.USB or not self._radio.factory_reset():
            raise RefusedReply(Status.UNDEFINED_ERROR)
