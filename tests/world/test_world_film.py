"""What a camera sees of a world."""

from __future__ import annotations

import numpy as np
import pytest
import yaml
from PIL import Image
from typer.testing import CliRunner

from nxt_twin.cli.app import program
from nxt_twin.mock.errors import WorldError
from nxt_twin.world.arena import open_arena
from nxt_twin.world.film import Camera, Film, View
from nxt_twin.world.load import load_setting


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


def test_a_film_of_an_unknown_kind_is_refused(tmp_path):
    arena = open_arena(load_setting("playground"))
    with pytest.raises(WorldError, match=r"\.gif"):
        Film(arena).write(tmp_path / "film.mp4")
