"""A session's files with all that a worker needs: it can be sent to a machine that does not see them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any, Final, final

from nxt_twin.fleet.finding.labels import Labels
from nxt_twin.fleet.finding.sessions import LoggedSession
from nxt_twin.fleet.version import engine_version

_KEY_BYTES: Final = 16


@final
@dataclass(frozen=True)
class Options:
    """The options of a fleet's diagnoses.

    Attributes:
        seed: of the random shifts behind p-values.
        tolerance: error of a simulation that does not matter, SI; None for the engine's own.
    """

    seed: int = 0
    tolerance: float | None = None


@final
@dataclass(frozen=True)
class Parcel:
    """One case to be diagnosed.

    Attributes:
        key: of the files' content, their labels, the fleet's keys, the options and the engine: of all that an
            answer depends on.
        labels: whose recordings they are.
        source: where they lie, for a person.
        files: contents by their names within the case.
        recordings: the names of the tables; none where the files hold a `case.yaml`.
        keys: what a case without a `case.yaml` takes over.
        options: how to diagnose.
        engine: that is to answer.
    """

    key: str
    labels: Labels
    source: str
    files: dict[str, bytes]
    recordings: tuple[str, ...]
    keys: dict[str, Any]
    options: Options
    engine: str


def parcel_of(session: LoggedSession, options: Options) -> Parcel:
    """Read a session's files.

    Raises:
        OSError: one cannot be read.
    """
    files = {name: session.store.read(path) for name, path in sorted(session.files.items())}
    engine = engine_version()
    labels = session.labels
    said = [
        *(engine, options.seed, options.tolerance, session.keys, session.recordings),
        *(labels.unit, labels.session, labels.batch),
    ]
    digest = blake2b(json.dumps(said, sort_keys=True, default=str).encode(), digest_size=_KEY_BYTES)
    for name, content in files.items():
        digest.update(f"{name}\0{len(content)}\0".encode())
        digest.update(content)
    return Parcel(
        digest.hexdigest(),
        labels,
        session.source,
        files,
        session.recordings,
        session.keys,
        options,
        engine,
    )
