"""The file `fleet.yaml` beside a fleet's folders: settings for all of them."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any, Final, final

import yaml
from pydantic import BaseModel, ConfigDict

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.finding.labels import USUAL_LEVELS, Level
from nxt_twin.fleet.finding.store import Store
from nxt_twin.recording.bounded_yaml import parse_yaml
from nxt_twin.recording.yaml_file import LARGEST_YAML_BYTES, read_part

FLEET_FILE: Final = "fleet.yaml"


@final
class FleetFile(BaseModel):
    """The keys of `fleet.yaml`.

    Attributes:
        folders: what the folders stand for, the outermost first.
        plant: the baseline of recordings that name none: its keys, a name, or a file beside.
        port: the port whose motor is in question.
        mapping: of tables from elsewhere: its keys, or a file beside.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    folders: list[Level] = list(USUAL_LEVELS)
    plant: str | dict[str, Any] | None = None
    port: str | None = None
    mapping: str | dict[str, Any] | None = None

    def case_keys(self) -> dict[str, Any]:
        """The keys that a case of such a fleet takes over."""
        return self.model_dump(exclude_none=True, exclude={"folders"})


def read_fleet_file(store: Store, base: str) -> FleetFile:
    """The fleet's file, with the files that it names read in; the usual where there is none.

    Raises:
        FleetError: it is wrong, or names a file that is.
    """
    path = f"{base.rstrip('/')}/{FLEET_FILE}"
    if not store.is_file(path):
        return FleetFile()
    file = read_part(_keys(store, path), FleetFile, FleetError, where=store.name(path))
    named = {
        key: _keys(store, str(PurePosixPath(base) / value))
        for key, value in file.case_keys().items()
        if key in ("plant", "mapping") and isinstance(value, str) and value.endswith((".yaml", ".yml"))
    }
    return file.model_copy(update=named)


def _keys(store: Store, path: str) -> dict[str, Any]:
    where = store.name(path)
    try:
        content = store.read(path)
        if len(content) > LARGEST_YAML_BYTES:
            raise FleetError("is larger than any YAML file of ours", where=where, mend="name another file")
        document = parse_yaml(content.decode("utf-8-sig"))
    except OSError as error:
        raise FleetError(
            f"cannot be read: {error.strerror or error}", where=where, mend="check the file"
        ) from None
    except (yaml.YAMLError, ValueError) as error:
        raise FleetError(
            f"is no valid YAML: {error}", where=where, mend="check indentation and colons"
        ) from None
    if not isinstance(document, dict):
        raise FleetError("holds no keys", where=where, mend="write lines of the form `key: value`")
    return {str(key): value for key, value in document.items()}
