"""The plan of an experiment in words, before anything moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from nxt_twin.experiment.plan import Experiment, MotorIdentification
from nxt_twin.experiment.positioner.positioner import UNITS, WIDEST, PositionerAxis, within
from nxt_twin.experiment.positioner.spec import PositionerSpec
from nxt_twin.experiment.sweep import Sweep, sweep_of


def axes_of(experiment: Experiment) -> tuple[PositionerAxis, ...]:
    """The axes that the experiment moves, in order."""
    return () if isinstance(experiment, MotorIdentification) else sweep_of(experiment).axes


def outline(experiment: Experiment, movers: Mapping[PositionerAxis, PositionerSpec]) -> Iterator[str]:
    """One line for each thing that is going to be done.

    Args:
        experiment: what is asked for.
        movers: what moves each axis.

    Raises:
        PositionerError: it would go where nothing may.
    """
    yield experiment.name + (f": {experiment.why}" if experiment.why else "")
    if isinstance(experiment, MotorIdentification):
        yield from _motor(experiment)
    else:
        yield from _sweep(sweep_of(experiment), movers)


def _motor(experiment: MotorIdentification) -> Iterator[str]:
    for load in experiment.loads:
        if len(experiment.loads) > 1:
            yield f"hub: {load.name}, {load.added_inertia_kg_m2:g} kg·m² added"
        for run in experiment.runs:
            steps = "; ".join(
                f"{segment.mode} {segment.power_pct} % for {segment.duration_s:g} s"
                for segment in run.segments
            )
            yield f"motor {experiment.port.upper()}, {run.name}: {steps}"
    seconds = len(experiment.loads) * sum(run.duration_s + experiment.rest_s for run in experiment.runs)
    yield f"takes {seconds:.0f} s; the motor turns freely: nothing may be in its way"


def _sweep(sweep: Sweep, movers: Mapping[PositionerAxis, PositionerSpec]) -> Iterator[str]:
    for index, axis in enumerate(sweep.axes):
        values = [place[index] for part in sweep.parts for place in part.places]
        for value in (min(values), max(values)):
            within(WIDEST[axis], axis, value)
        yield f"{axis}: {min(values):g} to {max(values):g} {UNITS[axis]}, moved by {movers[axis].text}"
    for part in sweep.parts:
        ends = ", until no reading is valid" if part.until_silent else ""
        asked = f"; first: {part.request}" if part.request else ""
        yield f"recording {part.name}: {len(part.places)} places with {sweep.samples} readings each{ends}{asked}"
    yield f"takes {sweep.least_duration_s / 60.0:.1f} minutes at most, and the time of the moves"
