"""Batches of polls become the right columns, whatever the batches' sizes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from view_ticks import ONSET_S, PORTS, some_ticks

from nxt_twin.arrays import FloatArray
from nxt_twin.twin.records import Innovation, MotorBelief, Tick
from nxt_twin.view.dashboard.cloud import HEIGHT, WIDTH, Cloud
from nxt_twin.view.dashboard.columns import NIS_BOUND, Tabulator, turn_of


def _joined(ticks: Sequence[Tick], batch: int) -> dict[str, tuple[FloatArray, FloatArray]]:
    tabulator = Tabulator(PORTS)
    parts: dict[str, list[tuple[FloatArray, FloatArray]]] = {}
    for at in range(0, len(ticks), batch):
        for table in tabulator.tables(ticks[at : at + batch]):
            parts.setdefault(table.path, []).append((table.time_s, table.values))
    return {
        path: (np.concatenate([time_s for time_s, _ in rows]), np.concatenate([values for _, values in rows]))
        for path, rows in parts.items()
    }


def test_readings_stand_beside_predictions_with_their_band():
    ticks = some_ticks(100)
    time_s, values = _joined(ticks, 7)["/motor_a/reading"]
    readings = [tick.innovations[0] for tick in ticks]
    assert time_s == pytest.approx([reading.time_s for reading in readings])
    assert values[:, 0] == pytest.approx([reading.measured for reading in readings])
    assert values[:, 1] == pytest.approx([reading.predicted for reading in readings])
    assert values[:, 3] - values[:, 2] == pytest.approx(4 * np.sqrt(0.8))


def test_the_squares_and_their_mean_do_not_depend_on_batches():
    ticks = some_ticks(300)
    one, many = _joined(ticks, 300)["/motor_a/square"][1], _joined(ticks, 11)["/motor_a/square"][1]
    assert one == pytest.approx(many)
    squares = [tick.innovations[0].normalised_square for tick in ticks]
    assert one[:, 0] == pytest.approx(squares)
    assert one[-1, 1] == pytest.approx(np.mean(squares[-50:]))
    assert set(one[:, 2]) == {NIS_BOUND}


def test_sensors_that_answer_less_often_have_their_own_stamps():
    tables = _joined(some_ticks(100), 10)
    assert tables["/sensors/s4_ultrasonic_cm/reading"][0].size == 20
    assert tables["/sensors/s1_light_raw/reading"][0].size == 100


def test_refused_readings_are_shown_apart():
    tables = _joined(some_ticks(2000), 50)
    _, refused = tables["/sensors/s4_ultrasonic_cm/refused"]
    assert refused.size > 0
    assert set(refused.ravel()) == {255.0}
    assert "/motor_a/refused" not in tables


def test_torque_is_in_millinewton_metres_with_two_deviations_each_way():
    ticks = some_ticks(50)
    _, values = _joined(ticks, 50)["/motor_b/torque"]
    assert values[:, 0] == pytest.approx([1e3 * tick.motors[1].unknown_torque_nm for tick in ticks])
    assert values[:, 2] - values[:, 1] == pytest.approx(12.0)


def test_an_explanation_has_a_curve_once_it_was_likely():
    tables = _joined(some_ticks(500), 25)
    names = ("nothing", "viscous_friction", "constant_load")
    assert tables["/motor_a/effects/nothing"][1].shape == (500, 1)
    assert sum(tables[f"/motor_a/effects/{name}"][1][-1, 0] for name in names) == pytest.approx(1.0)
    for name in names[1:]:
        assert tables[f"/motor_a/effects/{name}"][1].max() > 0.05
        assert f"/motor_b/effects/{name}" not in tables


def test_torque_against_speed_is_split_where_a_model_was_adopted():
    ticks, cloud = some_ticks(400), Cloud("a")
    cloud.add(ticks)
    whole = cloud.picture()
    assert whole.former.shape == (0, 2)
    cloud.begin_anew(ticks[300].received_s)
    split = cloud.picture()
    assert split.former.shape == (300, 2)
    assert split.dots.shape == (100, 2)
    assert np.concatenate([split.former, split.dots]) == pytest.approx(whole.dots)


def test_latency_rate_and_battery():
    ticks = some_ticks(120)
    tables = _joined(ticks, 30)
    assert tables["/link/latency_ms"][1].ravel() == pytest.approx(
        [1e3 * (tick.received_s - tick.sent_s) for tick in ticks]
    )
    assert tables["/link/polls_hz"][1][5:].ravel() == pytest.approx(50.0)
    assert tables["/battery/volts"][0].size == 3


def test_a_lost_link_is_seen_and_has_no_latency():
    ticks = some_ticks(20)
    lost = [
        Tick(20 + n, 0.5 + 0.02 * n, 0.5 + 0.02 * n, ticks[0].motors, (), link_up=False) for n in range(10)
    ]
    tables = _joined([*ticks, *lost], 30)
    assert tables["/link/latency_ms"][0].size == 20
    assert set(tables["/link/up"][1].ravel()) == {0.0, 1.0}
    assert _joined(lost, 3)["/link/up"][1].max() == 0.0


def test_the_ghost_goes_on_where_readings_are_missing():
    def motor(angle_deg: float) -> tuple[MotorBelief, ...]:
        return (MotorBelief("a", 0.0, "coast", angle_deg, 0.0, 0.0, 0.0, 1e-3),)

    read = Tick(0, 0.0, 0.1, motor(12.0), (Innovation(0.1, "a_tacho_deg", "deg", 11.0, 10.0, 1.0),))
    blind = Tick(1, 0.2, 0.2, motor(15.0), (), link_up=False)
    turn = turn_of("a", [read, blind], last_deg=0.0)
    assert turn.measured_deg == pytest.approx([11.0, 11.0])
    assert turn.predicted_deg == pytest.approx([10.0, 15.0])
    assert turn_of("b", [read, blind], last_deg=0.0).time_s.size == 0


def test_the_cloud_shows_a_drag_as_a_falling_line():
    cloud = Cloud("a")
    ticks = some_ticks(900)
    cloud.add([tick for tick in ticks if tick.received_s > ONSET_S])
    picture = cloud.picture()
    assert picture is not None
    # Ordinates grow downward, so a torque that falls with speed rises here.
    assert np.polyfit(picture.mean[:, 0], picture.mean[:, 1], 1)[0] > 0.1
    assert np.abs(picture.dots[:, 0]).max() <= WIDTH
    assert np.abs(picture.dots[:, 1]).max() <= HEIGHT
    assert picture.figures[1] == "1000 deg/s"


def test_the_cloud_stays_bounded_and_spans_the_session():
    cloud = Cloud("a")
    for tick in some_ticks(6000):
        cloud.add([tick])
    picture = cloud.picture()
    assert picture is not None
    assert 500 < picture.dots.shape[0] <= 1200
    assert Cloud("a").picture() is None
