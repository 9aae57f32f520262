import struct
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
import view_samples as samples
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from nxt_twin.errors import DiagnosisError, NxtTwinError
from nxt_twin.view import palette
from nxt_twin.view.close_look import telling_part
from nxt_twin.view.legends import name_all_curves
from nxt_twin.view.picture import write_picture
from nxt_twin.view.stacking import stack
from nxt_twin.view.telling import most_telling
from nxt_twin.view.thinning import envelope, random_indices, some, steps, trend
from nxt_twin.view.traces import picture_of, traces_of

SVG = "{http://www.w3.org/2000/svg}"


def words(path):
    return " ".join(node.text or "" for node in ET.parse(path).iter(f"{SVG}text"))


def test_the_picture_is_a_png_1200_pixels_wide(tmp_path):
    write_picture(samples.explained(), tmp_path / "hero.png")
    header = (tmp_path / "hero.png").read_bytes()[:24]
    assert header.startswith(b"\x89PNG")
    assert struct.unpack(">I", header[16:20]) == (1200,)


@pytest.mark.parametrize("make", [samples.explained, samples.adequate, samples.unexplained])
def test_the_picture_carries_the_sentence_and_the_error(tmp_path, make):
    diagnosis = make()
    write_picture(diagnosis, tmp_path / "hero.svg")
    told = words(tmp_path / "hero.svg")
    assert diagnosis.sentence in told
    assert diagnosis.verdict in told
    assert ("improved" in told) == (diagnosis.verdict == "explained")


def test_the_same_picture_is_the_same_file(tmp_path):
    for name in ("one.svg", "two.svg", "one.png", "two.png"):
        write_picture(samples.adequate(), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


def test_dollar_signs_in_a_name_are_no_mathematics(tmp_path):
    write_picture(replace(samples.adequate(), name="$\\frac$ & <b>"), tmp_path / "hero.svg")
    assert "$\\frac$ & <b>" in words(tmp_path / "hero.svg")


def test_a_picture_of_nothing_or_in_an_unknown_format_is_refused(tmp_path):
    with pytest.raises(DiagnosisError, match="no held-out run"):
        write_picture(replace(samples.adequate(), held_out=()), tmp_path / "hero.png")
    with pytest.raises(NxtTwinError, match=r"\.png or an \.svg"):
        write_picture(samples.adequate(), tmp_path / "hero.gif")


def test_the_first_run_shown_is_the_one_that_tells_most():
    explained = samples.explained()
    gains = [run.baseline_rmse - run.improved_rmse for run in most_telling(explained)]
    assert gains == sorted(gains, reverse=True)
    left = [run.improved_rmse for run in most_telling(samples.unexplained(helped=True))]
    assert left == sorted(left, reverse=True)


def test_three_readings_beyond_a_gap_are_not_what_is_drawn_large():
    diagnosis = samples.explained()
    run = diagnosis.held_out[0]
    stale, baseline = np.array(run.stale), np.array(run.baseline)
    stale[600:-3] = np.nan
    baseline[-3:] += 200.0
    picture = picture_of(diagnosis, replace(run, stale=stale, baseline=baseline))
    part = telling_part(picture.run, traces_of(picture)[0])
    assert part.stop <= 600
    assert part.stop - part.start > 12


def test_what_moved_in_a_gap_does_not_make_the_large_panel_narrow():
    diagnosis = samples.explained()
    run = diagnosis.held_out[0]
    measured = np.array(run.measured)
    stale, baseline = np.full(measured.size, np.nan), measured.copy()
    stale[500:600] = 0.0
    measured[600:] += 5000.0
    baseline[590:600] += 60.0
    picture = picture_of(diagnosis, replace(run, stale=stale, measured=measured, baseline=baseline))
    part = telling_part(picture.run, traces_of(picture)[0])
    assert (part.start, part.stop) == (500, 600)


@settings(deadline=None)
@given(
    arrays.arrays(np.float64, st.integers(1, 400), elements=st.floats(-1e6, 1e6) | st.just(np.nan)),
    st.integers(2, 40),
)
def test_thinning_a_trace_keeps_its_peaks_and_its_order(values, columns):
    time_s = np.arange(values.size) * 0.01
    thin_s, thin = envelope(time_s, values, columns)
    assert thin.size <= max(2 * columns, 1)
    assert np.all(np.diff(thin_s) > 0)
    if np.isfinite(values).any():
        assert np.nanmax(thin) == np.nanmax(values)
        assert np.nanmin(thin) == np.nanmin(values)
    else:
        assert np.isnan(thin).all()


def test_thinning_leaves_a_gap_where_there_is_one():
    values = np.where((np.arange(1000) > 400) & (np.arange(1000) < 600), np.nan, 1.0)
    _, thin = envelope(np.arange(1000) * 0.01, values, 50)
    assert np.isnan(thin).any()


def test_a_held_command_is_drawn_from_its_changes_alone():
    time_s, command = steps(np.arange(100) * 0.1, np.repeat([0.0, 50.0, -50.0, -50.0], 25))
    assert time_s.tolist() == pytest.approx([0.0, 2.5, 5.0, 9.9])
    assert command.tolist() == [0.0, 50.0, -50.0, -50.0]


def test_thinned_indices_stay_in_order_and_in_number():
    assert some(np.arange(7), 10).tolist() == list(range(7))
    assert some(np.arange(1000), 5).tolist() == [0, 249, 499, 749, 999]
    drawn = random_indices(1000, 50)
    assert drawn.size == 50
    assert np.all(np.diff(drawn) > 0)
    assert drawn.tolist() == random_indices(1000, 50).tolist()


def test_a_trend_finds_the_shape_along_its_axis_and_none_along_another():
    rng = np.random.default_rng(1)
    speed, position = rng.uniform(-10, 10, (2, 5000))
    torque = -0.02 * np.sign(speed) + rng.normal(0, 0.002, 5000)
    along_speed, along_position = trend(speed, torque), trend(position, torque)
    assert along_speed.share > 0.95
    assert along_position.share < 0.05
    assert along_speed.median[along_speed.at < -1] == pytest.approx(0.02, abs=1e-3)
    assert np.all(along_speed.low <= along_speed.high)


def test_a_trend_of_too_few_points_is_empty():
    assert trend(np.arange(5.0), np.arange(5.0)).at.size == 0
    assert trend(np.ones(100), np.arange(100.0)).at.size == 0


def named(names, title="speed (rad/s)"):
    """Two panels, whose curves bear names."""
    figure = Figure(figsize=(10.4, 3.1))
    grid = figure.add_gridspec(1, 2, top=0.9, bottom=0.16)
    for place in grid:
        axes = figure.add_subplot(place)
        palette.dress(axes, title)
        for number, name in enumerate(names):
            axes.plot([0, 1], [0, number], label=name)
    return figure


@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize(
    "names",
    [
        ("measured", "predicted"),
        tuple(f"the curve with number {number}" for number in range(5)),
        ("gravity load of an unbalanced arm",) * 7,
    ],
)
def test_names_of_curves_stand_above_the_panel_and_hide_neither_title_nor_edge(names, stacked):
    figure = named(names)
    name_all_curves(figure)
    if stacked:
        stack(figure)
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        box = axes.get_legend().get_window_extent()
        title = axes._left_title.get_window_extent()
        assert len(axes.get_legend().get_texts()) == len(names)
        assert box.y0 >= axes.get_window_extent().y1 - 2.0
        assert box.y1 <= figure.bbox.y1 + 1.0
        assert box.x1 <= figure.bbox.x1
        assert not box.overlaps(title)
