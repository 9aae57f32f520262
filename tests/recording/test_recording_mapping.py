"""Mapping files: units, kinds, layouts of text tables, and refusals."""

from math import pi

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
import yaml

from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import Mapping, read_mapping
from nxt_twin.recording.recording import SignalKinds

BASE = {
    "time": {"column": "t", "unit": "s"},
    "input": {"column": "u", "kind": "voltage_v"},
    "output": {"column": "y", "kind": "position_rad"},
}


@pytest.fixture
def mapping(put):
    def write(**changes):
        return read_mapping(put("mapping.yaml", yaml.safe_dump(BASE | changes)))

    return write


def test_reads_the_documented_example(put):
    example = """
    table:  {format: csv, delimiter: ",", header: true}
    time:   {column: t, unit: s}
    input:  {column: vir, kind: force_n, gain: 35.1507, offset: 0.0}
    output: {column: qm, kind: position_m}
    supply: {column: u_batt, kind: voltage_v}
    """
    mapping = read_mapping(put("mapping.yaml", example))
    table = put("bench.csv", "t,vir,qm,u_batt,note\n0,1,0.5,24,go\n0.001,2,0.25,,on\n")
    recording = read_mapped(table, mapping)
    assert recording.name == "bench.csv"
    assert recording.kinds == SignalKinds("force_n", "position_m")
    assert list(recording.columns) == ["time_s", "input", "output", "supply_v"]
    np.testing.assert_array_equal(recording.columns["input"], [35.1507, 2 * 35.1507])
    np.testing.assert_array_equal(recording.columns["output"], [0.5, 0.25])
    np.testing.assert_array_equal(recording.columns["supply_v"], [24, np.nan])


@pytest.mark.parametrize(("unit", "scale"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6)])
def test_time_units(put, mapping, unit, scale):
    table = put("t.csv", "t,u,y\n0,0,0.5\n2000,1,1\n")
    recording = read_mapped(table, mapping(time={"column": "t", "unit": unit}))
    np.testing.assert_allclose(recording.time_s, [0.0, 2000.0 * scale], rtol=1e-15)


def test_a_constant_period_needs_no_column(put, mapping):
    table = put("t.csv", "u,y\n0,0.5\n1,1\n1,2\n")
    np.testing.assert_allclose(
        read_mapped(table, mapping(time={"period_s": 0.001})).time_s, [0, 0.001, 0.002]
    )


@pytest.mark.parametrize(
    ("kind", "si_kind", "si_of_one"),
    [
        ("position_rad", "position_rad", 1.0),
        ("position_deg", "position_rad", pi / 180),
        ("position_m", "position_m", 1.0),
        ("speed_rad_per_s", "speed_rad_per_s", 1.0),
        ("speed_deg_per_s", "speed_rad_per_s", pi / 180),
        ("speed_m_per_s", "speed_m_per_s", 1.0),
    ],
)
def test_outputs_come_in_si(put, mapping, kind, si_kind, si_of_one):
    table = put("t.csv", "t,u,y\n0,0,0.25\n1,1,3\n")
    output = {"column": "y", "kind": kind, "gain": 2.0, "offset": 1.0}
    recording = read_mapped(table, mapping(output=output))
    assert recording.kinds.output == si_kind
    np.testing.assert_allclose(recording.columns["output"], [1.5 * si_of_one, 7.0 * si_of_one])


@pytest.mark.parametrize("kind", ["power_pct", "voltage_v", "current_a", "torque_nm"])
def test_inputs_keep_their_kind(put, mapping, kind):
    table = put("t.csv", "t,u,y\n0,10,0.25\n1,-30,3\n")
    recording = read_mapped(table, mapping(input={"column": "u", "kind": kind, "offset": 5}))
    assert recording.kinds.input == kind
    np.testing.assert_array_equal(recording.columns["input"], [15.0, -25.0])


def test_an_empty_input_means_unchanged_and_zero_before_the_first(put, mapping):
    table = put("t.csv", "t,u,y\n0,,0.5\n1,3,1\n2,,\n")
    source = {"column": "u", "kind": "voltage_v", "offset": 1}
    recording = read_mapped(table, mapping(input=source))
    np.testing.assert_array_equal(recording.columns["input"], [0, 4, 4])
    np.testing.assert_array_equal(recording.columns["output"], [0.5, 1, np.nan])


def test_a_constant_input_needs_no_column(put, mapping):
    table = put("t.csv", "t,y\n0,0\n1,1\n")
    recording = read_mapped(table, mapping(input={"value": 60, "kind": "power_pct"}))
    np.testing.assert_array_equal(recording.columns["input"], [60.0, 60.0])


@pytest.mark.parametrize(
    ("cells", "output", "quantum"),
    [
        ("0 1 2", {"kind": "position_deg"}, pi / 180),
        ("0 1 2", {"kind": "position_deg", "gain": 0.5}, 0.5 * pi / 180),
        ("0 1 2", {"kind": "position_m", "gain": -1e-4}, 1e-4),
        ("0 0.5 2", {"kind": "position_deg"}, 0.0),
        ("0 0.5 2", {"kind": "position_deg", "quantum": 0.5, "gain": 2.0}, pi / 180),
        ("0 1 2", {"kind": "position_m", "quantum": 0}, 0.0),
        ("1 1 1", {"kind": "position_m"}, 0.0),
    ],
)
def test_the_outputs_quantum(put, mapping, cells, output, quantum):
    rows = "".join(f"{row},0,{cell}\n" for row, cell in enumerate(cells.split()))
    recording = read_mapped(put("t.csv", "t,u,y\n" + rows), mapping(output={"column": "y", **output}))
    assert recording.output_quantum == pytest.approx(quantum, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(
    ("text", "table"),
    [
        ("1 \t 0.5   2\n 2   1.5   3 \n", {"delimiter": "whitespace", "header": False}),
        ("1;0.5;2\n2;1.5;3\n", {"delimiter": ";", "header": False}),
        ("1\t0.5\t2\n2\t1.5\t3\n", {"delimiter": "\t", "header": False}),
        ("1 2\n0.5 1.5\n2 3\n", {"delimiter": "whitespace", "header": False, "transposed": True}),
        ("c1,1,2\nc2,0.5,1.5\nc3,2,3\n", {"transposed": True}),
        ("c1 c2 c3\n1 0.5 2\n2 1.5 3\n", {"delimiter": "whitespace"}),
    ],
)
def test_layouts_of_text(put, mapping, text, table):
    layout = mapping(
        table=table,
        time={"column": "c1"},
        input={"column": "c2", "kind": "voltage_v"},
        output={"column": "c3", "kind": "position_rad"},
    )
    recording = read_mapped(put("t.txt", text), layout)
    np.testing.assert_array_equal(recording.time_s, [1, 2])
    np.testing.assert_array_equal(recording.columns["input"], [0.5, 1.5])
    np.testing.assert_array_equal(recording.columns["output"], [2, 3])


def test_reads_a_parquet_table(tmp_path, mapping):
    path = tmp_path / "t.parquet"
    pyarrow.parquet.write_table(pa.table({"t": [0, 1], "u": [1, 2], "y": [0.5, None], "x": ["a", "b"]}), path)
    recording = read_mapped(path, mapping(table={"format": "parquet"}))
    np.testing.assert_array_equal(recording.columns["output"], [0.5, np.nan])


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"outputs": {}}, ["key outputs", "unknown key", "nearest known: output"]),
        (
            {"input": {"column": "u", "kind": "voltage_v", "gian": 2}},
            ["key input.gian", "nearest known: gain"],
        ),
        (
            {"output": {"column": "y", "kind": "position_cm"}},
            ["output.kind", "'position_cm'", "'position_m'"],
        ),
        ({"input": {"column": "u", "kind": "force"}}, ["input.kind", "'force'", "'force_n'"]),
        ({"input": {"column": "u"}}, ["input.kind", "is missing"]),
        ({"input": {"kind": "voltage_v"}}, ["key input", "either a column or a value"]),
        ({"input": {"kind": "voltage_v", "column": "u", "value": 1}}, ["either a column or a value"]),
        ({"input": {"kind": "power_pct", "value": 160}}, ["key input", "160 is outside"]),
        ({"input": {"kind": "voltage_v", "value": float("inf")}}, ["input.value", "finite"]),
        ({"time": {"column": "t", "unit": "min"}}, ["time.unit", "'min'", "'ms'"]),
        ({"time": {}}, ["key time", "either a column or a period_s"]),
        ({"time": {"period_s": 0}}, ["time.period_s", "greater than 0"]),
        ({"table": {"format": "xlsx"}}, ["table.format", "'xlsx'", "'parquet'"]),
        ({"table": {"delimiter": "::"}}, ["key table", "'::'", "whitespace"]),
        ({"supply": {"column": "u", "kind": "current_a"}}, ["supply.kind", "'voltage_v'"]),
        (
            {"input": {"column": "u", "kind": "torque_nm"}, "output": {"column": "y", "kind": "position_m"}},
            ["torque_nm"],
        ),
        ({"input": {"column": "u", "kind": "force_n"}}, ["a force_n does not drive a position_rad"]),
    ],
)
def test_refuses_a_wrong_mapping(put, refusal, changes, parts):
    path = put("mapping.yaml", yaml.safe_dump(BASE | changes))
    line = refusal(MappingError, read_mapping, path)
    for part in ["mapping.yaml", *parts]:
        assert part in line


def test_a_power_input_may_drive_a_linear_output(put, mapping):
    table = put("t.csv", "t,u,y\n0,10,0.25\n1,-30,3\n")
    changes = {"input": {"column": "u", "kind": "power_pct"}, "output": {"column": "y", "kind": "position_m"}}
    assert read_mapped(table, mapping(**changes)).kinds == SignalKinds("power_pct", "position_m")


@pytest.mark.parametrize(
    ("content", "part"),
    [
        ("time: {column: t\ninput: x\n", "line 2"),
        ("time: [1]\n\tinput: 2\n", "line 2"),
        ("- a\n- b\n", "key: value"),
        ("", "is empty"),
        ("a: \xff".encode("latin-1"), "not UTF-8"),
        ("[" * 5000, "no valid YAML"),
        ("a: " + "x" * 2**20, "over the limit of 1 MiB"),
    ],
)
def test_refuses_what_is_no_yaml(put, refusal, content, part):
    line = refusal(MappingError, read_mapping, put("mapping.yaml", content))
    assert "mapping.yaml" in line
    assert part in line


def test_refuses_a_missing_mapping_file(tmp_path, refusal):
    assert "no such file" in refusal(MappingError, read_mapping, tmp_path / "mapping.yaml")


@pytest.mark.parametrize(
    ("text", "error", "parts"),
    [
        ("t,u,z\n0,0,0\n1,1,1\n", MappingError, ["no column 'y'", "nearest known"]),
        ("t,u,y,y\n0,0,0,0\n1,1,1,1\n", MappingError, ["more than one column 'y'"]),
        ("t,u,y\n0,0,0\n", RecordingError, ["only one row"]),
        ("t,u,y\n0,0,\n1,1,\n", RecordingError, ["column y", "is empty"]),
        ("t,u,y\n1,0,0\n0,1,1\n", RecordingError, ["row 3, column t", "backwards"]),
        ("t,u,y\n1,0,0\n2,inf,1\n", RecordingError, ["row 3, column u", "'inf'"]),
        ("t,u,y\n1,0,0\n2,1,x\n", RecordingError, ["row 3, column y", "'x' is no number"]),
        ("t,u,y\n1,0,0\n2,1\n", RecordingError, ["row 3", "2 cells where there are 3 columns"]),
    ],
)
def test_refuses_a_table_that_does_not_fit(put, mapping, refusal, text, error, parts):
    line = refusal(error, read_mapped, put("t.csv", text), mapping())
    for part in ["t.csv", *parts]:
        assert part in line


def test_refuses_power_beyond_full_duty(put, mapping, refusal):
    table = put("t.csv", "t,u,y\n0,10,0.25\n1,60,3\n")
    source = {"column": "u", "kind": "power_pct", "gain": 2}
    line = refusal(RecordingError, read_mapped, table, mapping(input=source))
    assert "row 3, column u: 120 is outside -100 to 100" in line


TRANSPOSED = {
    "table": {"delimiter": "whitespace", "header": False, "transposed": True},
    "time": {"column": "c2"},
    "input": {"value": 1, "kind": "voltage_v"},
    "output": {"column": "c1", "kind": "position_rad"},
}


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("1 2 3\n0 1\n", "row 1: has 3 values"),
        ("1 2 3\n0 1 x\n", "row 2, column c2: 'x'"),
        ("1 2 3\n0 2 1\n", "row 2, value 3, column c2: time runs backwards"),
    ],
)
def test_refuses_a_wrong_transposed_table(put, mapping, refusal, text, part):
    assert part in refusal(RecordingError, read_mapped, put("t.txt", text), mapping(**TRANSPOSED))


def test_a_leap_of_the_clock_is_measured_in_seconds(put, refusal):
    table = put("run.csv", "t,u,y\n0,1,0\n3600000,1,1\n7300000,1,2\n")
    stamps = {"column": "t", "unit": "ms"}
    parts = {"input": {"column": "u", "kind": "torque_nm"}, "output": {"column": "y", "kind": "position_rad"}}
    in_ms = Mapping.model_validate({"time": stamps, **parts})
    assert "row 4, column t: time leaps by 3700 s" in refusal(RecordingError, read_mapped, table, in_ms)
    in_us = Mapping.model_validate({"time": {**stamps, "unit": "us"}, **parts})
    assert read_mapped(table, in_us).rows == 3
