"""The file in which the user interface keeps its settings; a brick that has none writes it when switched on.

Source: LEGO NXT firmware 1.29, Functions.inl cUiNVRead and cUiNVWrite, c_ui.h NVDATA.
"""

from __future__ import annotations

from typing import Final

from firmware_protocol import limits
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal

FILE_NAME: Final = "NVConfig.sys"

_SIZE: Final = 6
_CHECK_BYTE: Final = 0x78
_VOLUME_AT: Final = 2
_SLEEP_STEPS_MIN: Final = (0, 2, 5, 10, 30, 60)
_SLEEP_STEP: Final = 3


def restore_settings(loader: Loader, *, sleep_timeout_min: int) -> int:
    """Read the settings, or write the defaults; gives the volume.

    Args:
        loader: the files, as they were when the brick was switched off.
        sleep_timeout_min: what a new file says about sleeping, if it is one of the menu's steps.
    """
    data = _read(loader)
    if data[:1] == bytes((_CHECK_BYTE,)):
        return data[_VOLUME_AT]
    known = sleep_timeout_min in _SLEEP_STEPS_MIN
    step = _SLEEP_STEPS_MIN.index(sleep_timeout_min) if known else _SLEEP_STEP
    _write(loader, bytes((_CHECK_BYTE, 1, limits.VOLUME_MAX, step, 0, 0)))
    return limits.VOLUME_MAX


def _read(loader: Loader) -> bytes:
    try:
        handle, _ = loader.open_read(FILE_NAME)
    except LoaderRefusal:
        return b""
    data, _ = loader.read(handle, _SIZE)
    loader.close(handle)
    return data.ljust(_SIZE, b"\0")


def _write(loader: Loader, data: bytes) -> None:
    if loader.find(FILE_NAME) is not None:
        loader.delete(FILE_NAME)
    try:
        handle = loader.open_write(FILE_NAME, len(data))
    except LoaderRefusal:
        return
    loader.write(handle, data)
    loader.close(handle)
