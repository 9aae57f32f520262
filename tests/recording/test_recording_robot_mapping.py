"""Tables of robots on two wheels: roles, units, signs, refusals, and what `map` guesses."""

import re
from math import pi

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.errors import CaseError, MappingError, RecordingError
from nxt_twin.recording.any_mapping import any_mapping_of, read_any_mapping
from nxt_twin.recording.case import read_as_case
from nxt_twin.recording.column_words import mapping_of_words
from nxt_twin.recording.guess.guess import guess_mapping
from nxt_twin.recording.mapped import read_all_mapped, read_mapped

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
ANGLES = {"deg": 1.0, "rad": 180.0 / pi, "turn": 360.0}
PLANT = {
    "kind": "differential_drive",
    "left": "b",
    "right": "c",
    "left_wheel_radius_m": 0.03,
    "right_wheel_radius_m": 0.03,
    "track_m": 0.12,
}
KEYS = {
    "time": {"column": "t", "unit": "ms"},
    "pose_x": {"column": "px", "unit": "mm"},
    "pose_y": {"column": "py", "unit": "mm"},
    "pose_heading": {"column": "th", "unit": "rad"},
    "left_angle": {"column": "el", "unit": "deg", "gain": 0.5},
    "right_angle": {"column": "er", "unit": "deg", "gain": 0.5},
}
TABLE = "t,px,py,th,el,er\n0,1000,0,3.1,0,0\n50,990,5,-3.1,10,-20\n100,980,,-3.0,20,-40\n"


def _drive():
    """A square both ways round and two arcs: x, y, heading and wheels' angles, in m and rad."""
    legs = [(20, 8, 8), (10, 4, -4)] * 4 + [(20, 8, 8), (10, -4, 4)] * 4 + [(40, 7, 9), (40, 9, 7)]
    x, y, heading, left, right, rows = 0.4, -0.2, 0.5, 0.0, 0.0, []
    for steps, to_left, to_right in legs:
        for _ in range(steps):
            rows.append((x, y, heading, left, right))
            turned = 0.03 * 0.1 * (to_right - to_left) / 0.12
            x += 0.03 * 0.05 * (to_left + to_right) * np.cos(heading + turned / 2)
            y += 0.03 * 0.05 * (to_left + to_right) * np.sin(heading + turned / 2)
            heading, left, right = heading + turned, left + 0.1 * to_left, right + 0.1 * to_right
    return np.array(rows).T


def _written(put, names, *columns):
    rows = zip(0.1 * np.arange(columns[0].size), *columns, strict=True)
    lines = [",".join(f"{value:.10g}" for value in row) for row in rows]
    return put("run.csv", "\n".join([names, *lines]) + "\n")


def _guessed(table):
    found = guess_mapping(table)
    assert found.lacking is None
    return read_mapped(table, any_mapping_of(found.keys, "guess")), found


def test_a_mapping_file_gives_the_columns_of_a_brick(put):
    table, mapping = put("run.csv", TABLE), read_any_mapping(put("m.yaml", yaml.safe_dump(KEYS)))
    found = read_mapped(table, mapping)
    assert set(found.columns) == {
        "time_s",
        "b_tacho_deg",
        "c_tacho_deg",
        "pose_x_m",
        "pose_y_m",
        "pose_heading_deg",
    }
    np.testing.assert_allclose(found.time_s, [0, 0.05, 0.1])
    np.testing.assert_allclose(found.columns["pose_x_m"], [1.0, 0.99, 0.98])
    np.testing.assert_allclose(found.columns["pose_y_m"], [0.0, 0.005, np.nan])
    np.testing.assert_allclose(found.columns["b_tacho_deg"], [0, 5, 10])
    np.testing.assert_allclose(found.columns["c_tacho_deg"], [0, -10, -20])
    np.testing.assert_allclose(
        found.columns["pose_heading_deg"], np.degrees([3.1, 2 * pi - 3.1, 2 * pi - 3.0])
    )
    assert found.tacho_step_deg == {"b": 0.5, "c": 0.5}


@given(
    length=st.sampled_from(sorted(LENGTHS)),
    turning=st.sampled_from(sorted(ANGLES)),
    wheel=st.sampled_from(sorted(ANGLES)),
    gain=st.floats(0.01, 10.0),
    offset=st.floats(-5.0, 5.0),
)
def test_units_gains_and_offsets_give_one_motion(tmp_path_factory, length, turning, wheel, gain, offset):
    """Whatever the unit, gain and offset in which a table is written, it is read as one motion."""
    x, y, heading, left, right = (each[::10] for each in _drive())
    table = tmp_path_factory.mktemp("units") / "run.csv"

    def write(name, values, unit, size):
        keys = {"column": name, "unit": unit, "gain": gain, "offset": offset}
        return keys, (values / size - offset) / gain

    written = {
        "pose_x": write("x", x, length, LENGTHS[length]),
        "pose_y": write("y", y, length, LENGTHS[length]),
        "pose_heading": write("h", np.degrees(heading), turning, ANGLES[turning]),
        "left_angle": write("l", np.degrees(left), wheel, ANGLES[wheel]),
        "right_angle": write("r", np.degrees(right), wheel, ANGLES[wheel]),
    }
    columns = [values for _, values in written.values()]
    _written(lambda _name, text: table.write_text(text), "t,x,y,h,l,r", *columns)
    keys = {"time": {"column": "t"}} | {key: own for key, (own, _) in written.items()}
    found = read_mapped(table, any_mapping_of(keys, "test")).columns
    np.testing.assert_allclose(found["pose_x_m"], x, atol=1e-6)
    np.testing.assert_allclose(found["pose_y_m"], y, atol=1e-6)
    np.testing.assert_allclose(found["pose_heading_deg"], np.degrees(heading), atol=1e-4)
    np.testing.assert_allclose(found["b_tacho_deg"], np.degrees(left), atol=1e-3)
    np.testing.assert_allclose(found["c_tacho_deg"], np.degrees(right), atol=1e-3)


def test_powers_supply_and_split(put):
    table = put("run.csv", "t,px,py,th,el,er,l,r,mv,run\n" + "".join(
        f"{50 * i},{i},0,0,{i},{i},{255 if i == 1 else ''},-51,7900,{1 + i // 3}\n" for i in range(6)
    ))  # fmt: skip
    keys = KEYS | {
        "left_power": {"column": "l", "gain": 100 / 255},
        "right_power": {"column": "r", "gain": 100 / 255},
        "supply": {"column": "mv", "gain": 0.001},
        "split": {"column": "run"},
    }
    first, second = read_all_mapped(table, any_mapping_of(keys, "test"))
    assert (first.name, second.name) == ("run.csv#1", "run.csv#2")
    np.testing.assert_allclose(first.columns["b_power_pct"], [0, 100, 100])
    np.testing.assert_allclose(first.columns["c_power_pct"], [-20, -20, -20])
    np.testing.assert_allclose(first.columns["battery_v"], 7.9)


def test_words_state_a_robot(put):
    words = "time=t:ms,x=px:mm,y=py:mm,heading=th:rad,left_angle=el:0.5deg,right_angle=er:0.5deg"
    by_words = read_mapped(put("run.csv", TABLE), mapping_of_words(words))
    by_keys = read_mapped(put("run.csv", TABLE), any_mapping_of(KEYS, "test"))
    for name, values in by_keys.columns.items():
        np.testing.assert_allclose(by_words.columns[name], values)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("time=t,x=px:mm,y=py:mm", "names no pose_heading .write heading"),
        ("time=t,x=px:inch", "'inch' is no unit of x .write one of m, mm, cm"),
        ("x=px,y=py,heading=th,left_angle=el,right_angle=er", "names no time"),
        ("time=t,x=px,y=py,heading=th,left_angle=el,right_angle=er,power=u", "a robot's pose and a motor's input"),
        ("time=t,x=px,y=py,heading=th,left_angle=el,right_angle=er,left_power=u", "write right_power too"),
        ("time=ms:c1,power=u,angle=a", "'c1' is no unit of time .write time=c1:ms, the column first"),
        ("time=t,x=mm:px,y=py", "write x=px:mm, the column first"),
    ],
)  # fmt: skip
def test_words_that_leave_something_out_are_refused(words, told):
    with pytest.raises(MappingError, match=told):
        mapping_of_words(words)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            {"pose_x": {"column": "nope"}},
            "mapping key pose_x: has no column 'nope' .write `pose_x: {column: …}`",
        ),
        ({"left_power": {"column": "el"}}, "names one power alone; write right_power too"),
        ({"pose_y": {"column": "py", "unit": "inch"}}, "pose_y.unit: 'inch' is not known"),
        ({"input": {"column": "u", "kind": "power_pct"}}, "key input: unknown key"),
    ],
)
def test_a_wrong_mapping_is_refused_by_its_key(put, changed, told):
    with pytest.raises(MappingError, match=told):
        read_mapped(put("run.csv", TABLE), any_mapping_of(KEYS | changed, "m.yaml"))


def test_a_key_left_out_is_named():
    keys = {key: value for key, value in KEYS.items() if key != "pose_heading"}
    with pytest.raises(MappingError, match="key pose_heading: is missing"):
        any_mapping_of(keys, "m.yaml")


def test_an_empty_column_is_refused_by_its_key(put):
    table = put("run.csv", "t,px,py,th,el,er\n0,1,1,,0,0\n50,2,1,,1,1\n")
    with pytest.raises(RecordingError, match=r"column th: is empty .*`pose_heading: \{column: …\}`"):
        read_mapped(table, any_mapping_of(KEYS, "test"))


def test_powers_beyond_a_hundred_percent_are_refused(put):
    table = put("run.csv", "t,px,py,th,el,er\n0,1,1,0,0,0\n50,2,1,0,255,1\n")
    keys = KEYS | {"left_power": {"column": "el"}, "right_power": {"column": "er"}}
    with pytest.raises(RecordingError, match="column el: 255 is outside -100 to 100"):
        read_mapped(table, any_mapping_of(keys, "test"))


def test_a_case_of_one_table_takes_plant_and_mapping_from_its_sidecar(put):
    table = put("run.csv", TABLE)
    put("run.yaml", yaml.safe_dump(KEYS))
    with pytest.raises(
        CaseError, match=r"its plant is of one motor .write `plant: \{kind: differential_drive"
    ):
        read_as_case(table)
    put("run.yaml", yaml.safe_dump(KEYS | {"plant": PLANT}))
    case = read_as_case(table)
    assert case.port is None
    assert "pose_x_m" in case.recordings[0].columns


def test_map_guesses_a_robot_by_names_and_units(put):
    x, y, heading, left, right = _drive()
    names = "t_s,x_mm,y_mm,theta_rad,left_wheel_deg,right_wheel_deg"
    table = _written(put, names, 1e3 * x, 1e3 * y, heading, np.degrees(left), np.degrees(right))
    found, guess = _guessed(table)
    assert not any("CHECK" in each.why for each in guess.guesses)
    np.testing.assert_allclose(found.columns["pose_x_m"], x, atol=1e-6)
    np.testing.assert_allclose(found.columns["pose_heading_deg"], np.degrees(heading), atol=1e-6)
    np.testing.assert_allclose(found.columns["c_tacho_deg"], np.degrees(right), atol=1e-6)


def test_map_finds_a_compass_heading_in_degrees(put):
    x, y, heading, left, right = _drive()
    compass = -np.degrees(heading) % 360.0
    table = _written(put, "t,x,y,heading,enc_l,enc_r", x, y, compass, left, right)
    found, _ = _guessed(table)
    turned = found.columns["pose_heading_deg"]
    np.testing.assert_allclose(turned - turned[0], np.degrees(heading - heading[0]), atol=1e-6)
    np.testing.assert_allclose(found.columns["b_tacho_deg"], np.degrees(left), atol=1e-6)


def test_map_finds_mirrored_axes_and_a_mirrored_encoder(put):
    x, y, heading, left, right = _drive()
    ticks = [np.round(960 * side / (2 * pi)) for side in (-left, right)]
    table = _written(put, "t,gt_x,gt_y,gt_yaw,odom_x,left_ticks,right_ticks", x, -y, -heading, 0 * x, *ticks)
    found, guess = _guessed(table)
    np.testing.assert_allclose(found.columns["pose_y_m"], y, atol=1e-9)
    np.testing.assert_allclose(found.columns["pose_heading_deg"], np.degrees(heading), atol=1e-6)
    np.testing.assert_allclose(found.columns["b_tacho_deg"], -ticks[0])
    why = {each.key: each.why for each in guess.guesses}["right_angle"]
    travel = float(re.search(r"travels (\S+) m", why)[1])
    assert travel == pytest.approx(0.03 * 2 * pi / 960, rel=0.02)


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ("t,x,y,left_deg,right_deg", "write `pose_heading: {column: …, unit: deg}`"),
        ("t,x,y,theta,left_deg", "write `right_angle: {column: …, unit: deg}`"),
        ("t,x,y,orientation.z,left_deg,right_deg", "yaw, 2·atan2.z, w. of the quaternion"),
    ],
)
def test_map_names_the_key_that_a_robot_table_lacks(put, names, told):
    by_name = dict(zip(("x", "y", "theta", "left_deg", "right_deg"), _drive(), strict=True))
    columns = [by_name.get(name, np.sin(by_name["theta"] / 2)) for name in names.split(",")[1:]]
    found = guess_mapping(_written(put, names, *columns))
    assert found.lacking is not None
    assert "looks like a robot's table" in str(found.lacking)
    assert re.search(told, str(found.lacking))


def test_a_plant_in_a_mapping_file_is_told_where_it_belongs(put):
    with pytest.raises(
        MappingError, match=r"key plant: a mapping names no plant .*NAME.yaml beside the table"
    ):
        read_any_mapping(put("m.yaml", yaml.safe_dump(KEYS | {"plant": PLANT})))
