"""What `import nxt_twin` offers."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pytest

import nxt_twin as nt
from nxt_twin.errors import DiagnosisError, RecordingError
from nxt_twin.recording.recording import SignalKinds

PUBLIC = {
    "Case", "Changes", "Diagnosis", "Effect", "NxtTwinError", "Parameter", "Plant", "Recording", "__version__",
    "find_changes", "find_missing_physics", "fit", "load_plant", "open_brick", "read_case", "read_recording", "record",
    "replay", "simulate", "start_mock",
}  # fmt: skip
MINE = {
    "time_s": [0.0, 0.25, 0.5, 0.75],
    "a_power_pct": [40.0, 40.0, 0.0, 0.0],
    "a_mode": [0.0, 0.0, 3.0, 2.0],
}


def test_the_public_names_are_these():
    assert set(nt.__all__) == PUBLIC
    assert set(dir(nt)) >= PUBLIC


@pytest.mark.parametrize("name", sorted(PUBLIC - {"__version__"}))
def test_every_public_name_is_there_and_says_what_it_is(name):
    assert getattr(nt, name).__doc__


def test_a_name_that_is_not_public_is_refused():
    with pytest.raises(AttributeError, match="levitate"):
        nt.levitate  # noqa: B018


def test_the_stub_gives_type_checkers_the_same_names():
    stub = Path(nt.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    assert set(re.findall(r" as (\w+)$|^(__version__): str$", stub, re.MULTILINE)) == {
        (name, "") if name != "__version__" else ("", name) for name in PUBLIC
    }


def test_a_recording_goes_to_pandas_and_polars_and_comes_back():
    run = nt.Recording("run", {**MINE, "a_tacho_deg": [0.0, float("nan"), 91.0, 92.0]})
    for frame in (pd.DataFrame.from_arrow(run), pl.DataFrame(run)):
        assert list(frame["a_mode"]) == ["drive", "drive", "brake", "coast"]
        assert list(frame["a_tacho_deg"])[2] == 91
        back = nt.Recording.from_arrow(frame, "run")
        for name, values in run.columns.items():
            assert back.columns[name].tolist() == pytest.approx(values.tolist(), nan_ok=True)


@pytest.mark.parametrize(
    ("table", "complaint"),
    [
        ([1, 2], "list does not speak Arrow"),
        (pl.DataFrame({"time_s": [0.0, 1.0], "a_power": [1, 2]}), "nearest known: a_power_pct"),
        (pl.DataFrame({"a_power_pct": [1, 2]}), "time_s"),
        (
            pl.DataFrame({"time_s": [0.0, 1.0], "a_power_pct": ["fast", "slow"]}),
            "something else than numbers",
        ),
        (pl.DataFrame({"time_s": [1.0, 0.0], "a_power_pct": [1, 2]}), "row 2"),
        (pl.DataFrame({"time_s": [0.0, 1.0], "a_power_pct": [1, 200]}), "outside -100 to 100"),
    ],
)
def test_a_table_that_is_no_recording_is_refused_in_one_line(table, complaint):
    with pytest.raises(RecordingError, match=complaint) as refused:
        nt.Recording.from_arrow(table, "mine")
    assert str(refused.value).startswith("mine")
    assert "\n" not in str(refused.value)


def test_commands_of_ones_own_need_no_reading():
    run = nt.simulate("nxt_motor", nt.Recording("mine", MINE))
    angle = run.columns["a_tacho_deg"]
    assert angle[0] == 0.0
    assert 0.0 < angle[1] < angle[2] < angle[3]


def test_two_motors_are_simulated_beside_one_another():
    columns = {"time_s": MINE["time_s"], "a_power_pct": [50.0] * 4, "c_power_pct": [-50.0] * 4}
    run = nt.simulate("nxt_motor", nt.Recording("mine", columns))
    assert run.columns["a_tacho_deg"].tolist() == pytest.approx((-run.columns["c_tacho_deg"]).tolist())


def test_a_force_of_ones_own_moves_a_bench():
    kinds = SignalKinds("force_n", "position_m")
    table = pl.DataFrame({"time_s": [0.0, 0.5, 1.0], "input": [10.0, 10.0, 10.0]})
    run = nt.Recording.from_arrow(table, "pushed", kinds=kinds)
    out = nt.simulate({"kind": "rigid_body", "inertia": 2.0}, run).columns["output"]
    assert out.tolist() == pytest.approx([0.0, 0.625, 2.5], rel=1e-3)


def test_a_recording_without_commands_is_refused():
    with pytest.raises(RecordingError, match="commands no port"):
        nt.simulate("nxt_motor", nt.Recording("mine", {"time_s": [0.0, 1.0], "battery_v": [8.0, 8.0]}))


def test_an_effect_is_added_in_the_names_and_units_of_a_plant_file():
    motor = nt.load_plant("nxt_motor").adding("backlash", gap_deg=4.0, load_inertia_kg_m2=2e-4)
    assert motor.to_config()["effects"] == {"backlash": {"gap_deg": 4.0, "load_inertia_kg_m2": 2e-4}}
    with pytest.raises(nt.NxtTwinError, match="did you mean 'gap_deg'"):
        nt.load_plant("nxt_motor").adding("backlash", gap=4.0, load_inertia_kg_m2=2e-4)


def test_a_recorded_mock_is_diagnosed_and_drawn(tmp_path):
    run = nt.record("mock:", tmp_path / "run.parquet", program="gentle_steps", seconds=6.0)
    found = nt.find_missing_physics(run, nt.load_plant("nxt_motor"))
    assert repr(found).startswith(f"<Diagnosis run: {found.verdict}")
    assert found.plant.layout.base.kind == "dc_motor"
    measured, *_ = found.plot().axes
    assert measured.lines
    with pytest.raises(DiagnosisError, match="has no held-out run 99"):
        found.plot(99)


def test_a_mock_that_cannot_be_made_says_why_where_it_was_asked_for(tmp_path):
    with pytest.raises(nt.NxtTwinError, match="world"), nt.start_mock(world=tmp_path / "no-world.yaml"):
        pass


def test_the_page_of_the_library_tells_of_every_name():
    page = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
    assert [name for name in PUBLIC if not re.search(rf"`{name}\b", page)] == []


def test_a_recording_of_time_alone_names_no_column():
    assert repr(nt.Recording("r", {"time_s": np.arange(3.0)})) == "<Recording r: 3 rows, 2 s>"
