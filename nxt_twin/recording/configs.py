"""The configurations that come with the tool, and those a user writes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nxt_twin.errors import PlantError
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.yaml_file import read_yaml

_PACKAGE = Path(__file__).parents[1]
_YAML_SUFFIXES = (".yaml", ".yml")
_FOLDERS = ("plants", "sensors")


def configs_dir() -> Path:
    """The folder of configurations: inside an installed package, beside it in a source checkout."""
    installed = _PACKAGE / "configs"
    return installed if installed.is_dir() else _PACKAGE.parent / "configs"


def load_plant_config(name_or_path: str | Path) -> dict[str, Any]:
    """Read a plant configuration as it stands in its file, unchecked.

    Args:
        name_or_path: a path, or the name of one of the tool's own plants such as `nxt_motor`, or of its
            sensors such as `nxt_ultrasonic`. A file may hold the plant's keys at the top or under `plant:`.

    Raises:
        PlantError: if there is no such plant or its file is no YAML.
    """
    path = Path(name_or_path)
    if path.suffix.lower() not in _YAML_SUFFIXES:
        files = [file for folder in _FOLDERS for file in sorted((configs_dir() / folder).glob("*.yaml"))]
        known = {file.stem: file for file in files}
        if str(name_or_path) not in known:
            mend = f"nearest known: {nearest_name(str(name_or_path), known)}; or name a .yaml file"
            raise PlantError(f"there is no plant named {quoted(str(name_or_path))}", mend=mend)
        path = known[str(name_or_path)]
    config = read_yaml(path, PlantError)
    inner = config.get("plant")
    return inner if isinstance(inner, dict) else config
