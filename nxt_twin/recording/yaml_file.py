"""YAML files that people write: read safely, and refused with the line or key that is wrong."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.bounded_yaml import KeyTwiceError, parse_yaml
from nxt_twin.recording.source import nearest_name, quoted, read_head
from nxt_twin.recording.yaml_place import YamlPlace

LARGEST_YAML_BYTES = 2**20

ModelT = TypeVar("ModelT", bound=BaseModel)


def read_yaml(path: Path, error: type[NxtTwinError]) -> dict[str, Any]:
    """Read a YAML file of keys and values; an empty document has none.

    Raises:
        NxtTwinError: of class `error`, if the file cannot be read or its text is no YAML mapping.
    """
    advice = "check that it is the YAML file you mean"
    read_head(path, error, largest_bytes=LARGEST_YAML_BYTES, advice=advice)
    try:
        document = parse_yaml(path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError:
        raise error("is not UTF-8 text", where=str(path), mend="save it as UTF-8") from None
    except yaml.MarkedYAMLError as failure:
        mark = failure.problem_mark
        line = f", line {mark.line + 1}" if mark else ""
        what = f"is no valid YAML: {failure.problem}"
        twice = isinstance(failure, KeyTwiceError)
        mend = "keep one of them" if twice else "check indentation, colons and brackets"
        raise error(what, where=f"{path}{line}", mend=mend) from None
    except (yaml.YAMLError, ValueError) as failure:
        raise error(f"is no valid YAML: {failure}", where=str(path)) from None
    if document is None:
        return {}
    if not isinstance(document, dict):
        raise error("holds no keys", where=str(path), mend="write lines of the form `key: value`")
    return {str(key): value for key, value in document.items()}


def read_model(path: Path, model: type[ModelT], error: type[NxtTwinError]) -> ModelT:
    """Read a YAML file into `model`.

    Raises:
        NxtTwinError: of class `error`, as `read_yaml`, or naming the first key that the model refuses.
    """
    return read_part(read_yaml(path, error), model, error, where=YamlPlace(path))


def read_part(
    document: dict[str, Any], model: type[ModelT], error: type[NxtTwinError], *, where: YamlPlace | str
) -> ModelT:
    """Read what stands at some place of a file, or somewhere else (`where` in words), into `model`.

    Raises:
        NxtTwinError: of class `error`, naming the place and the first key that the model refuses.
    """
    try:
        return model.model_validate(document)
    except ValidationError as failure:
        # A misspelled key is named before the one that it leaves missing.
        first = min(failure.errors(), key=lambda problem: problem["type"] != "extra_forbidden")
        keys, model_there = _keys(first["loc"], model)
        what, mend = _complaint(dict(first), keys, model_there)
        raise error(what, where=_told(where, keys), mend=mend) from None


def _told(where: YamlPlace | str, keys: tuple[str, ...]) -> str:
    if isinstance(where, YamlPlace):
        return where.of(keys)
    return f"{where}, key {'.'.join(keys)}" if keys else where


def _keys(location: tuple[int | str, ...], model: type[BaseModel]) -> tuple[tuple[str, ...], type[BaseModel]]:
    """The keys down to the one complained of, as a person would write them, and the model that it is in.

    What pydantic puts between them to say which of several models it tried is no key, and is left out.
    """
    keys: list[str] = []
    there: tuple[type[BaseModel], ...] = (model,)
    inside: object = None
    for part in location:
        holder = next((each for each in there if str(part) in each.model_fields), None)
        if holder is not None:
            keys.append(str(part))
            model, inside = holder, holder.model_fields[str(part)].annotation
            there = tuple(_models_in(inside)) or there
        elif isinstance(part, int) or _is_named(inside):
            keys.append(str(part))
            inside = None
        elif part == location[-1] and len(there) == 1:  # a key that nobody knows
            keys.append(str(part))
            model = there[0]
    return tuple(keys), model


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    """The models that a value of this type may hold at any depth."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for option in typing.get_args(annotation):
        yield from _models_in(option)


def _is_named(annotation: object) -> bool:
    return any(typing.get_origin(each) is dict for each in (annotation, *typing.get_args(annotation)))


def _complaint(problem: dict[str, Any], keys: tuple[str, ...], model: type[BaseModel]) -> tuple[str, str]:
    """What is wrong, and what to do about it."""
    match problem["type"]:
        case "extra_forbidden":
            return "unknown key", f"nearest known: {nearest_name(keys[-1], model.model_fields)}"
        case "missing":
            return "is missing", "add it"
        case "literal_error":
            return f"{quoted(problem['input'])} is not known", f"write {problem['ctx']['expected']}"
        case "value_error":
            return str(problem["ctx"]["error"]), ""
        case _:
            return f"{problem['msg']}, not {quoted(problem['input'])}", ""
