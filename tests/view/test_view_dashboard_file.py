"""What is in the `.rrd` file, read back value by value."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest
from view_ticks import CHANNELS, PORTS, in_order, some_events, some_ticks

from nxt_twin.arrays import FloatArray
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.records import Event
from nxt_twin.view.dashboard import open_dashboard
from nxt_twin.view.dashboard.drawing import colours
from nxt_twin.view.dashboard.drawing.layout import blueprint
from nxt_twin.view.dashboard.drawing.painter import Painter
from nxt_twin.view.dashboard.scene import DrawnShape, Scenery, WorldMoment
from nxt_twin.view.dashboard.wire import Message, line_of
from nxt_twin.view.dashboard.worker import draw

chunk = pytest.importorskip("rerun.chunk")

_COUNT = 200
_CONTAINERS = ("Horizontal", "Vertical", "Grid", "Tabs")


@pytest.fixture(scope="module")
def batches(tmp_path_factory: pytest.TempPathFactory):
    path = tmp_path_factory.mktemp("dashboard") / "run.rrd"
    return _read(_drawn(in_order(some_ticks(_COUNT), some_events()), path, CHANNELS))


def _drawn(messages: Iterable[Message], path: Path, channels: Sequence[str], *, world: bool = False) -> Path:
    """What the dashboard's process does with these messages, without a process that has to be in time."""
    painter = Painter("a test's session", PORTS, channels, path, world=world)
    draw(map(line_of, messages), painter, 2.0)
    painter.close()
    return path


def _read(path: Path):
    found: dict[str, list] = {}
    for each in chunk.RrdReader(path).stream().to_chunks():
        found.setdefault(str(each.entity_path), []).append(each.to_record_batch())
    return found


def _column(batches, path: str, ending: str) -> tuple[FloatArray, list]:
    times: list[float] = []
    values: list = []
    for batch in batches[path]:
        if "session" in batch.schema.names:
            name = next(name for name in batch.schema.names if name.endswith(ending))
            times += [1e-9 * at for at in batch.column("session").cast("int64").to_pylist()]
            values += batch.column(name).to_pylist()
    order = np.argsort(times, kind="stable")
    return np.array(times)[order], [values[n] for n in order]


def test_a_file_alone_is_written_by_a_process_of_its_own(tmp_path):
    path = tmp_path / "deep" / "run.rrd"
    dashboard = open_dashboard(view="none", save=path, ports=PORTS, channels=CHANNELS, title="a session")
    for tick in some_ticks(20):
        dashboard.tick(tick)
    dashboard.close()
    assert (dashboard.troubles, dashboard.url) == ((), "")
    assert len(_column(_read(path), "/motor_b/reading", "scalars")[0]) == 20


def test_a_robot_and_its_ghost_stand_where_they_were_told(tmp_path):
    box = DrawnShape("box", (0.1, 0.08, 0.05), (0.0, 0.0, 0.05), (0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 1.0))
    ball = DrawnShape("sphere", (0.03,), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.8, 0.1, 0.1, 1.0))
    still = (0.0, 0.0, 0.0, 1.0)
    told: list[Message] = [
        Scenery((1.0, 1.0), ((0, 255), (255, 0)), (("robot/base", (box,)), ("things/ball", (ball,))))
    ]
    for n in range(5):
        frames = ((0.1 * n, 0.0, 0.0, *still), (0.5, 0.5, 0.03, *still))
        ghost = (0.1 * n, 0.02 * n, 0.1 * n)
        told.append(WorldMoment(0.1 * n, frames, ((0.0, 0.0, 0.1, 0.5, 0.0, 0.1),), ghost, 1 + n // 3))
    found = _read(_drawn(told, tmp_path / "run.rrd", channels=(), world=True))
    for body, expected in (("robot/base", (0.4, 0.0)), ("things/ball", (0.5, 0.5)), ("ghost", (0.4, 0.08))):
        _, places = _column(found, f"/world/{body}", "translation")
        assert np.array(places[-1]).ravel()[:2] == pytest.approx(expected, abs=1e-6)
    assert {"/world/floor", "/world/robot/base/0", "/world/ghost/base/0", "/world/echoes"} <= set(found)
    _, strips = _column(found, "/world/ghost_way", "strips")
    assert len(strips[-1]) == 2  # the second ghost begins a way of its own


def test_measured_predicted_and_band_are_the_polls_own(batches):
    ticks = some_ticks(_COUNT)
    time_s, rows = _column(batches, "/motor_b/reading", "scalars")
    readings = [tick.innovations[1] for tick in ticks]
    assert time_s == pytest.approx([reading.time_s for reading in readings], abs=1e-6)
    values = np.array(rows)
    assert values[:, 0] == pytest.approx([reading.measured for reading in readings])
    assert values[:, 1] == pytest.approx([reading.predicted for reading in readings])
    assert values[:, 3] - values[:, 1] == pytest.approx(2 * np.sqrt(0.8))


def test_both_discs_turn_as_measured_and_as_predicted(batches):
    ticks = some_ticks(_COUNT)
    for disc, of in (("disc", "measured"), ("ghost", "predicted")):
        _, rows = _column(batches, f"/robot/a/{disc}", "quaternion")
        turns = np.array(rows).reshape(-1, 4)
        angles = np.degrees(2 * np.arctan2(-turns[:, 1], turns[:, 3]))
        expected = [getattr(tick.innovations[0], of) for tick in ticks]
        assert np.cos(np.radians(angles - expected)) == pytest.approx(1.0, abs=1e-5)


def test_the_log_holds_every_event_in_words(batches):
    time_s, rows = _column(batches, "/events", "text")
    assert [row[0] for row in rows] == [event.words for event in some_events()]
    assert time_s == pytest.approx([event.time_s for event in some_events()])


def test_all_that_was_asked_for_is_there(batches):
    wanted = {
        *(
            f"/motor_{port}/{curve}"
            for port in PORTS
            for curve in ("reading", "innovation", "square", "torque")
        ),
        *(f"/motor_{port}/cloud/{part}" for port in PORTS for part in ("dots", "mean", "axes", "figures")),
        "/motor_a/effects/nothing",
        *(f"/sensors/{channel}/{curve}" for channel in CHANNELS for curve in ("reading", "innovation")),
        *(
            "/battery/volts",
            "/link/latency_ms",
            "/link/polls_hz",
            "/robot/brick",
            "/robot/c/body",
            "/events",
            "/story",
        ),
    }
    assert wanted <= set(batches)


def test_geometry_is_logged_once_and_polls_in_batches(batches):
    assert len(batches["/robot/brick"]) == 1
    # 4 s of polls, a batch every 2 s and one for each event.
    moving = [batch for batch in batches["/motor_a/reading"] if "session" in batch.schema.names]
    assert sum(batch.num_rows for batch in moving) == _COUNT
    assert len(moving) <= 2 + len(some_events()) + 1


def test_every_pane_of_the_layout_has_something_to_show(batches):
    shown = {
        path for path in batches if path.startswith(("/motor", "/sensors", "/link", "/battery", "/events"))
    }
    views = list(_views(blueprint(PORTS, CHANNELS).root_container))
    assert len(views) == 3 * 6 + 2 * len(CHANNELS) + 6
    for view in views:
        contents = view.contents if isinstance(view.contents, list) else [f"{view.origin}/**"]
        stems = [content.replace("$origin", view.origin).removesuffix("/**") for content in contents]
        assert any(path.startswith(stem) for stem in stems for path in shown | set(batches)), view.name


def _views(container):
    for part in container.contents:
        if type(part).__name__ in _CONTAINERS:
            yield from _views(part)
        else:
            yield part


def test_losses_are_told_in_the_log(tmp_path):
    path = tmp_path / "run.rrd"
    painter = Painter("losses", PORTS, CHANNELS, path)
    painter.paint(
        some_ticks(5), [Event(0.05, "calm", "All is well.")], [(0.1, "dashboard: 12 polls were dropped")]
    )
    painter.close()
    _, rows = _column(_read(path), "/events", "text")
    assert [row[0] for row in rows] == ["All is well.", "dashboard: 12 polls were dropped"]


def test_a_session_without_motors_sensors_or_polls_still_makes_a_file(tmp_path):
    path = tmp_path / "empty.rrd"
    painter = Painter("empty", (), (), path)
    painter.paint([], [], [])
    painter.close()
    assert "/robot/brick" in _read(path)


def test_effects_keep_their_colours(tmp_path):
    path = tmp_path / "run.rrd"
    painter = Painter("colours", PORTS, CHANNELS, path)
    painter.paint(some_ticks(400)[:200], [], [])
    painter.paint(some_ticks(400)[200:], [], [])
    painter.close()
    styles = {
        name: [
            batch for batch in _read(path)[f"/motor_a/effects/{name}"] if "session" not in batch.schema.names
        ]
        for name in ("nothing", "constant_load", "viscous_friction")
    }
    assert all(len(batches) == 1 for batches in styles.values())
    shades = {name: _colour(batches[0]) for name, batches in styles.items()}
    assert len(set(shades.values())) == 3
    assert shades["nothing"] == colours.MEASURED[:3]


def test_all_that_is_weighed_has_a_colour_of_its_own():
    named = ("unknown", *DEFAULT_CANDIDATES)
    assert len(set(colours.EFFECTS)) == len(colours.EFFECTS) >= len(named)


def _colour(batch) -> tuple[int, int, int]:
    name = next(name for name in batch.schema.names if name.endswith("colors"))
    packed = batch.column(name).to_pylist()[0][0]
    return (packed >> 24) & 255, (packed >> 16) & 255, (packed >> 8) & 255
