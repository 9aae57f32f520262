"""Cases: folders, single recordings, ports, mappings and refusals."""

import numpy as np
import pytest

from nxt_twin.errors import CaseError, MappingError, PlantError, RecordingError
from nxt_twin.recording.case import read_as_case, read_case

ONE_MOTOR = "time_s,a_power_pct,a_tacho_deg\n0,50,0\n0.1,50,3\n"
TWO_MOTORS = "time_s,a_power_pct,a_tacho_deg,c_power_pct,c_tacho_deg\n0,50,0,10,0\n0.1,50,3,10,1\n"
FOREIGN = "t,u,y\n0,1,0.5\n1,2,0.25\n"
MAPPING = """
time: {column: t}
input: {column: u, kind: torque_nm}
output: {column: y, kind: position_rad}
"""


def test_reads_a_case_with_an_inline_plant_and_holdout(put):
    put("one/r1.csv", ONE_MOTOR)
    put("one/more/r2.csv", ONE_MOTOR)
    plant = "plant:\n  kind: dc_motor\n  resistance_ohm: 7.6\n"
    path = put("one/case.yaml", plant + "recordings: [r1.csv]\nholdout: [more/r2.csv]\n")
    case = read_case(path.parent)
    assert case.name == "one"
    assert case.folder == path.parent
    assert case.plant == {"kind": "dc_motor", "resistance_ohm": 7.6}
    assert [recording.name for recording in case.recordings] == ["r1.csv"]
    assert [recording.name for recording in case.holdout] == ["more/r2.csv"]
    assert case.port == "a"
    assert read_as_case(path.parent).plant == read_as_case(path).plant == case.plant


def test_a_plant_may_be_named_or_lie_in_the_case(put):
    put("one/r1.csv", ONE_MOTOR)
    put("one/mine.yaml", "kind: dc_motor\n")
    path = put("one/case.yaml", "plant: nxt_motor\nrecordings: [r1.csv]\n")
    assert read_case(path.parent).plant == "nxt_motor"
    put("one/case.yaml", "plant: mine.yaml\nrecordings: [r1.csv]\n")
    assert read_case(path.parent).plant == str(path.parent / "mine.yaml")


def test_a_mapping_brings_in_all_recordings_and_leaves_no_port(put):
    put("one/r1.csv", FOREIGN)
    put("one/map.yaml", MAPPING)
    path = put("one/case.yaml", "plant: {kind: rigid_body}\nmapping: map.yaml\nrecordings: [r1.csv]\n")
    case = read_case(path.parent)
    assert case.port is None
    assert case.recordings[0].kinds is not None
    np.testing.assert_array_equal(case.recordings[0].columns["output"], [0.5, 0.25])


def test_a_sensor_case_has_no_port(put):
    put("one/r1.csv", "time_s,s4_ultrasonic_cm,rig_distance_mm\n0,30,300\n1,31,310\n")
    path = put("one/case.yaml", "plant: {kind: ultrasonic_sensor}\nrecordings: [r1.csv]\n")
    assert read_case(path.parent).port is None


def test_the_named_port_is_taken(put):
    put("one/r1.csv", TWO_MOTORS)
    path = put("one/case.yaml", "plant: nxt_motor\nport: c\nrecordings: [r1.csv]\n")
    assert read_case(path.parent).port == "c"


def test_a_tacho_that_was_never_sampled_is_no_motor(put):
    text = "time_s,a_power_pct,a_tacho_deg,b_power_pct,b_tacho_deg\n0,50,,10,0\n0.1,50,,10,1\n"
    assert read_as_case(put("r1.csv", text)).port == "b"


def test_a_single_recording_is_a_case_of_an_nxt_motor_unless_its_sidecar_names_another(put):
    path = put("r1.csv", ONE_MOTOR)
    case = read_as_case(path)
    assert (case.name, case.folder, case.plant, case.port) == ("r1", path.parent, "nxt_motor", "a")
    assert case.recordings[0].name == "r1.csv"
    assert case.holdout == ()
    put("r1.yaml", "plant: mine.yaml\n")
    put("mine.yaml", "plant: {kind: dc_motor}\n")
    assert read_as_case(path).plant == str(path.parent / "mine.yaml")


def test_a_single_recording_from_elsewhere_names_its_mapping_in_the_sidecar(put):
    path = put("r1.dat", FOREIGN)
    put("map.yaml", MAPPING)
    put("r1.yaml", "plant: {kind: rigid_body, inertia: 1}\nmapping: map.yaml\n")
    case = read_as_case(path)
    assert case.plant == {"kind": "rigid_body", "inertia": 1}
    assert case.recordings[0].kinds is not None


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (TWO_MOTORS, "ports a, c have both power and tacho (name one as `port:` in case.yaml)"),
        ("time_s,a_power_pct,c_tacho_deg\n0,50,0\n0.1,50,3\n", "no port has both power and tacho"),
    ],
)
def test_refuses_to_guess_the_port(put, refusal, text, part):
    assert part in refusal(CaseError, read_as_case, put("r1.csv", text))


def test_refuses_a_port_without_a_motor_in_every_recording(put, refusal):
    put("one/r1.csv", TWO_MOTORS)
    put("one/r2.csv", ONE_MOTOR)
    path = put("one/case.yaml", "plant: nxt_motor\nport: c\nrecordings: [r1.csv, r2.csv]\n")
    line = refusal(CaseError, read_case, path.parent)
    assert "port c lacks c_power_pct and c_tacho_deg" in line
    assert "every recording: a" in line


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("recordings: [r1.csv]\n", ["key plant", "is missing"]),
        ("plant: nxt_motor\n", ["key recordings", "is missing"]),
        ("plant: nxt_motor\nrecording: [r1.csv]\n", ["key recording:", "nearest known: recordings"]),
        ("plant: nxt_motor\nrecordings: []\n", ["key recordings", "lists no recording"]),
        ("plant: nxt_motor\nrecordings: r1.csv\n", ["key recordings", "list"]),
        (
            "plant: nxt_motor\nrecordings: [r1.csv]\nhold_out: []\n",
            ["key hold_out", "nearest known: holdout"],
        ),
        ("plant: nxt_motor\nrecordings: [r1.csv]\nport: d\n", ["key port", "'d'", "'a', 'b' or 'c'"]),
        (
            "plant: nxt_motor\nrecordings: [r1.csv]\nholdout: [r1.csv]\n",
            ["lists no recording that is not held out"],
        ),
        ("plant: nxt_motor\nrecordings: [r1.csv, r1.csv]\n", ["lists r1.csv twice"]),
        ("plant: nxt_motor\nrecordings: [r1.csv]\nbefore: [r1.csv]\n", ["lists r1.csv twice"]),
        ("plant: nxt_motor\nrecordings: [r1.csv, ./r1.csv]\n", ["lists r1.csv twice"]),
        (
            "plant: nxt_motor\nrecordings: [./r1.csv]\nholdout: [a/../r1.csv]\n",
            ["lists no recording that is not held out"],
        ),
        ("plant: nxt_motor\nrecordings: [r1.csv]\nholdout: [r2.csv, r2.csv]\n", ["lists r2.csv twice"]),
        (
            "plant: nxt_motor\nrecordings: [r1.csv]\nholdout: [r2.csv]\nbefore: [r2.csv]\n",
            ["lists r2.csv twice"],
        ),
        ("plant: 5\nrecordings: [r1.csv]\n", ["key plant"]),
        ("plant: {kind: dc_motor\nrecordings: [r1.csv]\n", ["line 2"]),
        ("", ["is empty"]),
    ],
)
def test_refuses_a_wrong_case_file(put, refusal, text, parts):
    put("one/r1.csv", ONE_MOTOR)
    path = put("one/case.yaml", text)
    line = refusal(CaseError, read_case, path.parent)
    for part in ["case.yaml", *parts]:
        assert part in line


@pytest.mark.parametrize("held_out", ["r2.csv", "./r2.csv"])
def test_a_recording_that_is_listed_and_held_out_is_not_fitted(put, held_out):
    for name in ("r1.csv", "r2.csv", "r3.csv"):
        put(f"one/{name}", ONE_MOTOR)
    path = put(
        "one/case.yaml", f"plant: nxt_motor\nrecordings: [r1.csv, r2.csv, r3.csv]\nholdout: [{held_out}]\n"
    )
    case = read_case(path.parent)
    assert [one.name for one in case.recordings] == ["r1.csv", "r3.csv"]
    assert [one.name for one in case.holdout] == [held_out]


def test_refuses_what_is_no_case_folder(put, tmp_path, refusal):
    file = put("r1.csv", ONE_MOTOR)
    assert "is a file where a case folder is expected" in refusal(CaseError, read_case, file)
    assert "no such folder" in refusal(CaseError, read_case, tmp_path / "none")
    (tmp_path / "bare").mkdir()
    assert "case.yaml: there is no such file" in refusal(CaseError, read_as_case, tmp_path / "bare")
    assert "no such file" in refusal(RecordingError, read_as_case, tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("text", "error", "part"),
    [
        ("plant: nxt_motor\nrecordings: [none.csv]\n", RecordingError, "none.csv: there is no such file"),
        ("plant: nxt_moter\nrecordings: [r1.csv]\n", PlantError, "nearest known: nxt_motor"),
        ("plant: none.yaml\nrecordings: [r1.csv]\n", PlantError, "none.yaml: there is no such file"),
        (
            "plant: nxt_motor\nmapping: m.yaml\nrecordings: [r1.csv]\n",
            MappingError,
            "m.yaml: there is no such",
        ),
    ],
)
def test_refuses_files_that_the_case_names_but_lacks(put, refusal, text, error, part):
    put("one/r1.csv", ONE_MOTOR)
    path = put("one/case.yaml", text)
    assert part in refusal(error, read_case, path.parent)
