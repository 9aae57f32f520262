"""The report of a live session: complete, self-contained, and bounded however long the session was."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from view_ticks import CHANNELS, PORTS, some_events, some_ticks

from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event, Innovation, Tick
from nxt_twin.view.live_plot import motor_figure
from nxt_twin.view.live_report import Keeper, LinkedDiagnosis, render_live_report, write_live_report


def _kept(count: int = 300, most: int = 8000, ports: tuple[Port, ...] = PORTS) -> Keeper:
    kept = Keeper(most)
    for tick in some_ticks(count, ports=ports):
        kept.tick(tick)
    for event in some_events():
        kept.event(event)
    return kept


@pytest.fixture(scope="module")
def page() -> str:
    return render_live_report(_kept(), title="mock:", sentence="motor A lacks viscous friction")


def test_sentence_events_and_every_motor_are_there(page: str):
    assert "<h1>Motor A lacks viscous friction</h1>" in page
    for event in some_events():
        assert event.words in page
    for port in PORTS:
        assert f"<h2>Motor {port.upper()}</h2>" in page
    for heading in ("Sensors", "Link and battery", "Readings against predictions"):
        assert f"<h2>{heading}</h2>" in page
    for channel in CHANNELS:
        assert f"<code>{channel}</code>" in page


@pytest.mark.usefixtures("undrawn")
def test_the_first_screen_says_what_was_wrong_and_where_the_diagnosis_is():
    found = LinkedDiagnosis("b", "The model leaves out constant load.", "live-b-1.html")
    told = render_live_report(_kept(50), title="mock:", findings=[found])
    head = told.split("What happened")[0]
    assert "The model leaves out constant load." in head
    assert 'href="live-b-1.html"' in head


@pytest.mark.usefixtures("undrawn")
def test_without_a_diagnosis_the_first_screen_lists_the_troubles_or_their_absence(page: str):
    troubles = [event.words for event in some_events() if event.kind in ("divergence", "stall")]
    assert all(words[1:] in page.split("What happened")[0] for words in troubles)
    calm = Keeper()
    for tick in some_ticks(20):
        calm.tick(tick)
    assert "Nothing was wrong" in render_live_report(calm, title="mock:")


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("kind", ["adopted", "undiagnosed"])
def test_a_session_that_diagnosed_is_not_told_to_diagnose(page: str, kind):
    assert "Nothing was diagnosed" in page
    kept = _kept(50)
    kept.event(Event(time_s=kept.ticks[20].received_s, kind=kind, words="port A: a diagnosis", port="a"))
    assert "Nothing was diagnosed" not in render_live_report(kept, title="mock:")


def test_torque_against_speed_starts_anew_where_a_model_was_adopted():
    kept = _kept(200, ports=("a",))
    assert "model before" not in render_live_report(kept, title="mock:")
    kept.event(Event(time_s=kept.ticks[100].received_s, kind="adopted", words="port A: taken over", port="a"))
    page = render_live_report(kept, title="mock:")
    assert "model before" in page
    assert "adopted model" in page


def test_pictures_are_drawn_in_the_page(page: str):
    assert page.count("<svg") == 2 * (len(PORTS) + 2)  # wide, and stacked for a phone
    for words in (
        "innovation and the bounds",
        "unknown torque (mN·m)",
        "probability",
        "battery (V)",
    ):
        assert words in page
    assert "viscous friction" in page


def test_long_names_of_effects_do_not_cover_the_title_of_their_panel():
    names = ("nothing", "unknown", "load_dependent_friction", "regulator_delay")
    ticks = [
        replace(tick, motors=tuple(replace(one, effects=dict.fromkeys(names, 0.25)) for one in tick.motors))
        for tick in some_ticks(20, ports=("a",))
    ]
    figure = motor_figure("a", ticks, ())
    FigureCanvasAgg(figure).draw()
    panel = next(axes for axes in figure.axes if axes.get_title(loc="left") == "probability")
    assert not panel.get_legend().get_window_extent().overlaps(panel._left_title.get_window_extent())


def test_the_page_needs_nothing_from_elsewhere(page: str):
    assert "<script" not in page
    assert not re.findall(r'(?:src|href)="(?!#)[^"]*"', page)
    assert "http" not in page.replace("http://www.w3.org", "")


def test_the_same_session_gives_the_same_page():
    first, again = (render_live_report(_kept(100, ports=("b",)), title="mock:") for _ in range(2))
    assert first == again


@pytest.mark.usefixtures("undrawn")
def test_a_long_session_is_thinned_and_its_numbers_are_not():
    whole, thinned = _kept(3000, ports=("a",)), _kept(3000, most=500, ports=("a",))
    assert len(thinned.ticks) <= 500
    assert thinned.every == 8
    assert [tick.number for tick in thinned.ticks] == list(range(0, 3000, 8))
    assert thinned.tallies == whole.tallies
    assert thinned.tallies["a_tacho_deg"].readings == 3000
    assert "of which every 8th is drawn" in render_live_report(thinned, title="mock:")


def test_tallies_are_means_over_all_readings():
    kept = Keeper()
    for number, off in enumerate((0.0, 1.0, 2.0, 3.0)):
        reading = Innovation(float(number), "s1_light_raw", "raw", 100 + off, 100.0, 1.0, accepted=off < 3)
        kept.tick(Tick(number, number - 0.01, float(number), (), (reading,)))
    tally = kept.tallies["s1_light_raw"]
    assert (tally.readings, tally.believed, tally.within) == (4, 3, 2)
    assert tally.squares == pytest.approx(14.0)


def test_a_session_in_which_nothing_came_still_has_a_page(tmp_path):
    path = write_live_report(tmp_path / "new" / "folder", Keeper(), title="usb:", name="empty")
    assert path.name == "empty.html"
    assert "Nothing was said." in path.read_text(encoding="utf-8")


def test_words_are_escaped():
    kept = Keeper()
    kept.event(Event(0.0, "started", "<b>watching</b>"))
    page = render_live_report(kept, title="<script>alert(1)</script>")
    assert "<script" not in page
    assert "&lt;b&gt;watching" in page.lower()


def test_motors_are_drawn_while_the_link_is_lost():
    kept = Keeper()
    for tick in some_ticks(50, ports=("a",)):
        kept.tick(Tick(tick.number, tick.sent_s, tick.received_s, tick.motors, (), link_up=False))
    assert "<h2>Motor A</h2>" in render_live_report(kept, title="mock:")
