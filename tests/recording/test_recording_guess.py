"""Mappings guessed of strangers' tables, and `--columns`."""

import json
import re

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import pytest
import yaml
from scipy.io import savemat

from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.column_words import mapping_of_words
from nxt_twin.recording.guess.contract import is_recording
from nxt_twin.recording.guess.guess import guess_mapping
from nxt_twin.recording.guess.writing import mapping_text
from nxt_twin.recording.mapped import read_all_mapped
from nxt_twin.recording.mapping import mapping_of

ROWS = 400
T = 0.01 * np.arange(ROWS)
U = np.repeat([40.0, -70.0, 0.0, 95.0, -20.0], ROWS // 5)
DEG = np.round(np.cumsum(np.convolve(U, np.ones(20) / 20)[:ROWS]) * 0.08, 2)
VOLTS = 8.0 - 0.003 * np.abs(U)


def lines(head, *columns, sep=",", decimal="."):
    rows = (sep.join(f"{cell:g}".replace(".", decimal) for cell in row) for row in zip(*columns, strict=True))
    return "\n".join([*([head] if head else []), *rows]) + "\n"


def guessed(path, joint=None):
    found = guess_mapping(path, joint)
    assert found.lacking is None
    assert yaml.safe_load(mapping_text(found, ["seen"])) == found.keys
    return found.keys, read_all_mapped(path, mapping_of(found.keys, "guess"))


def holds(recordings, *, reading=None, kind="power_pct", command=U):
    (recording,) = recordings
    assert recording.kinds.input == kind
    np.testing.assert_allclose(recording.time_s - recording.time_s[0], T, atol=1e-6)
    np.testing.assert_allclose(recording.columns["input"], command, atol=0.51)
    np.testing.assert_allclose(
        np.degrees(recording.columns["output"]), DEG if reading is None else reading, atol=0.3
    )


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (lines("Zeit [s];PWM [%];Winkel [°];Batterie [V]", T, U, DEG, VOLTS, sep=";", decimal=","), "cp1252"),
        (lines("bench 7\ntime,motor duty,angle\nms,%,deg", 1e3 * T, U, DEG), "utf-8"),
        (lines("", T, U, DEG, sep="\t"), "utf-8"),
        (lines("millis,pwm,angle_rad", 1e3 * T + 7e4, 2.55 * U, np.radians(DEG)), "utf-8"),
        (lines("t,Stellgröße (PWM %),q", T, U, np.radians(DEG)), "utf-8"),
    ],
)
def test_text_tables(tmp_path, text, encoding):
    (tmp_path / "log.txt").write_bytes(text.encode(encoding))
    keys, recordings = guessed(tmp_path / "log.txt")
    holds(recordings)
    assert ("supply" in keys) == ("Batterie" in text)


@pytest.mark.parametrize(("forward", "backward"), [("V", "R"), ("R", "V")])
def test_a_bench_that_writes_the_direction_as_a_word_and_leaves_units_empty(tmp_path, forward, backward):
    rows = (
        f"10:{int(t) // 60:02}:{t % 60:05.2f};{abs(u) * 2.55:.0f};{forward if u >= 0 else backward};{y}".replace(
            ".", ","
        )
        for t, u, y in zip(T, U, DEG, strict=True)
    )
    head = "Bench 3; motor A\n\nUhrzeit;Stellgröße;Richtung;Drehwinkel\nhh:mm:ss;PWM;;Grad"
    (tmp_path / "log.csv").write_bytes("\n".join([head, *rows]).encode("cp1252"))
    keys, recordings = guessed(tmp_path / "log.csv")
    assert keys["input"]["sign"] == {"column": "Richtung", "values": {forward: 1, backward: -1}}
    holds(recordings)


def test_a_phone_s_log_of_json_lines(put):
    rows = (
        {"timestamp": 1.7e12 + 1e3 * t, "device": "phone", "motor": {"duty": u, "angle_deg": y}}
        for t, u, y in zip(T, U, DEG, strict=True)
    )
    keys, recordings = guessed(put("log.jsonl", "\n".join(json.dumps(row) for row in rows)))
    assert keys["time"] == {"column": "timestamp", "unit": "ms"}
    holds(recordings)


def test_a_lerobot_data_set_by_episode_and_joint(tmp_path):
    (tmp_path / "meta").mkdir()
    (tmp_path / "data").mkdir()
    joints = {
        "action": {"names": ["pan", "elbow"]},
        "observation.state": {"names": {"motors": ["pan", "elbow"]}},
    }
    (tmp_path / "meta" / "info.json").write_text(json.dumps({"features": joints}))

    def pair(values):
        return pa.FixedSizeListArray.from_arrays(pa.array(np.column_stack([0.1 * values, values]).ravel()), 2)

    half = ROWS // 2
    table = pa.table(
        {
            "observation.state": pair(DEG),
            "action": pair(U),
            "timestamp": np.tile(T[:half], 2),
            "frame_index": np.tile(np.arange(half), 2),
            "episode_index": np.repeat([3, 4], half),
            "index": np.arange(ROWS),
        }
    )
    pyarrow.parquet.write_table(table, tmp_path / "data" / "file-000.parquet")
    keys = guess_mapping(tmp_path).keys
    assert keys["input"] == {"column": "action", "index": 1, "kind": "goal_position_deg"}
    pan = {"column": "observation.state", "index": 0, "kind": "position_deg", "sign": 1.0}
    assert keys.pop("gravity_of") == {"pan": pan}
    recordings = read_all_mapped(tmp_path, mapping_of(keys, "guess"))
    assert [recording.name.partition("#")[2] for recording in recordings] == ["3", "4"]
    np.testing.assert_allclose(np.degrees(recordings[1].columns["input"]), U[half:])
    of_pan = guess_mapping(tmp_path, "pan").keys
    assert (of_pan["output"]["index"], of_pan["gravity_of"]["elbow"]["sign"]) == (0, 0.0)


def test_ticks_that_start_anew_each_turn_and_dates_and_speeds(tmp_path):
    ticks = np.floor(DEG * 4096 / 360) % 4096
    table = pa.table({"t_us": (1e6 * T).astype(int), "cmd": U / 100, "present_position": ticks.astype(int)})
    pyarrow.feather.write_feather(table, tmp_path / "servo")
    keys, recordings = guessed(tmp_path / "servo")
    assert keys["output"]["wraps_at"] == 4096
    holds(recordings, reading=DEG - DEG[0])
    dates = [f"2024-05-01 12:00:{t:09.6f}" for t in T]
    rpm = np.round(DEG / 6, 1)
    rows = "".join(f"{n},{d},{u},{r}\n" for n, (d, u, r) in enumerate(zip(dates, U, rpm, strict=True)))
    (tmp_path / "frame.csv").write_text(",datetime,duty_pct,velocity_rpm\n" + rows)
    keys, (recording,) = guessed(tmp_path / "frame.csv")
    assert keys["time"] == {"column": "datetime", "unit": "iso"}
    np.testing.assert_allclose(recording.columns["output"], rpm * np.pi / 30, rtol=1e-6)


def test_what_a_refusal_of_two_columns_of_one_name_says_reads_the_table(put):
    rpm = np.round(DEG / 6, 2)
    rpm[5::37] = np.nan
    text = lines(
        "Zeit [ms];PWM (%);Drehzahl [rpm];Drehzahl [rpm]", 1e3 * T, U, rpm, rpm, sep=";", decimal=","
    )
    path = put("messung.csv", text.replace("nan", ""))
    refused = guess_mapping(path)
    assert "`table: {header: false, skip: 1}`" in str(refused.lacking)
    keys = {
        "table": {**refused.keys["table"], "header": False, "skip": 1},
        "time": {"column": "c1", "unit": "ms"},
        "input": {"column": "c2", "kind": "power_pct"},
        "output": {"column": "c3", "kind": "speed_rad_per_s", "gain": np.pi / 30},
    }
    holds(read_all_mapped(path, mapping_of(keys, "by hand")), reading=6 * rpm)


def test_the_span_of_a_speed_is_told_in_its_unit(put):
    path = put("speeds.csv", lines("t_ms,pwm,speed [rpm]", 1e3 * T, U, np.round(DEG / 6, 1)))
    assert re.search(r"spans [\d.]+ rad/s", mapping_text(guess_mapping(path), []))


def test_matrices_and_structs_of_mat_files(tmp_path):
    savemat(tmp_path / "matrix.mat", {"data": np.column_stack([T, U, DEG])})
    keys, recordings = guessed(tmp_path / "matrix.mat")
    assert keys["output"]["column"] == "data"
    holds(recordings)
    log = {"time": T, "voltage": U / 10, "theta_rad": np.radians(DEG)}
    savemat(tmp_path / "struct.mat", {"log": log, "Ts": 0.01, "title": "bench"})
    holds(guessed(tmp_path / "struct.mat")[1], kind="voltage_v", command=U / 10)


def test_of_two_unnamed_columns_the_one_whose_slope_the_other_is_is_the_angle(tmp_path):
    speed = 300.0 * np.sin(3.0 * T) + 0.5 * U
    angle = np.concatenate([[0.0], np.cumsum(0.01 * (speed[1:] + speed[:-1]) / 2)])
    savemat(tmp_path / "matrix.mat", {"data": np.column_stack([T, speed, U, angle])})
    keys, _ = guessed(tmp_path / "matrix.mat")
    assert (keys["output"]["index"], keys["input"]["index"]) == (3, 2)


def test_what_the_bridge_does_in_words_and_in_flags(put):
    words = np.repeat(["drive", "coast", "brake", "drive"], ROWS // 4)
    rows = "".join(f"{t:g},{u:g},{y:g},{w}\n" for t, u, y, w in zip(T, U, DEG, words, strict=True))
    keys, (worded,) = guessed(put("words.csv", "t,pwm,angle_deg,bridge\n" + rows))
    assert keys["mode"]["values"]["brake"] == "brake"
    flags = (words != "coast").astype(int), (words == "brake").astype(int)
    table = put("flags.csv", lines("t,pwm,angle_deg,enable,brake", T, U, DEG, *flags))
    keys, (flagged,) = guessed(table)
    assert len(keys["mode"]) == 2
    np.testing.assert_array_equal(worded.columns["mode"], flagged.columns["mode"])
    assert np.unique(worded.columns["mode"]).size == 3
    stated = mapping_of_words("time=t,power=pwm,angle=angle_deg:deg,enabled=enable,brake=brake")
    (again,) = read_all_mapped(table, stated)
    np.testing.assert_array_equal(again.columns["mode"], flagged.columns["mode"])


def test_files_that_differ_in_the_number_of_their_names_have_values_of_their_own(put):
    text = lines("t,deg", T, np.rint(DEG))
    for name in ("step_pwm40.csv", "step_pwm-70.csv", "other.csv"):
        put(name, text)
    keys, (first,) = guessed(put("step_pwm40.csv", text))
    assert keys["input"]["value"] == {"step_pwm40.csv": 40.0, "step_pwm-70.csv": -70.0}
    assert first.columns["input"][0] == 40.0


def test_a_command_at_which_the_reading_comes_to_rest_is_a_goal(put):
    goal = np.repeat([20.0, -30.0, 55.0, 5.0, -60.0, 40.0, 10.0, -15.0], ROWS // 8)
    reading = np.concatenate([[0.0], goal[:-1]])
    for _ in range(3):
        reading = np.convolve(reading, np.ones(8) / 8)[:ROWS]
    keys, _ = guessed(put("servo.csv", lines("t,u,present_deg", T, goal, np.round(reading, 2))))
    assert keys["input"] == {"column": "u", "kind": "goal_position_deg"}


def test_a_joint_that_is_not_there_is_refused(put, refusal):
    table = put("log.csv", lines("t,pwm,hip_deg", T, U, DEG))
    assert "write `output: {column" in refusal(MappingError, guess_mapping, table, "knee")


def test_a_motor_that_never_moved_is_said_to_rest(put):
    rest = np.full(ROWS, 1.24)
    lacking = guess_mapping(
        put("dead_zone.csv", lines("Time(ms),Motor_Speed(RPM),Commanded_PWM", T, rest, U))
    ).lacking
    assert "Motor_Speed(RPM) never changes" in str(lacking)


def test_a_constant_command_stands_in_the_file_s_name(put):
    text = lines("", np.rint(DEG), T, sep="   ")
    keys, _ = guessed(put("data_for_voltage_-40_.txt", text))
    assert keys["input"] == {"value": -40.0, "kind": "power_pct"}
    lacking = guess_mapping(put("steps.txt", text)).lacking
    assert "write `input: {column: …, kind: power_pct}` or `input: {value: 60" in str(lacking)


@pytest.mark.parametrize(
    ("head", "columns", "part"),
    [("u,y_deg", (U, DEG), "write `time: {period_s"), ("t_ms,u", (1e3 * T, U[::-1]), "write `")],
)
def test_what_cannot_be_guessed_names_the_key_to_write(put, head, columns, part):
    assert part in str(guess_mapping(put("log.csv", lines(head, *columns))).lacking)


def test_columns_with_cells_that_are_no_numbers_are_named(put):
    text = lines("t,u,y_deg", T, U, DEG) + "Total,7,rows\n"
    said = str(guess_mapping(put("log.csv", text)).lacking)
    assert "its columns are u; cells that are no numbers are in t, y_deg" in said


@pytest.mark.parametrize(("largest", "kind"), [(80.0, "power_pct"), (9.0, "voltage_v")])
def test_a_command_named_u_is_a_voltage_only_where_one_could_be(put, largest, kind):
    keys, _ = guessed(put("log.csv", lines("t,u,y_deg", T, np.sign(U) * largest, DEG)))
    assert keys["input"]["kind"] == kind


def test_a_table_without_numbers_is_refused(put, refusal):
    assert "holds no column of numbers" in refusal(
        RecordingError, guess_mapping, put("x.csv", "a,b\nc,d\ne,f\n")
    )


def test_a_recording_needs_no_mapping_unless_its_counts_are_fractions(put):
    plain = put("run.csv", "time_s,a_power_pct,a_tacho_deg\n0,0,1\n0.1,0,2\n")
    assert is_recording(plain)
    fine = put("fine.csv", "time_s,a_power_pct,a_tacho_deg\n0,0,0.088\n0.1,0,0.176\n")
    assert not is_recording(fine)
    put("fine.yaml", "tacho_step_deg: 0.088")
    assert is_recording(fine)


def test_columns_in_one_line():
    mapping = mapping_of_words("time=ms:ms,power=pwm:0.5%,angle=ticks:0.088deg,supply=vbat:mV,split=run")
    assert mapping.time.unit == "ms"
    assert (mapping.input.column, mapping.input.gain) == ("pwm", 0.5)
    assert (mapping.output.kind, mapping.output.gain, mapping.output.step) == ("position_deg", 0.088, 0.088)
    assert mapping.supply.gain == 1e-3
    assert mapping.split.column == "run"
    constant = mapping_of_words("period=10ms,voltage=6,speed=w:rpm")
    assert (constant.time.period_s, constant.input.value) == (0.01, 6.0)
    assert constant.output.gain == pytest.approx(np.pi / 30)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("time=t,power=u", "write one of angle, position, speed"),
        ("time=t,angle=y", "write one of power, voltage"),
        ("power=u,angle=y", "write one of time, period"),
        ("tiem=t", "nearest: time"),
        ("time=t:h", "write one of s, ms"),
        ("power=u:kg", "write one of pct, %"),
        ("angle=y:0..1deg", "no unit"),
        ("time=t,time=s", "second time"),
        ("period=fast", "period=10ms"),
        ("time=t,torque=u,position=y", "does not drive"),
    ],
)
def test_a_wrong_word_names_what_to_write(refusal, text, part):
    assert part in refusal(MappingError, mapping_of_words, text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "time,power,angle\n" + "".join(f"{10 * i},{-50 if i % 9 else 50}%,{i * i}\n" for i in range(60)),
            "'50%'",
        ),
        ("time;power;angle\n" + "".join(f"{10 * i} ms;50 %;{i * i}°\n" for i in range(60)), "'0 ms'"),
    ],
)
def test_units_in_cells_are_told_with_their_place(put, text, told):
    lacking = guess_mapping(put("percent.csv", text)).lacking
    assert lacking is not None
    assert f"percent.csv, row 2: has a unit in a cell: {told}" in str(lacking)
    assert "into the column's name, such as power_pct" in str(lacking)


@pytest.mark.parametrize(("each", "told"), [(1, False), (2, True)])
def test_repeated_stamps_want_a_look(put, each, told):
    rows = "".join(f"{10 * (i // each)},{50 if i % 40 < 20 else -50},{i}\n" for i in range(200))
    guessed = guess_mapping(put("twice.csv", "time_ms,pwm,deg\n" + rows))
    why = {guess.key: guess.why for guess in guessed.guesses}["time"]
    assert ("50% of the rows repeat the stamp before" in why and "CHECK" in why) == told


def test_a_command_of_one_sign_under_which_the_angle_goes_both_ways_asks_for_its_sign(tmp_path):
    doubt = "has one sign, and y_deg goes both ways under it: CHECK for a lost sign"
    for size, said in ((np.abs(U), True), (U, False)):
        (tmp_path / "log.csv").write_text(lines("t,pwm,y_deg", T, size, DEG))
        why = next(guess.why for guess in guess_mapping(tmp_path / "log.csv").guesses if guess.key == "input")
        assert (doubt in why) is said
