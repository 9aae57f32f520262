"""Tables as strangers have them: the format is found by content, whatever the file is called."""

import json
import sqlite3
from math import radians
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import pytest
import yaml
from scipy.io import savemat

from nxt_twin.errors import CaseError, MappingError, NxtTwinError, RecordingError
from nxt_twin.recording.case import read_as_case, read_case
from nxt_twin.recording.column_words import mapping_of_words
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.mapped import read_all_mapped, read_mapped
from nxt_twin.recording.mapping import mapping_of
from nxt_twin.recording.mappings import read_mappings
from nxt_twin.recording.tables.open import read_table
from nxt_twin.recording.tacho_steps import tacho_step_deg

KEYS = {
    "time": {"column": "t", "unit": "ms"},
    "input": {"column": "u", "kind": "power_pct"},
    "output": {"column": "y", "kind": "position_deg"},
}
T, U, Y = [0, 10, 20, 30], [0.0, 50.5, -50.5, 0.0], [0.0, 0.5, 2.25, 1.0]


def keys(**changes):
    return mapping_of({**KEYS, **changes}, "test")


def rows_of(delimiter, decimal="."):
    lines = [
        delimiter.join(str(cell).replace(".", decimal) for cell in row) for row in zip(T, U, Y, strict=True)
    ]
    return "\n".join(lines)


def check(recording):
    np.testing.assert_allclose(recording.time_s, np.array(T) / 1000)
    np.testing.assert_allclose(recording.columns["input"], U)
    np.testing.assert_allclose(np.degrees(recording.columns["output"]), Y)


@pytest.mark.parametrize(
    "text",
    [
        "t,u,y\n" + rows_of(","),
        '"t";"u";"y"\r\n' + rows_of(";", ",") + "\r\n",
        "t\tu\ty\n" + rows_of("\t", ","),
        "t | u | y\n" + rows_of(" | "),
        "t u y\n" + rows_of("   "),
        "Logger 3 of the rig\nstarted by hand, twice\nt,u,y\nms,%,deg\n" + rows_of(","),
        "\n".join(json.dumps({"t": t, "u": u, "y": y}) for t, u, y in zip(T, U, Y, strict=True)),
        json.dumps([{"t": t, "u": u, "y": y} for t, u, y in zip(T, U, Y, strict=True)]),
        json.dumps({"t": T, "u": U, "y": Y}),
        json.dumps(
            {
                "device": "phone",
                "samples": [{"t": t, "u": u, "y": y} for t, u, y in zip(T, U, Y, strict=True)],
            }
        ),
    ],
)
def test_text_is_read_however_it_is_cut(put, text):
    check(read_mapped(put("table.dat", text), keys()))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_text_is_read_in_the_encodings_of_spreadsheets(tmp_path, encoding):
    lines = ["t;u;y;°", *(f"{line};1" for line in rows_of(";", ",").splitlines())]
    (tmp_path / "t.csv").write_bytes("\n".join(lines).encode(encoding))
    check(read_mapped(tmp_path / "t.csv", keys()))


@pytest.mark.parametrize("write", [pyarrow.parquet.write_table, pyarrow.feather.write_feather])
def test_columns_in_lists_and_structs_are_read_from_arrow_files(tmp_path, write):
    state = pa.array([[0.0, y] for y in Y], pa.list_(pa.float32(), 2))
    action = pa.array([[u, 0.0] for u in U], pa.list_(pa.float64()))
    clock = pa.array([{"ms": t} for t in T])
    write(pa.table({"clock": clock, "observation.state": state, "action": action}), tmp_path / "episode")
    mapping = keys(
        time={"column": "clock.ms", "unit": "ms"},
        input={"column": "action", "index": 0, "kind": "power_pct"},
        output={"column": {"column": "observation.state", "index": 1}, "kind": "position_deg"},
    )
    check(read_mapped(tmp_path / "episode", mapping))


def test_matrices_and_structs_are_read_from_mat_files(tmp_path):
    log = {"time": T, "signals": np.array([{"values": U}, {"values": Y}], dtype=object)}
    savemat(
        tmp_path / "run",
        {"data": np.column_stack([T, U, Y]), "wide": np.array([T, U, Y]), "log": log},
        appendmat=False,
    )
    check(
        read_mapped(
            tmp_path / "run",
            keys(
                **{
                    k: {**KEYS[k], "column": f"log.{c}"}
                    for k, c in (
                        ("time", "time"),
                        ("input", "signals[0].values"),
                        ("output", "signals[1].values"),
                    )
                }
            ),
        )
    )
    for matrix in ("data", "wide"):
        indexed = {key: {**KEYS[key], "column": matrix, "index": n} for n, key in enumerate(KEYS)}
        check(read_mapped(tmp_path / "run", keys(**indexed)))
    cut = mapping_of_words("time=data[:, 0]:ms,power=data[:,1],angle=data[:, 2]:deg")
    check(read_mapped(tmp_path / "run", cut))


def test_joint_states_are_read_from_a_bag_and_a_damaged_one_is_refused(tmp_path, refusal):
    writer = pytest.importorskip("mcap_ros2.writer").Writer
    folder = tmp_path / "bag"
    folder.mkdir()
    with (folder / "bag_0.mcap").open("wb") as file:
        bag = writer(file)
        parts = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
        apart = "=" * 80
        header = f"{apart}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
        clock = f"{apart}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        joints = bag.register_msgdef("sensor_msgs/msg/JointState", parts + header + clock)
        number = bag.register_msgdef("std_msgs/msg/Float64", "float64 data\n")
        for t, u, y in zip(T, U, Y, strict=True):
            stamp = {"stamp": {"sec": 5, "nanosec": t * 1_000_000}, "frame_id": ""}
            state = {
                "header": stamp,
                "name": ["hip", "knee"],
                "position": [9.0, y],
                "velocity": [],
                "effort": [],
            }
            at_ns = 5_000_000_000 + t * 1_000_000
            bag.write_message("/power", number, {"data": u}, log_time=at_ns - 1000, publish_time=at_ns)
            bag.write_message("/joint_states", joints, state, log_time=at_ns, publish_time=at_ns)
        bag.finish()
    mapping = keys(
        time={"column": "stamp_s"},
        input={"column": "power.data", "kind": "power_pct"},
        output={"column": "joint_states.knee.position", "kind": "position_deg"},
    )
    recording = read_mapped(folder, mapping)
    seen = np.isfinite(recording.columns["output"])
    np.testing.assert_allclose(np.degrees(recording.columns["output"][seen]), Y)
    np.testing.assert_allclose(recording.time_s[seen] - 5.0, np.array(T) / 1000, atol=1e-6)
    np.testing.assert_allclose(recording.columns["input"][seen], U)
    whole = (folder / "bag_0.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    assert "no readable bag" in refusal(RecordingError, read_mapped, tmp_path / "cut.mcap", mapping)
    older = tmp_path / "older"
    older.mkdir()
    _into_sqlite(folder / "bag_0.mcap", older / "bag_0.db3")
    again = read_mapped(older, mapping)
    np.testing.assert_array_equal(again.time_s, recording.time_s)
    np.testing.assert_array_equal(again.columns["output"], recording.columns["output"])
    np.testing.assert_array_equal(again.columns["input"], recording.columns["input"])
    whole = (older / "bag_0.db3").read_bytes()
    (tmp_path / "cut.db3").write_bytes(whole[: len(whole) // 2])
    assert "no readable bag" in refusal(RecordingError, read_mapped, tmp_path / "cut.db3", mapping)
    (older / "bag_1.db3").write_bytes(whole)
    assert "is a bag in 2 parts" in refusal(RecordingError, read_mapped, older, mapping)


def _into_sqlite(bag: Path, path: Path) -> None:
    """Write the messages of a bag as ROS 2 Humble does: types by name, without definitions."""
    from mcap.reader import make_reader

    with bag.open("rb") as file, sqlite3.connect(path) as out:
        out.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)")
        out.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data BLOB)")
        out.execute("INSERT INTO topics VALUES (99, '/chatter', 'std_msgs/msg/String', 'cdr')")
        out.execute("INSERT INTO messages VALUES (NULL, 99, 7, ?)", (b"\0\1\0\0\2\0\0\0a\0",))
        for schema, channel, message in make_reader(file).iter_messages():
            topic = (channel.id, channel.topic, schema.name, "cdr")
            out.execute("INSERT OR IGNORE INTO topics VALUES (?, ?, ?, ?)", topic)
            row = (channel.id, message.log_time, message.data)
            out.execute("INSERT INTO messages VALUES (NULL, ?, ?, ?)", row)


def test_a_database_that_is_no_bag_is_refused(tmp_path, refusal):
    pytest.importorskip("mcap_ros2")
    with sqlite3.connect(tmp_path / "log.db") as out:
        out.execute("CREATE TABLE readings(t, y)")
    assert "no bag of ROS 2" in refusal(RecordingError, read_mapped, tmp_path / "log.db", keys())


@pytest.mark.parametrize(
    ("kind", "data", "value"),
    [
        ("Bool", b"\1", True),
        ("Int32", b"\xfe\xff\xff\xff", -2),
        ("UInt64", b"\7" + bytes(7), 7),
        ("Float32", b"\0\0\xc0\x3f", 1.5),
        ("Float32MultiArray", bytes(4) + bytes(4) + b"\1\0\0\0" + b"\0\0\xc0\x3f", 1.5),
    ],
)
def test_numbers_of_a_bag_need_no_definition_in_it(tmp_path, kind, data, value):
    pytest.importorskip("mcap_ros2")
    path = tmp_path / "bag.db3"
    with sqlite3.connect(path) as out:
        out.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)")
        out.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data BLOB)")
        out.execute("INSERT INTO topics VALUES (1, '/x', ?, 'cdr')", (f"std_msgs/msg/{kind}",))
        out.execute("INSERT INTO messages VALUES (1, 1, 2000000000, ?)", (b"\0\1\0\0" + data,))
    column = "x.data[0]" if "Multi" in kind else "x.data"
    table = read_table(path, lambda names: dict.fromkeys(names, "number"), None, {})
    assert table.numbers[column][0] == value
    assert table.numbers["logged_s"][0] == 2.0


def test_a_table_is_split_into_recordings_and_one_is_named_by_its_value(put):
    path = put("log.csv", "t,u,y,run\n0,1,1,a\n10,2,2,a\n0,3,3,b\n10,4,4,b\n20,5,5,\n")
    mapping = keys(split={"column": "run"})
    first, second = read_all_mapped(path, mapping)
    assert [first.name, second.name] == ["log.csv#a", "log.csv#b"]
    np.testing.assert_array_equal(second.columns["input"], [3, 4])
    np.testing.assert_array_equal(read_mapped(path.with_name("log.csv#b"), mapping).columns["input"], [3, 4])
    again = mapping_of({**KEYS, "table": {"split": {"column": "run"}}}, "test")
    assert again == mapping


def test_coasting_constants_wrapping_and_dates(put):
    text = "when,y,on\n2024-03-01T10:00:00Z,350,0\n2024-03-01T10:00:00.5Z,10,1.0\n2024-03-01T10:00:01Z,30,\n"
    path = put("run_40_deg.csv", text)
    mapping = keys(
        time={"column": "when", "unit": "iso"},
        input={"value": {"*_20_*": 20, "*_40_*": 40}, "kind": "goal_position_deg"},
        output={"column": "y", "kind": "position_deg", "wraps_at": 360, "step": 0.5},
        mode={"column": "on", "values": {0: "coast", 1: "drive"}},
    )
    recording = read_mapped(path, mapping)
    np.testing.assert_allclose(np.diff(recording.time_s), 0.5)
    np.testing.assert_allclose(recording.columns["input"], radians(40))
    assert recording.kinds.input == "goal_position_rad"
    np.testing.assert_allclose(np.degrees(recording.columns["output"]), [350, 370, 390])
    assert recording.output_quantum == pytest.approx(radians(0.5))
    assert [DRIVE_MODES[int(mode)] for mode in recording.columns["mode"]] == ["coast", "drive", "drive"]


@pytest.mark.parametrize(
    ("changes", "text", "parts"),
    [
        ({"output": {"column": "z", "kind": "position_deg"}}, "", ["mapping key output", "nearest known: y"]),
        (
            {"mode": {"column": "u", "values": {1: "drive"}}},
            "",
            ["row 2, column u", "mode: {values: {0: coast}}"],
        ),
        ({"time": {"column": "t", "unit": "iso"}}, "", ["'0' is no date", "time: {unit"]),
        (
            {"input": {"value": {"b*": 1}, "kind": "power_pct"}},
            "",
            ["mapping key input.value", "table.csv: VALUE"],
        ),
        ({"table": {"decimal": "."}}, "t;u;y\n0;0,5;1\n1;0,5;2\n", ["'0,5' is no number", 'decimal: ","']),
        ({"table": {"format": "parquet"}}, "", ["mapping key table", "write `table: {format: csv}`"]),
        ({"table": {"format": "csv"}}, "PAR1", ["is parquet, not csv", "write `table: {format: parquet}`"]),
        ({}, "t,u,y\n0,300,0\n1,0,1\n", ["300 is outside", "write `input: {gain"]),
        ({}, "t,u,y\n5,0,0\n1,0,1\n", ["runs backwards", "write `split: {column"]),
        ({}, "PK\x03\x04 a sheet", ["spreadsheet", "export the sheet"]),
        ({}, '[{"t": 1}', ["no JSON"]),
        ({}, '{"t": 0, "u": 1' + "0" * 5000 + '}\n{"t": 1}\n', ["row 1", "no JSON"]),
        (
            {},
            '[{"t": 0, "u": 1' + "0" * 400 + ', "y": 0}, {"t": 1, "u": 0, "y": 1}]',
            ["row 1, column u", "no number"],
        ),
        ({}, '{"t": [1], "u": [1, 2]}', ["differ in length: t 1, u 2"]),
    ],
)
def test_a_refusal_says_which_key_to_write(put, refusal, changes, text, parts):
    path = put("table.csv", text or "t,u,y\n" + rows_of(","))
    line = refusal(NxtTwinError, read_mapped, path, keys(**changes))
    for part in parts:
        assert part in line


def test_a_case_gives_its_files_mappings_of_their_own(put, tmp_path, refusal):
    put("a.txt", "t,u,y\n" + rows_of(","))
    put("b.txt", "seconds,u,y\n0,0,1\n1,0,2\n")
    put("own.yaml", yaml.safe_dump(KEYS))
    other = {**KEYS, "time": {"column": "seconds"}}
    case = {
        "plant": "nxt_motor",
        "recordings": ["a.txt", "b.txt"],
        "mapping": {"a.txt": "own.yaml", "b*": other},
    }
    put("case.yaml", yaml.safe_dump(case))
    first, second = read_case(tmp_path).recordings
    check(first)
    np.testing.assert_array_equal(second.time_s, [0, 1])
    put("case.yaml", yaml.safe_dump({**case, "mapping": {"a.txt": "own.yaml"}}))
    assert "b.txt: MAPPING.yaml" in refusal(MappingError, read_case, tmp_path)
    put("case.yaml", yaml.safe_dump({**case, "mapping": {"*": 3}}))
    assert "is no mapping" in refusal(CaseError, read_case, tmp_path)


def test_a_mapping_beside_a_table_is_its_sidecar_s(put, refusal):
    table = put("log.txt", "t,u,y\n" + rows_of(","))
    assert "nxt-twin map log.txt --out log.yaml" in refusal(RecordingError, read_as_case, table)
    put("log.yaml", yaml.safe_dump({**KEYS, "plant": "nxt_motor_as_printed"}))
    case = read_as_case(table)
    check(case.recordings[0])
    assert case.plant == "nxt_motor_as_printed"


def test_a_mapping_file_may_hold_several_by_pattern(put, refusal):
    put("a.txt", "t,u,y\n" + rows_of(","))
    other = {**KEYS, "time": {"column": "seconds"}}
    mapping_of_file = read_mappings(put("all.yaml", yaml.safe_dump({"a.*": KEYS, "b.*": other})))
    assert mapping_of_file("a.txt").time.column == "t"
    assert mapping_of_file("b.csv").time.column == "seconds"
    assert "c.csv: MAPPING.yaml" in refusal(MappingError, mapping_of_file, "c.csv")
    assert "key input: is missing" in refusal(
        MappingError, read_mappings, put("cut.yaml", "time: {column: t}")
    )


def test_a_sidecar_states_the_encoder_s_step_by_port(put, refusal):
    table = put("run.csv", "time_s,a_power_pct,a_tacho_deg\n0,0,0.088\n0.1,0,0.176\n")
    put("run.yaml", "tacho_step_deg: {a: 0.088, b: 1}")
    assert read_as_case(table).recordings[0].tacho_step_deg == {"a": 0.088, "b": 1.0}
    put("run.yaml", "tacho_step_deg: 0.5")
    assert read_as_case(table).recordings[0].tacho_step_deg["c"] == 0.5
    put("run.yaml", "tacho_step_deg: {d: 1}")
    assert "key tacho_step_deg: is no encoder step" in refusal(RecordingError, read_as_case, table)


def test_counts_in_fractions_of_a_degree_have_the_step_that_they_show_and_the_key_is_named(put):
    counts = np.cumsum([3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8]) * 0.088
    rows = "".join(f"{0.1 * n:.1f},50,{count:.3f}\n" for n, count in enumerate(counts))
    case = read_as_case(put("run.csv", "time_s,a_power_pct,a_tacho_deg\n" + rows))
    (line,) = case.remarks()
    assert "run.csv, column a_tacho_deg" in line
    assert "write `tacho_step_deg: 0.088` into run.yaml" in line
    assert tacho_step_deg(case.recordings[0], "a") == pytest.approx(0.088, rel=1e-3)
    put("run.yaml", "tacho_step_deg: 0.088")
    assert read_as_case(put("run.csv", "time_s,a_power_pct,a_tacho_deg\n" + rows)).remarks() == ()
