"""What a camera sees of a world."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
import yaml
from PIL import Image
from typer.testing import CliRunner

from nxt_twin.cli.app import program
from nxt_twin.diagnose.robot.engine import robot_of
from nxt_twin.errors import PlantError
from nxt_twin.mock.errors import WorldError
from nxt_twin.recording.case import read_as_case
from nxt_twin.world.arena import open_arena
from nxt_twin.world.film import Camera, Film, View, refuse_unknown
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import let_pass


def test_a_picture_shows_prints_where_they_are(tmp_path):
    scene = {
        "floor": {"size_mm": [600, 600], "prints": [{"patch_mm": [[100, 150], [250, 280]], "shade": 0.0}]}
    }
    path = tmp_path / "world.yaml"
    robot = {
        "name": "post",
        "fixed": True,
        "parts": [{"box_mm": [1, 1, 1], "at_mm": [-200, -200, 0], "mass_g": 1}],
    }
    wheel = {"port": "a", "at_mm": [-200, -200, 5], "radius_mm": 2, "width_mm": 2}
    path.write_text(yaml.safe_dump({"robot": {**robot, "wheels": {"w": wheel}}, "scene": scene}))
    above = View(distance_m=0.9, yaw_deg=0.0, pitch_deg=-89.9, size=(80, 80))
    picture = Camera(open_arena(load_setting(path)), above).picture(np.zeros(3))
    dark = np.argwhere(np.asarray(picture).mean(axis=2) < 60)
    row, column = dark.mean(axis=0)
    half_m = 0.9 * np.tan(np.radians(22.5))  # from the picture's middle to its edge, about
    assert (column - 39.5) / 40 * half_m == pytest.approx(0.175, abs=0.03)
    assert (39.5 - row) / 40 * half_m == pytest.approx(0.215, abs=0.03)


def test_a_film_has_a_picture_for_each_tenth_of_a_second(tmp_path):
    film = tmp_path / "film.gif"
    result = CliRunner().invoke(
        program(["world", "mock"]), ["world", "playground", "--seconds", "0.3", "--film", str(film)]
    )
    assert result.exit_code == 0
    with Image.open(film) as shown:
        assert getattr(shown, "n_frames", 1) >= 1
        assert shown.size == (480, 320)


def test_an_mp4_shows_the_run_in_twenty_pictures_a_second(tmp_path):
    av = pytest.importorskip("av")
    path = tmp_path / "film.mp4"
    arena = open_arena(load_setting("playground"))
    film = Film(arena, View(size=(96, 64)), per_second=20)
    arena.body.set_motor(1, 100, brake=True)
    let_pass(arena, 0.5)
    film.write(path)
    with av.open(str(path)) as shown:
        stream = shown.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24").astype(float) for frame in shown.decode(stream)]
        assert stream.codec_context.name in ("h264", "mpeg4")
        assert float(stream.average_rate) == 20.0
    assert len(pictures) == 10
    drawn = np.asarray(next(film.pictures()), dtype=float)
    assert np.abs(pictures[0] - drawn).mean() < 12.0
    assert np.abs(pictures[0] - pictures[-1]).mean() > 1.0


def test_without_pyav_an_mp4_is_refused_before_the_run(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(WorldError, match=r"pip install 'nxt-twin\[film\]'"):
        refuse_unknown(tmp_path / "film.mp4")


def test_a_film_of_an_unknown_kind_is_refused(tmp_path):
    arena = open_arena(load_setting("playground"))
    with pytest.raises(WorldError, match=r"\.gif"):
        Film(arena).write(tmp_path / "film.avi")


def test_a_view_holds_bodies_floor_echoes_and_the_ghost_that_parts_from_a_changed_robot(tmp_path):
    pytest.importorskip("rerun")
    world, script = tmp_path / "world.yaml", tmp_path / "on.py"
    world.write_text("robot: {like: tribot, wheels: {right: {radius_mm: 27}}}")
    script.write_text(
        "import time, nxt.locator, nxt.motor\n"
        "with nxt.locator.find() as brick:\n"
        "    for port in (nxt.motor.Port.B, nxt.motor.Port.C):\n"
        "        brick.get_motor(port).run(40)\n"
        "    time.sleep(1.5)\n"
    )
    view, told = tmp_path / "run.rrd", tmp_path / "told.json"
    arguments = [
        "world",
        str(world),
        "--program",
        str(script),
        "--ghost",
        "castor_bot",
        "--trace",
        str(tmp_path / "drive.csv"),
    ]
    result = CliRunner().invoke(
        program(["world", "mock"]), [*arguments, "--save", str(view), "--json", str(told)]
    )
    assert result.exit_code == 0
    assert view.stat().st_size > 10_000
    found = json.loads(told.read_text())
    gone_m = found["robot"]["path_m"]
    turned_deg = np.degrees(
        (27.0 - 28.0) / 103.0 * gone_m / 27.5e-3
    )  # what the smaller right wheel makes of the way
    assert found["robot"]["heading_deg"] == pytest.approx(turned_deg, rel=0.1)
    assert abs(found["ghost"]["heading_deg"]) < 2.0
    assert found["ghost"]["apart_mm"] > 10.0
    assert robot_of(read_as_case(tmp_path / "drive.csv")).geometry.track_m == 0.103


def test_a_ghost_that_is_no_robot_is_refused():
    result = CliRunner().invoke(program(["world", "mock"]), ["world", "playground", "--ghost", "nxt_motr"])
    assert isinstance(result.exception, PlantError)
    assert "nxt_motor" in str(result.exception)
