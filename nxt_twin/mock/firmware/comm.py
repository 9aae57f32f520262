"""The comm module's pass: takes at most one telegram of each transport and has it executed.

Source: LEGO NXT firmware 1.29, c_comm.c cCommCtrl and cCommInterprete.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import ReadFile, Status, TelegramType, WriteFile, encode_reply
from nxt_twin.mock.firmware.channel import Channel, ExtendedWrite, Piece, Transport
from nxt_twin.mock.firmware.direct import DirectCommands
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
from nxt_twin.mock.firmware.long_read import LongRead
from nxt_twin.mock.firmware.radio import RadioModule
from nxt_twin.mock.firmware.system import SystemCommands

_NO_REPLY: Final = 0x80
_HEADER_SIZE: Final = 2
_WRITE_OVERHEAD: Final = 3
_READ_LENGTH: Final = slice(3, 5)


@final
class Comm:
    """Telegrams in, replies out.

    Args:
        loader: the files, for long WRITE telegrams.
        radio: Bluetooth; telegrams that arrive while it is out of stream mode are lost if `lossy`.
        direct: executes direct commands.
        system: executes system commands.
        lossy: whether renaming the brick over Bluetooth loses telegrams.
    """

    def __init__(
        self,
        loader: Loader,
        radio: RadioModule,
        direct: DirectCommands,
        system: SystemCommands,
        *,
        lossy: bool,
    ) -> None:
        self.channels = {transport: Channel(transport) for transport in Transport}
        self._bluetooth = self.channels[Transport.BLUETOOTH]
        self._usb = self.channels[Transport.USB]
        self._loader = loader
        self._radio = radio
        self._direct = direct
        self._system = system
        self._lossy = lossy
        self._long_read = LongRead(loader, self._bluetooth, radio)

    def tick(self) -> None:
        """One pass."""
        piece = self._bluetooth.take()
        if piece is not None:
            if not (self._lossy and self._radio.away):
                self._execute(self._bluetooth, piece)
            # The firmware clears the place where the radio's own commands stand, in every pass.
            self._bluetooth.buffer[1] = 0
        self._long_read.tick()
        piece = self._usb.take()
        if piece is not None:
            self._execute(self._usb, piece)

    def _execute(self, channel: Channel, piece: Piece) -> None:
        channel.buffer[: len(piece.data)] = piece.data
        if channel.extended is not None:
            self._go_on_writing(channel, channel.extended, piece)
            return
        kind = channel.buffer[0] & ~_NO_REPLY
        reply_wanted = not channel.buffer[0] & _NO_REPLY
        reply: bytes | None = None
        if kind == TelegramType.DIRECT:
            reply = self._direct.execute(channel, len(piece.data), reply_wanted=reply_wanted)
        elif kind == TelegramType.SYSTEM:
            if channel.buffer[1] == WriteFile.OPCODE:
                reply = self._write(channel, piece, reply_wanted=reply_wanted)
            elif self._is_long_read(channel):
                self._long_read.start(channel.buffer[_HEADER_SIZE], _read_length(channel))
            else:
                reply = self._system.execute(channel, len(piece.data))
            if reply is not None:
                channel.keep(reply)
        elif kind == TelegramType.REPLY:
            self._direct.take_reply(bytes(channel.buffer), len(piece.data))
        if reply is not None and reply_wanted:
            channel.reply(reply)

    def _is_long_read(self, channel: Channel) -> bool:
        over_bluetooth = channel is self._bluetooth and channel.buffer[1] == ReadFile.OPCODE
        return over_bluetooth and _read_length(channel) > channel.sizes.read

    def _write(self, channel: Channel, piece: Piece, *, reply_wanted: bool) -> bytes | None:
        """WRITE, or its first piece; the firmware takes a rest of the same length for a whole telegram."""
        handle = channel.buffer[_HEADER_SIZE]
        length = (len(piece.data) - _WRITE_OVERHEAD) & 0xFFFF
        data = bytes(channel.buffer[_WRITE_OVERHEAD : _WRITE_OVERHEAD + length]).ljust(length, b"\0")
        written, status = self._write_data(handle, data)
        if piece.remaining and piece.remaining != len(piece.data):
            channel.extended = ExtendedWrite(handle, written, reply_wanted=reply_wanted)
            return None
        return encode_reply(WriteFile, WriteFile.Reply(handle, written), status=status)

    def _go_on_writing(self, channel: Channel, extended: ExtendedWrite, piece: Piece) -> None:
        written, status = self._write_data(extended.handle, piece.data)
        extended.written = (extended.written + written) & 0xFFFF
        if piece.remaining:
            return
        channel.extended = None
        if extended.reply_wanted:
            whole = WriteFile.Reply(extended.handle, extended.written)
            channel.reply(encode_reply(WriteFile, whole, status=status))

    def _write_data(self, handle: int, data: bytes) -> tuple[int, Status]:
        try:
            return self._loader.write(handle, data)
        except LoaderRefusal as refusal:
            return 0, refusal.status

    def unplug_usb(self) -> None:
        """The cable is pulled: file handles that were opened over it are closed."""
        self._usb.hang_up()
        for handle in sorted(self._usb.handles):
            self._loader.close(handle)
        self._usb.handles.clear()

    def disconnect_bluetooth(self) -> None:
        """The Bluetooth connection ends: file handles stay open."""
        self._bluetooth.hang_up()
        self._long_read.cancel()


def _read_length(channel: Channel) -> int:
    return int.from_bytes(channel.buffer[_READ_LENGTH], "little")
