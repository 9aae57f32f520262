"""The flash memory: which sectors files take, and how much is free.

Source: LEGO NXT firmware 1.29, d_loader.c. Only the sectors' bookkeeping is modelled.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final, final

from firmware_protocol.limits import SECTOR_SIZE

HEADER_SIZE: Final = 36
"""Name, addresses, sizes and type at the start of a file's first sector."""
FIRST_SECTOR: Final = 0x22100 // SECTOR_SIZE
"""User flash begins behind the firmware."""
END_SECTOR: Final = 1024 - 2
"""The last two sectors hold the table of files."""
USER_SECTORS: Final = range(FIRST_SECTOR, END_SECTOR)


@final
@dataclass(eq=False)
class StoredFile:
    """A file in flash, complete or still being written.

    Attributes:
        name: as it was written.
        size: bytes that are set aside for it.
        linear: whether its sectors lie in one piece.
        appendable: whether it is a data file, which may be closed early.
        sectors: where it lies, the first one first.
        data: what has been written.
        told: how much of that the header tells; a data file's is brought up to date when it is closed.
    """

    name: str
    size: int
    linear: bool
    appendable: bool
    sectors: list[int]
    data: bytearray = field(default_factory=bytearray)
    told: int = 0


def sectors_needed(size: int) -> int:
    """Sectors that a file of `size` bytes takes, with its header and two bytes for each further sector."""
    whole = size + HEADER_SIZE
    bodies = (whole - 1) // SECTOR_SIZE
    whole += 2 * bodies
    more = (whole - 1) // SECTOR_SIZE - bodies
    whole += 2 * more
    return (whole - 1) // SECTOR_SIZE + 1


def free_bytes(free_sectors: int) -> int:
    """How many data bytes one file could hold that took all free sectors."""
    if free_sectors == 0:
        return 0
    entries = free_sectors - 1
    if (2 * entries + HEADER_SIZE) % SECTOR_SIZE < 4:
        entries -= 1
    header = HEADER_SIZE + 2 * entries
    header += -header % 4
    return max(0, free_sectors * SECTOR_SIZE - header)


@final
class SectorTable:
    """Which sectors of the user flash are taken."""

    def __init__(self) -> None:
        self._taken: set[int] = set()

    @property
    def free(self) -> int:
        """Number of free sectors."""
        return len(USER_SECTORS) - len(self._taken)

    def rebuild(self, files: Iterable[StoredFile]) -> None:
        """Take the sectors of these files, and no others."""
        self._taken = {sector for file in files for sector in file.sectors}

    def take(self, count: int, *, linear: bool) -> list[int] | None:
        """Take the first free sectors, in one piece if linear; None if there are not enough."""
        found: list[int] = []
        for sector in USER_SECTORS:
            if sector in self._taken:
                found = [] if linear else found
                continue
            found.append(sector)
            if len(found) == count:
                self._taken.update(found)
                return found
        return None
