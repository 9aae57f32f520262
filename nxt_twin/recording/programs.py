"""The motor programs that come with the tool, and those a user writes, by name or path."""

from __future__ import annotations

from pathlib import Path

from nxt_twin.errors import ProgramError
from nxt_twin.recording.configs import configs_dir
from nxt_twin.recording.program import MotorProgram, read_program
from nxt_twin.recording.source import nearest_name, quoted

_YAML_SUFFIXES = (".yaml", ".yml")


def own_programs() -> dict[str, Path]:
    """The tool's own programs by name."""
    return {file.stem: file for file in sorted((configs_dir() / "programs").glob("*.yaml"))}


def load_program(name_or_path: str) -> MotorProgram:
    """Read a motor program.

    Args:
        name_or_path: the path of a YAML file, or the name of one of the tool's own.

    Raises:
        ProgramError: there is none of that name, or the file is none.
    """
    path = Path(name_or_path)
    if path.suffix.lower() in _YAML_SUFFIXES:
        return read_program(path)
    known = own_programs()
    if name_or_path not in known:
        mend = f"nearest known: {nearest_name(name_or_path, known)}; known: {', '.join(known)}; or name a .yaml file"
        raise ProgramError(f"there is no program named {quoted(name_or_path)}", mend=mend)
    return read_program(known[name_or_path])
