"""Which pane stands where: an explicit blueprint, so that nothing is left to the viewer's guesses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import rerun.blueprint as rrb

from nxt_twin.recording.columns import Port
from nxt_twin.view.dashboard.columns import motor_path, sensor_path
from nxt_twin.view.dashboard.drawing.robot import EYE, TARGET
from nxt_twin.view.wording import quantity

TIMELINE: Final = "session"
FOCUS: Final = -1
"""In the place of a tab: only the first motor's unknown torque, over time and against speed, and what happened."""
WORLD_EYE: Final = (-0.9, -1.05, 1.0)
"""Where the eye is in a robot's world, m; it looks at the world's origin."""
WINDOW_S: Final = 20.0
"""What the plots show, up to the newest poll."""


def blueprint(
    ports: Sequence[Port],
    channels: Sequence[str],
    tab: int = 0,
    *,
    world: bool = False,
) -> Any:  # noqa: ANN401 - rerun's
    """The dashboard's panes.

    Args:
        ports: motors, a tab each.
        channels: sensors' columns, one tab for all.
        tab: which tab is in front, or `FOCUS`.
        world: whether a robot's world has a tab, before the motors'.
    """
    if tab == FOCUS:
        return _whole(_focus(ports[0]))
    tabs = [_world()] if world else []
    tabs += [_motor_tab(port) for port in ports]
    if channels:
        tabs.append(_sensor_tab(channels))
    side = rrb.Vertical(_robot(), _log(), _link(), row_shares=[3.6, 3.4, 3.0], name="robot, events, link")
    front = rrb.Tabs(*tabs, active_tab=tab) if len(tabs) > 1 else (tabs[0] if tabs else None)
    whole = side if front is None else rrb.Horizontal(side, front, column_shares=[3.9, 6.1])
    return _whole(whole)


def _focus(port: Port) -> Any:  # noqa: ANN401
    return rrb.Vertical(rrb.Horizontal(_torque(port), _cloud(port)), _log(), row_shares=[6.0, 4.0])


def _whole(panes: Any) -> Any:  # noqa: ANN401
    return rrb.Blueprint(
        panes,
        rrb.TopPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following"),
        auto_layout=False,
        auto_views=False,
    )


def _motor_tab(port: Port) -> Any:  # noqa: ANN401
    name = f"Motor {port.upper()}"

    def plot(curves: Sequence[str], title: str, **more: Any) -> Any:  # noqa: ANN401
        contents = [motor_path(port, curve) for curve in curves]
        return _plot(contents, f"{port.upper()}: {title}", **more)

    return rrb.Grid(
        plot(["reading", "refused"], "angle (deg): measured grey, predicted blue"),
        _torque(port),
        plot(["innovation"], "innovation and its bounds (deg)"),
        _cloud(port),
        plot(
            ["square"],
            "normalised innovation square, mean, 95 %",
            axis_y=rrb.ScalarAxis(range=(0.0, 8.0)),
        ),
        plot(
            ["effects/**"],
            "probability of each explanation",
            legend=True,
            axis_y=rrb.ScalarAxis(
                range=(-0.02, 1.4)
            ),  # the viewer's legend lies in the plot: above the curves
        ),
        grid_columns=2,
        name=name,
    )


def _torque(port: Port) -> Any:  # noqa: ANN401
    return _plot([motor_path(port, "torque")], f"{port.upper()}: unknown torque (mN·m) and its band")


def _cloud(port: Port) -> Any:  # noqa: ANN401
    return rrb.Spatial2DView(
        origin=motor_path(port, "cloud"),
        name=f"{port.upper()}: torque against speed (orange: before)",
        background=rrb.Background(kind="SolidColor", color=[18, 20, 23]),
        visual_bounds=rrb.VisualBounds2D(x_range=[-13.0, 13.0], y_range=[-7.5, 7.5]),
    )


def _sensor_tab(channels: Sequence[str]) -> Any:  # noqa: ANN401
    panes = []
    for channel in channels:
        title = quantity(channel)
        curves = [sensor_path(channel, "reading"), sensor_path(channel, "refused")]
        panes.append(_plot(curves, f"{title}: measured and model ({channel_unit(channel)})"))
        panes.append(
            _plot(
                [sensor_path(channel, "innovation")],
                f"{title}: innovation and its bounds ({channel_unit(channel)})",
            )
        )
    return rrb.Grid(*panes, grid_columns=2, name="Sensors")


def channel_unit(channel: str) -> str:
    """The unit that a channel's name ends in."""
    ending = channel.rpartition("_")[2]
    return ending if ending in ("cm", "mm", "deg", "raw") else "0 or 1"


def _robot() -> Any:  # noqa: ANN401
    return rrb.Spatial3DView(
        origin="/robot",
        name="Robot: measured solid, predicted see-through",
        background=rrb.Background(kind="SolidColor", color=[18, 20, 23]),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(position=EYE, look_target=TARGET, eye_up=(0.0, 0.0, 1.0)),
        spatial_information=None,
    )


def _world() -> Any:  # noqa: ANN401
    return rrb.Spatial3DView(
        origin="/world",
        name="World: robot solid, ghost see-through",
        background=rrb.Background(kind="SolidColor", color=[18, 20, 23]),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(
            position=WORLD_EYE, look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0)
        ),
        spatial_information=None,
    )


def _log() -> Any:  # noqa: ANN401
    """A page of text, which wraps; the same lines are under `/events` as a log."""
    return rrb.TextDocumentView(origin="/story", name="What happened")


def _link() -> Any:  # noqa: ANN401
    return rrb.Grid(
        _plot(["/link/latency_ms"], "Link: latency (ms)"),
        _plot(["/link/polls_hz"], "Link: polls a second"),
        _plot(["/battery/volts"], "Battery (V)"),
        _plot(["/link/up"], "Link up", axis_y=rrb.ScalarAxis(range=(-0.1, 1.1))),
        grid_columns=2,
    )


def _plot(contents: Sequence[str], name: str, *, legend: bool = False, **more: Any) -> Any:  # noqa: ANN401
    return rrb.TimeSeriesView(
        origin="/",
        contents=list(contents),
        name=name,
        plot_legend=rrb.PlotLegend(corner="LeftTop", visible=legend),
        time_ranges=rrb.VisibleTimeRange(
            TIMELINE,
            start=rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S),
            end=rrb.TimeRangeBoundary.cursor_relative(),
        ),
        **more,
    )
