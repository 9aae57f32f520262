"""A run of a brick or of a bench, as an immutable table in memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.lags import KnownLags

InputKind = Literal[
    "power_pct", "voltage_v", "current_a", "torque_nm", "force_n", "goal_position_deg", "goal_position_rad"
]
GOALS: tuple[InputKind, ...] = ("goal_position_deg", "goal_position_rad")
"""Inputs that a position loop follows."""
OutputKind = Literal[
    "position_rad", "position_deg", "position_m", "speed_rad_per_s", "speed_deg_per_s", "speed_m_per_s"
]


@final
@dataclass(frozen=True)
class SignalKinds:
    """The kinds of the `input` and `output` columns of a mapped recording."""

    input: InputKind
    output: OutputKind


@final
@dataclass(frozen=True, repr=False)
class Recording:
    """One run: named columns over a common, non-decreasing `time_s`.

    Attributes:
        name: the file's name, or what the maker calls it.
        columns: float64 arrays of equal length by column name (docs/formats.md#recordings). NaN is a cell that was not
            sampled in that row. Modes are held as indices into `columns.DRIVE_MODES`.
        kinds: of a mapped recording's `input` (SI, except power_pct) and `output` (SI: rad, m, rad/s, m/s); None
            for a brick's recording.
        output_quantum: the smallest step of the output column in its SI unit, 0 where it has none.
        plant: the plant named by the recording's sidecar, if any.
        lags: by how much counts and commands are off the stamps of their rows, as the sidecar tells.
        tacho_step_deg: the encoder's step by port, as the sidecar tells; 1 of a port that it does not name.
        pulse_steps: in how many steps the bridge takes a duty, as the sidecar tells; 0 where it gives any.
    """

    name: str
    columns: Mapping[str, FloatArray]
    kinds: SignalKinds | None = None
    output_quantum: float = 0.0
    plant: str | None = None
    lags: KnownLags = field(default_factory=KnownLags)
    tacho_step_deg: Mapping[str, float] = field(default_factory=dict)
    pulse_steps: int = 0

    def __post_init__(self) -> None:
        frozen = {}
        for key, values in self.columns.items():
            array = np.array(values, dtype=np.float64)
            array.flags.writeable = False
            frozen[key] = array
        object.__setattr__(self, "columns", MappingProxyType(frozen))

    def __repr__(self) -> str:
        """Short: name, size and columns."""
        names = [name for name in self.columns if name != "time_s"]
        told = [f"{self.rows} rows", f"{self.duration_s:.4g} s", *names]
        return f"<Recording {self.name}: {', '.join(told)}>"

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The columns by Arrow's C interface: `pandas.DataFrame.from_arrow` and `polars.DataFrame` take a recording.

        Empty cells are null, and modes are words.
        """
        from nxt_twin.recording.arrow import table_of

        return table_of(self.columns).__arrow_c_stream__(requested_schema)

    @classmethod
    def from_arrow(cls, table: object, name: str = "table", kinds: SignalKinds | None = None) -> Recording:
        """A recording of a data frame or table that speaks Arrow: pandas, polars, pyarrow, DuckDB.

        Args:
            table: with columns of docs/formats.md#recordings; null and NaN are empty cells.
            name: what to call the recording.
            kinds: for a bench rather than a brick, what the columns `input` and `output` are.

        Raises:
            RecordingError: it does not speak Arrow, or its columns cannot be a recording's.

        >>> import nxt_twin as nt
        >>> import pandas as pd
        >>> frame = pd.DataFrame({"time_s": [0.0, 0.5, 1.0], "a_power_pct": [50, 50, 0]})
        >>> run = nt.Recording.from_arrow(frame, "mine")
        >>> run
        <Recording mine: 3 rows, 1 s, a_power_pct>
        >>> pd.DataFrame.from_arrow(nt.simulate("nxt_motor", run))["a_tacho_deg"].round().tolist()
        [0.0, 198.0, 411.0]
        """
        from nxt_twin.recording.arrow import columns_of

        return cls(name, columns_of(table, name, mapped=kinds is not None), kinds=kinds)

    @property
    def time_s(self) -> FloatArray:
        """The stamps, s, shape (rows,)."""
        return self.columns["time_s"]

    @property
    def rows(self) -> int:
        """How many polls the recording holds."""
        return int(self.time_s.size)

    @property
    def duration_s(self) -> float:
        """From the first stamp to the last, s."""
        return float(self.time_s[-1] - self.time_s[0])
