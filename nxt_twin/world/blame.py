"""Errors about what a world file names, told with the place at which it names it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from nxt_twin.errors import NxtTwinError
from nxt_twin.mock.errors import WorldError
from nxt_twin.recording.yaml_place import YamlPlace


@contextmanager
def blaming(place: YamlPlace, *keys: str) -> Iterator[None]:
    """Add the file, the line and the key to an error about the value of that key.

    Raises:
        WorldError: in the place of any other failure.
    """
    try:
        yield
    except NxtTwinError as error:
        what = f"{error.where}: {error.what}" if error.where else error.what
        raise WorldError(what, where=place.of(keys), mend=error.mend) from None
