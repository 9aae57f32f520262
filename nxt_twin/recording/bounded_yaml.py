"""YAML that others wrote: parsed safely, and refused where it would unfold to more than a person could mean."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final, cast, final

import yaml

from nxt_twin.recording.source import quoted

DEEPEST: Final = 64
UNFOLDED_MOST: Final = 100_000
"""The number of values that a text may hold that writes some of them once and means them often (aliases)."""
_LARGEST_INTEGER: Final = 2**63
_LONGEST_NUMBER: Final = 400
_NUMBER: Final = re.compile(r"[-+.]?[0-9]")
# libyaml's parser where PyYAML was built with it: ten times as fast.
LOADER: Final[type[yaml.SafeLoader]] = cast(
    "type[yaml.SafeLoader]", getattr(yaml, "CSafeLoader", yaml.SafeLoader)
)


@final
class KeyTwiceError(yaml.MarkedYAMLError):
    """A mapping has a key twice; `problem_mark` is where it stands again."""


def parse_yaml(text: str) -> object:
    """The content of a YAML document, in plain Python values.

    Raises:
        KeyTwiceError: a mapping has a key twice, of which YAML's readers would keep the last without a word.
        yaml.YAMLError: it is none, or has an unsafe tag.
        ValueError: it is nested too deeply, unfolds to too much, refers to itself, or holds a number that is too large.
    """
    _Extent().check(text)
    loader = LOADER(text)
    try:
        node = loader.get_single_node()
        _check_keys(node)
        document = None if node is None else loader.construct_document(node)
    except (AttributeError, LookupError, TypeError, ArithmeticError):  # PyYAML takes a tag's word for it
        raise ValueError("a value is not what its tag says") from None
    finally:
        loader.dispose()
    for value in _values(document):
        if isinstance(value, int) and abs(value) >= _LARGEST_INTEGER:
            raise ValueError(
                f"a whole number is beyond {_LARGEST_INTEGER:.2g}; write it with a point or an exponent"
            )
    return document


@final
class _Extent:
    """How deep a document is, and to how many values it unfolds."""

    def __init__(self) -> None:
        self._anchored: dict[str, int] = {}
        self._open: list[tuple[str | None, int]] = [(None, 0)]
        self._aliased = False

    def check(self, text: str) -> None:
        """Go through a document's events, without building anything of it."""
        for event in yaml.parse(text, Loader=LOADER):
            match event:
                case yaml.CollectionStartEvent():
                    self._begin(event.anchor)
                case yaml.CollectionEndEvent():
                    self._add(*self._open.pop())
                case yaml.ScalarEvent():
                    _check_scalar(event)
                    self._add(event.anchor, 1)
                case yaml.AliasEvent():
                    self._aliased = True
                    self._add(None, self._meant(event.anchor))

    def _begin(self, anchor: str | None) -> None:
        if len(self._open) > DEEPEST:
            raise ValueError(f"it is nested more than {DEEPEST} deep")
        self._open.append((anchor, 1))

    def _meant(self, anchor: str | None) -> int:
        if anchor in (each for each, _ in self._open):
            raise ValueError("a part of it refers to itself")
        return self._anchored.get(anchor or "", 1)

    def _add(self, anchor: str | None, size: int) -> None:
        if anchor is not None:
            self._anchored[anchor] = size
        outer, before = self._open.pop()
        self._open.append((outer, before + size))
        if self._aliased and before + size > UNFOLDED_MOST:
            raise ValueError(f"its aliases unfold to more than {UNFOLDED_MOST} values")


def _check_scalar(event: yaml.ScalarEvent) -> None:
    if event.implicit[0] and len(event.value) > _LONGEST_NUMBER and _NUMBER.match(event.value):
        raise ValueError(f"a number has {len(event.value)} characters")


def _check_keys(root: yaml.Node | None) -> None:
    """Refuse a mapping that has a key twice."""
    seen: set[int] = set()
    waiting = [] if root is None else [root]
    while waiting:
        node = waiting.pop()
        if id(node) in seen:  # aliases mean one node several times
            continue
        seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            _check_mapping(node)
            waiting += [value for _, value in node.value]
        elif isinstance(node, yaml.SequenceNode):
            waiting += node.value


def _check_mapping(node: yaml.MappingNode) -> None:
    keys: set[tuple[str, str]] = set()
    for name, _ in node.value:
        if not isinstance(name, yaml.ScalarNode):
            continue
        if (name.tag, name.value) in keys:
            raise KeyTwiceError(
                problem=f"the key {quoted(name.value)} is there twice", problem_mark=name.start_mark
            )
        keys.add((name.tag, name.value))


def _values(document: object) -> Iterator[object]:
    """Every value once, however often it is meant."""
    seen: set[int] = set()
    waiting: list[Any] = [document]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict | list | set | tuple):
            if id(value) in seen:
                continue
            seen.add(id(value))
            waiting += [*value.keys(), *value.values()] if isinstance(value, dict) else value
        else:
            yield value
