"""What every firmware module has: a name, and a memory that other modules and the host read and write."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import final

from firmware_protocol import ModuleId


class Module(ABC):
    """Abstract: a firmware module with its IO map.

    Attributes:
        module_id: its number.
        name: the name under which a host finds it, with the ending ``.mod``.
    """

    module_id: ModuleId
    name: str

    @abstractmethod
    def export(self) -> bytes:
        """The IO map's bytes as they stand."""

    @abstractmethod
    def adopt(self, data: bytes) -> None:
        """Take over an IO map that the host has changed somewhere."""


@final
class MemoryModule(Module):
    """A module of which only the memory is there: what a host writes, it reads back."""

    def __init__(self, module_id: ModuleId, name: str, size: int) -> None:
        self.module_id = module_id
        self.name = name
        self._memory = bytes(size)

    def export(self) -> bytes:
        """The memory."""
        return self._memory

    def adopt(self, data: bytes) -> None:
        """Keep the memory."""
        self._memory = data


def overlay(memory: bytes, offset: int, data: bytes) -> bytes:
    """The memory with some bytes replaced."""
    return memory[:offset] + data + memory[offset + len(data) :]
