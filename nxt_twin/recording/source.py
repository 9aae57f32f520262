"""What may be opened as a file at all: an ordinary, readable, non-empty file of bounded size."""

from __future__ import annotations

import difflib
import reprlib
import stat
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

from nxt_twin.errors import NxtTwinError

LARGEST_TABLE_BYTES = 512 * 2**20
_HEAD_BYTES = 64 * 1024
_MIB = 2**20
_QUOTED_CHARACTERS = 60
_NAME_CHARACTERS = 100
_NAMES_MOST = 1000
_BRIEF = reprlib.Repr()
_BRIEF.maxstring = _BRIEF.maxother = _BRIEF.maxlong = 4 * _QUOTED_CHARACTERS


def read_head(path: Path, error: type[NxtTwinError], *, largest_bytes: int, advice: str) -> bytes:
    """Read the first 64 KiB of `path`, after refusing what nobody should try to read whole.

    Args:
        path: the file.
        error: the class to raise.
        largest_bytes: the size above which the file is refused unread.
        advice: what to do about a file that is too large.

    Raises:
        NxtTwinError: of class `error`, if `path` is missing, a folder, no ordinary file, empty, too large or
            unreadable.
    """
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise error("is a folder where a file is expected", where=str(path), mend="name a file in it")
        if not stat.S_ISREG(status.st_mode):
            raise error("is no ordinary file", where=str(path), mend="save its contents to a file first")
        if status.st_size > largest_bytes:
            size = f"{status.st_size / _MIB:.0f} MiB, over the limit of {largest_bytes / _MIB:.0f} MiB"
            raise error(f"has {size}", where=str(path), mend=advice)
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES)
    except FileNotFoundError:
        raise error("there is no such file", where=str(path), mend="check the name and the folder") from None
    except OSError as failure:
        raise error(f"cannot be read: {failure.strerror}", where=str(path)) from None
    except ValueError:
        raise error("is no file name", where=quoted(str(path)), mend="check the name") from None
    if not head:
        raise error("is empty", where=str(path), mend="check that whatever wrote it has finished")
    return head


def read_table_head(path: Path, error: type[NxtTwinError]) -> bytes:
    """Read the first 64 KiB of a table's file; refuses as `read_head` does, above 512 MiB."""
    advice = "split it into shorter recordings"
    return read_head(path, error, largest_bytes=LARGEST_TABLE_BYTES, advice=advice)


def quoted(found: object) -> str:
    """A value as an error message shows it: on one line, and shortened."""
    text = repr(found[: 2 * _QUOTED_CHARACTERS]) if isinstance(found, str) else _BRIEF.repr(found)
    return text if len(text) <= _QUOTED_CHARACTERS else f"{text[:_QUOTED_CHARACTERS]}…"


def nearest_name(name: str, known: Iterable[str]) -> str:
    """The known name that is spelled most like `name`; empty if none is known."""
    spelled = {each[:_NAME_CHARACTERS]: each for each in islice(known, _NAMES_MOST)}
    matches = difflib.get_close_matches(name[:_NAME_CHARACTERS], list(spelled), n=1, cutoff=0.0)
    return spelled[matches[0]] if matches else ""
