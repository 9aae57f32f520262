"""A recording as a file for the rerun viewer: measured and predicted curves, and what a diagnosis says."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from nxt_twin.errors import NxtTwinError
from nxt_twin.export.run import MEASURED, DrawnRun, unit_of_column

_APPLICATION: Final = "nxt-twin-recording"
_TIMELINE: Final = "time"
_FLUSH_S: Final = 30.0
_COLOURS: Final = {True: (110, 120, 130), False: (0, 114, 178)}


def write_rrd(run: DrawnRun, path: Path) -> None:
    """Write a run as `.rrd`: `/COLUMN/measured` and `/COLUMN/predicted` on the timeline `time`, and `/remarks`.

    Raises:
        NxtTwinError: rerun is not installed.
        OSError: the file cannot be written.
    """
    try:
        import rerun as rr
    except ImportError:
        mend = "pip install 'nxt-twin[view]'"
        raise NxtTwinError("a .rrd file needs rerun, which is not installed", mend=mend) from None
    path.parent.mkdir(parents=True, exist_ok=True)
    stream = rr.RecordingStream(_APPLICATION)
    stream.set_sinks(rr.FileSink(path), default_blueprint=_layout(rr.blueprint, run))
    stream.send_recording_name(run.name)
    for curve in run.curves:
        place = f"/{curve.column}/{curve.side}"
        look = rr.SeriesLines(names=curve.side, colors=_COLOURS[curve.side == MEASURED])
        stream.log(place, look, static=True)
        times = rr.TimeColumn(_TIMELINE, duration=curve.time_s)
        stream.send_columns(place, [times], rr.Scalars.columns(scalars=curve.values))
    for remark in run.remarks:
        stream.set_time(_TIMELINE, duration=remark.time_s)
        stream.log("/remarks", rr.TextLog(remark.text))
    stream.flush(timeout_sec=_FLUSH_S)
    stream.disconnect()


def _layout(blueprint: Any, run: DrawnRun) -> Any:  # noqa: ANN401 - rerun's module and value
    """A plot for each column, and the remarks below."""
    views = []
    for column in dict.fromkeys(curve.column for curve in run.curves):
        unit = unit_of_column(column)
        name = f"{column} ({unit})" if unit else column
        views.append(blueprint.TimeSeriesView(origin=f"/{column}", name=name))
    if run.remarks:
        views.append(blueprint.TextLogView(origin="/remarks", name="diagnosis"))
    return blueprint.Blueprint(blueprint.Vertical(*views), collapse_panels=True)
