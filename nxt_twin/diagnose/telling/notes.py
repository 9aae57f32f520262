"""Plain remarks beside a diagnosis: how its figures are to be read, and why some are bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Fit, HeldOutRun, Moved
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.judging.run_outs import RunOut, unfitted_run_outs
from nxt_twin.diagnose.telling.own_moments import own_moments
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.modes import MODE_COAST, MODE_FLOAT
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

_BAD_RUN_RATIO = 2.5  # times the median error of held-out runs, above which a run is told as bad
_GRAVITY = "gravity_torque_nm"
_INERTIA = "inertia_kg_m2"
_CONSTANTS = ("resistance_ohm", "torque_constant_nm_per_a", "back_emf_v_s_per_rad")
_LAG_SPAN, _WAVES = Slot("clock_skew", "lag_span"), Slot("clock_skew", "waves")
_POLL_SHARE = Slot("command_delay", "poll_share")
_WITH_ITS_POLL = 0.5  # of a poll's own length, from which a delay is told to go with it
_ANOTHER = 0.1  # of the given gravity torque: a load that is off by less is not told as another
_SURE_STDS = 2.0  # standard deviations of the gravity torque by which it has to be off as well
_MOST_TOLD = 12  # times of one recording
_BRIEF_S = 6.0
"""Fitted time below which an answer is told to rest on little: the shortest that the splits are tested for."""
_LOOSE = {MODE_COAST: "out without current", MODE_FLOAT: "on a floating bridge"}


def notes(
    problem: Problem,
    plant: Plant,
    runs: Sequence[HeldOutRun],
    stale: Mapping[str, FloatArray],
    fit: Fit,
    *,
    by_chance: bool = False,
) -> tuple[str, ...]:
    """Plain remarks: how the error is counted, anchors, faults of the recording, runs that stay bad and why.

    `stale` holds the times (s) of late-stamped readings by recording; `by_chance` says that counts are lost so.
    """
    said = [
        f"Each free run lasts {problem.window_s:.3g} s. It starts from the state that the model's own filter "
        "estimates at that moment."
    ]
    if plant.layout.frame == "motor":
        said.append(
            "Encoder and voltage fix only ratios of the parameters. The given winding resistance and torque constant "
            "are the anchor: an error in them scales every torque and inertia."
        )
    said.extend(
        f"{name}: {times_s.size} readings are older than their stamps (at {_listed_s(times_s)} s). This is a fault of "
        "the transport, not of the motor; the errors leave these readings out."
        for name, times_s in stale.items()
    )
    said.extend(leaping(problem))
    said.extend(in_clumps(problem.signals))
    said.extend(rounded(problem.signals))
    if by_chance:
        said.append(
            "Each count is lost by chance, so that no simulation follows these readings: the floor of "
            f"{fit.floor:.3g} {fit.unit} tells how near a right one comes."
        )
    said.extend(stamped_late(plant, problem.signals))
    said.extend(late_by_its_poll(plant))
    said.extend(own_moments(problem, plant))
    said.extend(f"{name}: {stalled}." for name, stalled in problem.stalls.items())
    if problem.by_windows:
        said.append(
            "Errors of single steps go on from reading to reading, as where readings are held or stamped late. So "
            "single steps are no evidence here: simulated windows alone set the parameters and chose the effects."
        )
    if problem.instead_of:
        held_out = listed([part.signals.name for part in problem.held_out])
        said.append(
            f"Held out at first: {listed(problem.instead_of)}. Only there an error showed that the fitted recordings "
            f"do not have. So the search began anew with {held_out} held out."
        )
    said.extend(briefly_recorded(sum(float(np.ptp(signals.time_s)) for signals in problem.signals)))
    said.extend(_bad_runs(problem, runs))
    said.extend(_run_out(run_out) for run_out in unfitted_run_outs(problem, fit))
    return tuple(said)


def leaping(problem: Problem) -> tuple[str, ...]:
    """A remark on each recording in which readings leap away and back."""
    return tuple(
        f"{name}: {times_s.size} {'reading leaps' if times_s.size == 1 else 'readings leap'} away and back, three "
        f"times as far as anything else moves between two readings (at {_listed_s(times_s)} s). No motor does "
        "that: fits and errors leave them out."
        for name, times_s in problem.leaps.items()
    )


def in_clumps(recordings: Sequence[Signals]) -> tuple[str, ...]:
    """A remark where rows came in clumps: how many at once, what is made of their stamps, and what they leave open."""
    clumped = [one for one in recordings if one.clump_rows > 0.0]
    if not clumped:
        return ()
    rows = np.mean([one.clump_rows for one in clumped])
    open_s = np.sqrt(np.mean(np.concatenate([one.open_s for one in clumped]) ** 2))
    return (
        f"A link handed rows over in clumps of about {rows:.2g}: their stamps tell when they came. They are "
        f"taken for read evenly since the clump before, to {1e3 * open_s:.1g} ms. Better stamp a row where it is read.",
    )


def rounded(recordings: Sequence[Signals]) -> tuple[str, ...]:
    """A remark where stamps were rounded to a coarse step: to which, and how far moments are open nevertheless."""
    coarse = [one for one in recordings if one.rounded_s > 0.0]
    if not coarse:
        return ()
    open_s = np.sqrt(np.mean(np.concatenate([one.open_s for one in coarse]) ** 2))
    return (
        f"Stamps are rounded to {1e3 * max(one.rounded_s for one in coarse):.3g} ms. An even course through them tells "
        f"when rows were read, to {1e3 * open_s:.1g} ms. Better write finer stamps.",
    )


def stamped_late(plant: Plant, recordings: Sequence[Signals]) -> tuple[str, ...]:
    """A remark where each row is late by chance: by how much, and what the stamps beside it leave open."""
    if plant.values.get(_WAVES, 1.0) > 0.0:
        return ()
    span_s = plant.values[_LAG_SPAN]
    open_s = span_s * max(one.late_open for one in recordings)
    return (
        f"Each row is stamped late by chance, by up to {1e3 * span_s:.2g} ms. Its neighbours tell by how much, to "
        f"{1e3 * open_s:.1g} ms; long simulations err by what that leaves open. Better stamp a row when it is read.",
    )


def late_by_its_poll(plant: Plant) -> tuple[str, ...]:
    """A remark where commands act the later, or the sooner, the longer their own poll is, as a logger's loop has it."""
    share = plant.values.get(_POLL_SHARE, 0.0)
    if abs(share) < _WITH_ITS_POLL:
        return ()
    when = (
        "later the longer the poll after their row is: it seems to send them at the end of its loop"
        if share > 0.0
        else "sooner the longer the poll before their row is: it seems to log them a loop after it sent them"
    )
    return (f"The delay is the logger's, not the motor's. Commands act {when}.",)


def _listed_s(times_s: FloatArray) -> str:
    """The first dozen of some times."""
    return ", ".join(f"{t:.3f}" for t in times_s[:_MOST_TOLD]) + (", …" if times_s.size > _MOST_TOLD else "")


def briefly_recorded(fitted_s: float) -> tuple[str, ...]:
    """A remark where the fitted recordings last `fitted_s` together, which is too little for a sure answer."""
    if fitted_s >= _BRIEF_S:
        return ()
    return (
        f"The fitted recordings last {fitted_s:.2g} s together. That is little: do not trust the answer before you "
        f"have recorded at least {_BRIEF_S:.0f} s, better 30 s.",
    )


def onsets_told(effects: Sequence[Effect]) -> tuple[str, ...]:
    """A remark for each effect whose onset only held-out readings show."""
    return tuple(
        f"The fitted readings leave open when the {effect.name} came on. The held-out recording shows it: "
        "the onset was taken from there."
        for effect in effects
    )


def on_the_load(refit: Mapping[str, Moved]) -> tuple[str, ...]:
    """A remark where the load is another than the given one: its gravity torque moved, by more than it is in doubt.

    It has to move beside the motor's torque as well. Where all torques shrink alike, only their scale is another, which
    no encoder fixes.
    """
    gravity = refit.get(_GRAVITY)
    if gravity is None or not min(gravity.before, gravity.after) > 0.0:
        return ()
    alike = gravity.before * _torque_scale(refit)
    apart = min(abs(gravity.after - gravity.before), abs(gravity.after - alike))
    if apart < max(_ANOTHER * gravity.before, _SURE_STDS * _own_std(gravity)):
        return ()
    moved = [
        f"{name} is {refit[name].after:.3g} {refit[name].unit} (given: {refit[name].before:.3g})"
        for name in (_GRAVITY, _INERTIA)
        if name in refit
    ]
    constants = [refit[name] for name in _CONSTANTS if name in refit]
    most = max((abs(one.after / one.before - 1.0) for one in constants), default=0.0)
    motor = f" The motor's own constants moved by {100.0 * most:.0f} % at most." if constants else ""
    return (f"The load is another than the given one: {listed(moved)}.{motor}",)


def _torque_scale(refit: Mapping[str, Moved]) -> float:
    """By what the motor's torque at a voltage was multiplied: the torque constant over the resistance."""
    resistance, constant = (refit.get(name) for name in _CONSTANTS[:2])
    if resistance is None or constant is None or not min(resistance.after, constant.before) > 0.0:
        return 1.0
    return (constant.after / constant.before) * (resistance.before / resistance.after)


def _own_std(moved: Moved) -> float:
    """Its doubt without that of resistance and torque constant, which the given value shares."""
    if moved.ratio is None or not moved.ratio.value > 0.0:
        return moved.std
    return min(moved.std, moved.after * moved.ratio.std / moved.ratio.value)


def _bad_runs(problem: Problem, runs: Sequence[HeldOutRun]) -> list[str]:
    """Which held-out runs stay bad beside the others, and what about them was never fitted."""
    errors = np.array([run.improved_rmse for run in runs])
    if errors.size < 3:
        return []
    usual = float(np.nanmedian(errors))
    largest = max(float(np.abs(s.command).max()) for s in problem.signals)
    fastest = max(_fastest(s.time_s, s.measured) for s in problem.signals)
    said = []
    for part, run in zip(problem.held_out, runs, strict=True):
        if not run.improved_rmse > _BAD_RUN_RATIO * usual:
            continue
        signals = part.signals
        reasons = []
        command = float(np.abs(signals.command).max())
        if command > 1.02 * largest:
            reasons.append(f"its commands reach {command / largest:.2f} times the largest that was fitted")
        if _fastest(signals.time_s, signals.measured) > 1.05 * fastest:
            reasons.append("it runs faster than every fitted recording")
        if signals.command.size > 5 * max(s.command.size for s in problem.signals):
            reasons.append("its input varies all the time, and the fitted inputs hardly do")
        why = listed(reasons) if reasons else "nothing in its inputs says why"
        said.append(
            f"{run.recording} keeps a large error ({run.improved_rmse:.3g}; the median is {usual:.3g}): {why}."
        )
    return said


def _run_out(run_out: RunOut) -> str:
    """Why the error of a recording that is held out says little."""
    how = listed([f"{_LOOSE[mode]} for {seconds:.1f} s" for mode, seconds in run_out.seconds.items()])
    return (
        f"In {run_out.recording} the motor runs {how}; no fitted recording does that. Driven motion hardly tells "
        "friction from the braking of the motor's own voltage, so this error says little about the found effects. "
        "Record such coast-downs for the fit too."
    )


def _fastest(time_s: FloatArray, measured: FloatArray) -> float:
    known = np.isfinite(measured)
    t, y = time_s[known], measured[known]
    far = max(1, int(np.searchsorted(t, t[0] + 0.2)))
    return float(np.max(np.abs(y[far:] - y[:-far]) / np.maximum(t[far:] - t[:-far], 1e-6)))
