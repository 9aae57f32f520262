"""Names of files on the brick: which are legal, which are equal, and which a search pattern finds.

Source: LEGO NXT firmware 1.29, d_loader.c (dLoaderInsertSearchStr, dLoaderCheckName).
"""

from __future__ import annotations

from typing import Final

from firmware_protocol.errors import IllegalFileNameError
from firmware_protocol.status import Status

NAME_FIELD_SIZE: Final = 20
NAME_LENGTH_MAX: Final = NAME_FIELD_SIZE - 1
_LINEAR_EXTENSIONS: Final = (".rxe", ".sys", ".rtm")
_EXTENSION_KEY_LENGTH: Final = 4


def check_file_name(name: str) -> str:
    """The name itself, if the brick can store a file under it.

    The brick also refuses a name that is too long with this error. An empty name, and one with characters
    that cannot be sent, is refused here.

    Raises:
        IllegalFileNameError: the name is empty, longer than 19 characters, or not Latin-1 without NUL.
    """
    if not name:
        raise _illegal("the name is empty")
    if len(name) > NAME_LENGTH_MAX:
        raise _illegal(f"{name!r} has {len(name)} characters, at most {NAME_LENGTH_MAX} fit")
    if any(letter == "\0" or ord(letter) > 0xFF for letter in name):
        raise _illegal(f"{name!r} has characters that cannot be sent")
    return name


def fold_case(name: str) -> str:
    """The name as the brick compares it: A to Z are a to z, other letters keep their case."""
    return "".join(letter.lower() if letter.isascii() else letter for letter in name)


def is_linear_name(name: str) -> bool:
    """Whether OPEN_WRITE makes the file linear: ``.rxe``, ``.sys`` or ``.rtm`` past the first letter."""
    return any(extension in fold_case(name)[1:] for extension in _LINEAR_EXTENSIONS)


def pattern_matches(pattern: str, name: str) -> bool:
    """Whether a search for the pattern finds the name.

    A pattern that holds ``*.*`` finds all; ``name.*`` finds what starts with ``name.``; ``*.ext`` what has
    ``.ext`` (four characters) anywhere; a pattern without ``*`` the name itself; any other nothing.
    """
    wanted, have = fold_case(pattern), fold_case(name)
    if "*.*" in wanted:
        return True
    if wanted.endswith(".*"):
        prefix = wanted[:-1]
        return "*" not in prefix and have.startswith(prefix)
    if wanted.startswith("*."):
        extension = wanted[1 : 1 + _EXTENSION_KEY_LENGTH]
        return "*" not in extension and extension in have
    return "*" not in wanted and have == wanted


def _illegal(detail: str) -> IllegalFileNameError:
    return IllegalFileNameError(Status.ILLEGAL_FILE_NAME, detail=detail)
