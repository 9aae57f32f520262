"""Read recordings, cases and plants."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.case import Case, read_as_case, with_own_mapping
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording as _read_table
from nxt_twin.recording.recording import InputKind, Recording

ModelSource = Plant | str | Path | Mapping[str, Any]
"""A plant, or what `load_plant` makes one of."""


def read_recording(path: str | Path, mapping: str | Path | None = None) -> Recording:
    r"""Read a recording from CSV or Parquet, or any table by a mapping file.

    Args:
        path: the table; a sidecar `NAME.yaml` beside it is read too (docs/formats.md#sidecars).
        mapping: what the columns of a table from elsewhere are; else what the sidecar states.

    Raises:
        RecordingError: the table cannot be read as a recording; the text names the row and the column.
        MappingError: the mapping file does not describe the table.

    >>> import nxt_twin as nt
    >>> table = "time_s,a_power_pct,a_tacho_deg\n0.00,50,0\n0.01,,1\n0.02,,4\n"
    >>> _ = Path("run.csv").write_text(table)
    >>> nt.read_recording("run.csv")
    <Recording run.csv: 3 rows, 0.02 s, a_power_pct, a_tacho_deg>
    """
    table = Path(path)
    if mapping is not None:
        from nxt_twin.recording.any_mapping import read_any_mapping
        from nxt_twin.recording.mapped import read_mapped

        return read_mapped(table, read_any_mapping(Path(mapping)))
    table, found = with_own_mapping(table)
    if found is None:
        return _read_table(table)
    from nxt_twin.recording.mapped import read_mapped  # with the models of mappings: slow

    return read_mapped(table, found)


def read_case(path: str | Path) -> Case:
    r"""Read a case folder, or a single recording as a case of its own (docs/formats.md#cases).

    Raises:
        CaseError: the folder is no case.
        RecordingError, MappingError, PlantError: a file that it names cannot be used.

    >>> import nxt_twin as nt
    >>> _ = Path("run.csv").write_text("time_s,a_power_pct,a_tacho_deg\n0.00,50,0\n0.01,,1\n")
    >>> _ = Path("case.yaml").write_text("{plant: nxt_motor, recordings: [run.csv]}")
    >>> nt.read_case(".").recordings
    (<Recording run.csv: 2 rows, 0.01 s, a_power_pct, a_tacho_deg>,)
    """
    return read_as_case(Path(path))


def load_plant(model: ModelSource, input_kind: InputKind = "power_pct") -> Plant:
    """Load a plant by its name, its file or its keys (docs/formats.md#plant-files).

    Args:
        model: a name such as `nxt_motor`, the path of a YAML file, or a mapping; a plant is given back as it is.
        input_kind: what drives it: `power_pct`, `voltage_v`, `current_a`, `torque_nm`, `force_n`, or
            `goal_position_rad` (of a servo).

    Raises:
        PlantError: there is no such plant, or a key or value is wrong.

    >>> import nxt_twin as nt
    >>> motor = nt.load_plant("nxt_motor")
    >>> motor.adding("backlash", gap_deg=4.0, load_inertia_kg_m2=2e-4)
    <Plant dc_motor: coulomb_friction, viscous_friction, inductance, backlash>
    >>> nt.load_plant({"kind": "rigid_body", "inertia": 95.0, "coulomb_friction": 20.0}, "force_n")
    <Plant rigid_body: coulomb_friction>
    """
    if isinstance(model, Plant):
        return model
    config = model if isinstance(model, Mapping) else load_plant_config(model)
    return plant_from_config(config, input_kind)
