"""A recording for programs that draw runs, read back by their own readers."""

import json

import numpy as np
import pytest

from nxt_twin.api.files import load_plant
from nxt_twin.api.prediction import simulate
from nxt_twin.cli.app import main
from nxt_twin.errors import NxtTwinError
from nxt_twin.export.mcap_run import write_mcap
from nxt_twin.export.run import drawn_run
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import mapping_of
from nxt_twin.recording.recording import Recording
from nxt_twin.view.dashboard.drawing.run_file import write_rrd

SPELL = {"recording": "run.csv", "start_s": 0.5, "end_s": 0.9, "strength": 12.4}
DIAGNOSIS = {"verdict": "explained", "sentence": "A load.", "mismatch": {"when": [SPELL]}}


@pytest.fixture(scope="module")
def recording():
    """Stamps that do not begin at zero, and a battery that is read now and then."""
    time_s = 5.0 + np.arange(0.0, 2.0, 0.02)
    power = np.where(time_s < 6.0, 60.0, -40.0)
    run = simulate(load_plant("nxt_motor"), Recording("run.csv", {"time_s": time_s, "a_power_pct": power}))
    battery = np.where(np.arange(time_s.size) % 10 == 0, 8.1, np.nan)
    return Recording("run.csv", {**run.columns, "battery_v": battery})


@pytest.fixture(scope="module")
def run(recording):
    predicted = {"a_tacho_deg": recording.columns["a_tacho_deg"] + 3.0}
    return drawn_run(recording, predicted, DIAGNOSIS)


def test_a_bag_holds_each_curve_and_our_own_reader_takes_it_back(recording, run, tmp_path):
    pytest.importorskip("mcap_ros2")
    path = tmp_path / "run.mcap"
    write_mcap(run, path)
    for column, scale in (("joint_states.a.position", 1.0), ("predicted.a_tacho_deg.data", np.pi / 180.0)):
        kind = "position_rad" if scale == 1.0 else "position_deg"
        keys = {
            "table": {"format": "mcap"},
            "time": {"column": "logged_s"},
            "input": {"column": "measured.a_power_pct.data", "kind": "power_pct"},
            "output": {"column": column, "kind": kind},
        }
        back = read_mapped(path, mapping_of(keys, "test"))
        seen = np.isfinite(back.columns["output"])
        off = 0.0 if kind == "position_rad" else np.radians(3.0)
        expected = np.radians(recording.columns["a_tacho_deg"]) + off
        np.testing.assert_allclose(back.columns["output"][seen], expected, atol=1e-9)
        np.testing.assert_allclose(back.time_s[seen], recording.time_s, atol=1e-8)


def test_a_bag_tells_the_diagnosis_at_its_times(run, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    path = tmp_path / "run.mcap"
    write_mcap(run, path)
    with path.open("rb") as file:
        bag = reader.make_reader(file, decoder_factories=[decoder.DecoderFactory()])
        told = [
            (m.log_time / 1e9, text.data) for _, _, m, text in bag.iter_decoded_messages(topics=["/remarks"])
        ]
    assert told[0] == (5.0, "explained: A load.")
    assert told[1] == (5.5, "departs from the baseline by 12.4 sigma until 0.90 s")


def test_rerun_opens_the_file_and_finds_each_value(recording, run, tmp_path):
    chunk = pytest.importorskip("rerun.chunk")
    path = tmp_path / "run.rrd"
    write_rrd(run, path)
    found = {}
    for each in chunk.RrdReader(path).stream().to_chunks():
        batch = each.to_record_batch()
        if "time" in batch.schema.names:
            found[str(each.entity_path)] = batch
    assert set(found) == {
        *("/a_power_pct/measured", "/a_tacho_deg/measured", "/a_tacho_deg/predicted"),
        *("/battery_v/measured", "/remarks"),
    }
    batch = found["/a_tacho_deg/predicted"]
    values = next(batch.column(name) for name in batch.schema.names if name.endswith("scalars"))
    times = 1e-9 * np.array(batch.column("time").cast("int64").to_pylist())
    np.testing.assert_allclose(np.ravel(values.to_pylist()), recording.columns["a_tacho_deg"] + 3.0)
    np.testing.assert_allclose(times, recording.time_s, atol=1e-8)
    assert found["/battery_v/measured"].num_rows == 10


def test_what_is_no_diagnosis_is_refused(recording):
    with pytest.raises(NxtTwinError, match="--diagnosis: is no diagnosis"):
        drawn_run(recording, {}, {"verdict": "adequate"})


def test_the_command_writes_a_recording_with_what_a_plant_predicts(recording, tmp_path, monkeypatch):
    reader = pytest.importorskip("mcap.reader")
    write_recording(recording, tmp_path / "run.csv")
    (tmp_path / "d.json").write_text(json.dumps(DIAGNOSIS), encoding="utf-8")
    given = ["export", tmp_path / "run.csv", "--to", "mcap", "--out", tmp_path / "run.mcap"]
    options = ["--plant", "nxt_motor", "--diagnosis", tmp_path / "d.json"]
    monkeypatch.setattr("sys.argv", ["nxt-twin", *map(str, [*given, *options])])
    with pytest.raises(SystemExit) as leaving:
        main()
    assert not leaving.value.code
    with (tmp_path / "run.mcap").open("rb") as file:
        topics = {channel.topic for channel in reader.make_reader(file).get_summary().channels.values()}
    assert topics >= {"/measured/a_tacho_deg", "/predicted/a_tacho_deg", "/joint_states", "/remarks"}
