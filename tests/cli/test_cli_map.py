"""`map`, `--mapping` and `--columns` from end to end."""

import json

import numpy as np
from typer.testing import CliRunner

from nxt_twin.cli.app import program

COMMANDS = program(["map", "simulate"])


def run(*arguments):
    return CliRunner().invoke(COMMANDS, [str(each) for each in arguments])


def test_a_stranger_s_table_is_mapped_and_then_simulated(tmp_path):
    time_s = 0.01 * np.arange(200)
    rows = "".join(f"{1000 * t:.0f};40;{200 * t:.1f}\n".replace(".", ",") for t in time_s)
    (tmp_path / "log.csv").write_text("millis;pwm [%];angle [deg]\n" + rows)
    found = run("map", tmp_path / "log.csv", "--out", tmp_path / "log.yaml")
    assert found.exit_code == 0
    assert "input: {column: 'pwm [%]', kind: power_pct}" in found.output
    told = json.loads(run("map", tmp_path / "log.csv", "--json", "-").stdout)
    assert told["mapping"]["time"] == {"column": "millis", "unit": "ms"}
    mapped = run("simulate", "nxt_motor", tmp_path / "log.csv", "--mapping", tmp_path / "log.yaml")
    assert "199 readings" in mapped.output
    words = "time=millis:ms,power=pwm [%],angle=angle [deg]"
    assert run("simulate", "nxt_motor", tmp_path / "log.csv", "--columns", words).output == mapped.output
    both = run(
        "simulate", "nxt_motor", tmp_path / "log.csv", "--columns", words, "--mapping", tmp_path / "log.yaml"
    )
    assert both.exit_code == 2


def test_what_cannot_be_guessed_is_refused_after_what_can(tmp_path):
    (tmp_path / "log.csv").write_text("millis,angle_deg\n" + "".join(f"{10 * n},{n}\n" for n in range(20)))
    found = run("map", tmp_path / "log.csv", "--out", tmp_path / "log.yaml")
    assert found.exit_code == 1
    assert "time: {column: millis, unit: ms}" in found.output
    assert "write `input: {column" in str(found.exception)
    assert not (tmp_path / "log.yaml").exists()


def test_a_recording_is_told_to_need_no_mapping(tmp_path):
    (tmp_path / "run.csv").write_text("time_s,a_power_pct,a_tacho_deg\n0,0,1\n0.1,0,2\n")
    assert "needs no mapping\n" in run("map", tmp_path / "run.csv").output
    told = run("map", tmp_path / "run.csv", "--out", tmp_path / "run.yaml").output
    assert (
        f"{tmp_path / 'run.yaml'} is not written\n# now: nxt-twin diagnose {tmp_path / 'run.csv'}\n" in told
    )
    assert not (tmp_path / "run.yaml").exists()
