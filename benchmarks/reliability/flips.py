"""One bit flipped at many places of a stream: each is told, none comes back silently wrong."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Final

import numpy as np

from nxt_twin.errors import RecordingError
from nxt_twin.recording.stream import RecordingWriter, recover, stream_path

COLUMNS: Final = ("time_s", "a_power_pct", "a_mode", "a_tacho_deg")
_ROWS: Final = 200


def report(places: int, seed: int) -> Iterator[str]:
    """What came of a number of flips."""
    random = Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        data, truth = _written(path)
        seen = Counter(_flipped(path, data, truth, random.randrange(8 * len(data))) for _ in range(places))
    told = ", ".join(f"{number} {what}" for what, number in seen.most_common())
    yield f"one bit flipped at {places} places of a stream of {len(data)} bytes: {told}; silently wrong {seen['WRONG']}"


def _written(path: Path) -> tuple[bytes, np.ndarray]:
    rng = np.random.default_rng(5)
    truth = np.column_stack([np.arange(_ROWS) / 100, rng.integers(-100, 101, _ROWS), rng.integers(0, 4, _ROWS),
                             np.cumsum(rng.integers(-3, 9, _ROWS))]).astype(float)  # fmt: skip
    with RecordingWriter(path, COLUMNS) as writer:
        for row in truth:
            writer.row(dict(zip(COLUMNS, row, strict=True)))
        data = stream_path(path).read_bytes()
    path.unlink()
    return data, truth


def _flipped(path: Path, data: bytes, truth: np.ndarray, place: int) -> str:
    flipped = bytearray(data)
    flipped[place // 8] ^= 1 << place % 8
    stream_path(path).write_bytes(flipped)
    try:
        recovered = recover(path)
    except RecordingError:
        return "refused" if stream_path(path).exists() else "WRONG"
    path.unlink()
    rows = np.column_stack([recovered.recording.columns[name] for name in COLUMNS])
    if not recovered.damages or not stream_path(path).exists() or not _among(rows, truth):
        return "WRONG"
    return f"told with {_ROWS - len(rows)} rows lost"


def _among(rows: np.ndarray, truth: np.ndarray) -> bool:
    """Whether every row is one of the truth's, in its order."""
    numbers = np.rint(rows[:, 0] * 100).astype(int)
    return bool(np.all(np.diff(numbers) > 0) and np.array_equal(rows, truth[numbers]))
