"""`nxt-twin diagnose`: say what physics a model leaves out.

Its imports stand inside the functions: help comes at once, without the compiler and the engine.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, fail, progress, remark
from nxt_twin.cli.tables import ColumnsOption, MappingOption, stated_mapping
from nxt_twin.cli.tolerated import ToleranceOption, tolerated
from nxt_twin.errors import NxtTwinError

if TYPE_CHECKING:
    from nxt_twin.diagnose.diagnosis import Diagnosis
    from nxt_twin.diagnose.dispatch import Answered
    from nxt_twin.recording.case import Case
    from nxt_twin.recording.mappings import MappingOf


def diagnose(
    paths: Annotated[
        list[Path], typer.Argument(help="Case folders or recordings, each diagnosed by itself.")
    ],
    json: JsonOption = None,
    model_out: Annotated[
        Path | None, typer.Option(help="Write the improved plant as YAML (several cases: a folder).")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write an HTML report into this folder.")] = None,
    experiment_out: Annotated[
        Path | None,
        typer.Option(help="Write the next experiment as a motor program (several cases: a folder)."),
    ] = None,
    mapping: MappingOption = None,
    columns: ColumnsOption = None,
    seed: Annotated[int, typer.Option(help="Random seed of the p-values.")] = 0,
    tolerance: ToleranceOption = None,
) -> None:
    """Find the physics that a model leaves out, from recordings.

    The diagnosis re-fits the baseline, locates the mismatch, tries every known effect, and judges on held-out data.
    Exit status 0 after any verdict; 1 if a case cannot be diagnosed.
    """
    from nxt_twin.diagnose.telling.to_json import to_json

    failed = False
    error_si = tolerated(tolerance)
    tell_of_compiling()
    mapping_of = stated_mapping(mapping, columns)
    for path, label in zip(paths, _labels(paths), strict=True):
        try:
            case = _case(path, label, mapping_of)
            if case.before:
                _tell_changes(case, json, report, error_si, many=len(paths) > 1)
                continue
            _refuse_angle(case, tolerance)
            answer = _diagnose_one(case, seed, error_si)
        except NxtTwinError as error:
            fail(str(error))
            failed = True
            continue
        many = len(paths) > 1
        if json:
            emit_json(_place(json, answer.diagnosis.name, "json", many=many), to_json(answer.diagnosis))
        if model_out:
            _write_model(Path(_place(str(model_out), answer.diagnosis.name, "yaml", many=many)), answer.model)
        if experiment_out:
            told = _write_experiment(experiment_out, answer.diagnosis, many=many)
            if told and json != "-":
                print(told)
        page = _write_report(answer.diagnosis, report) if report else None
        if json != "-":
            show(answer.diagnosis, page)
    if failed:
        raise typer.Exit(1)


def show(diagnosis: Diagnosis, page: Path | None) -> None:
    """Print a diagnosis for a person."""
    from nxt_twin.diagnose.units import after_number

    fit = diagnosis.fit
    print(f"\n{diagnosis.name}: {diagnosis.verdict}")
    print(diagnosis.sentence)
    print(f"  {fit.metric}: {fit.baseline:.4g} → {fit.improved:.4g} {fit.unit} (noise alone {fit.floor:.3g})")
    for effect in diagnosis.effects:
        print(f"  {effect.id}, probability {effect.probability:.2f}")
        for name, estimate in effect.params.items():
            print(f"    {name} = {estimate.value:.4g} ± {estimate.std:.2g}{after_number(estimate.unit)}")
        for other in effect.confusable_with:
            print(f"    could be {other.id}: {other.why}")
    _show_doubt(diagnosis)
    if diagnosis.refit:
        print("  re-fitted")
    for name, moved in diagnosis.refit.items():
        print(
            f"    {name} {moved.before:.4g} → {moved.after:.4g} ± {moved.std:.2g}{after_number(moved.unit)}"
        )
    for note in diagnosis.notes:
        print(f"  · {note}")
    if diagnosis.next_experiment:
        print(f"  next: {diagnosis.next_experiment.input}")
    if page:
        print(f"  report: {page}")


def _show_doubt(diagnosis: Diagnosis) -> None:
    """What sets in when, what comes nearest, what would have been seen, and how often noise alone would alarm."""
    from nxt_twin.diagnose.units import after_number

    for onset in diagnosis.mismatch.onsets:
        print(
            f"  {onset.what} sets in at {onset.time_s:.2f} s of {onset.recording} ({onset.strength:.0f} nats)"
        )
    if diagnosis.nearest:
        print(f"  nearest known effect: {diagnosis.nearest.name}; {diagnosis.nearest.why}")
    if diagnosis.verdict == "adequate" and diagnosis.detectable:
        seen = [one for one in diagnosis.detectable if one.size is not None]
        print("  would have been seen:")
        for one in seen:
            bound = "≥" if one.seen_above else "≤"
            print(f"    {one.id}: {one.parameter} {bound} {one.size:.3g}{after_number(one.unit)}")
    if diagnosis.false_alarm_rate:
        alarms = diagnosis.false_alarm_rate
        print(f"  false alarms in clean recordings like these: below {100.0 * alarms.upper_95:.1f} %")


def _write_report(diagnosis: Diagnosis, folder: Path) -> Path:
    from nxt_twin.view.report import write_report

    return write_report(diagnosis, folder)


def _labels(paths: list[Path]) -> list[str | None]:
    """A name for each of several cases that would otherwise share one; None keeps a case's own."""
    stems = [Path(os.path.realpath(path)).stem for path in paths]
    return [
        f"{path.resolve().parent.name}-{stem}" if stems.count(stem) > 1 else None
        for path, stem in zip(paths, stems, strict=True)
    ]


def _case(path: Path, label: str | None, mapping_of: MappingOf | None) -> Case:
    from nxt_twin.recording.case import read_as_case

    case = read_as_case(path, mapping_of)
    remark(case)
    return replace(case, name=label or case.name)


def _tell_changes(
    case: Case, json: str | None, report: Path | None, tolerance: float | None, *, many: bool
) -> None:
    """Say what has changed since the recordings that the case calls `before`."""
    from nxt_twin.cli.changed import show as show_changes
    from nxt_twin.diagnose.changed.to_json import to_json
    from nxt_twin.diagnose.dispatch import changed_since
    from nxt_twin.view.changes_report import write_changes_report

    with progress(case.name) as tell:
        changes = changed_since(case, tolerance=tolerance, progress=tell)
    if json:
        emit_json(_place(json, case.name, "json", many=many), to_json(changes))
    page = write_changes_report(changes, report) if report else None
    if json != "-":
        show_changes(changes, page)


def _diagnose_one(case: Case, seed: int, tolerance: float | None) -> Answered:
    from nxt_twin.diagnose.dispatch import diagnose_any

    with progress(case.name) as tell:
        return diagnose_any(case, seed=seed, tolerance=tolerance, progress=tell)


def _refuse_angle(case: Case, tolerance: str | None) -> None:
    from nxt_twin.diagnose.robot.engine import is_robot_case
    from nxt_twin.diagnose.tolerance import is_length
    from nxt_twin.errors import DiagnosisError

    if tolerance is not None and is_robot_case(case) and not is_length(tolerance):
        what = f"{tolerance!r} is no tolerance of a robot's position"
        raise DiagnosisError(what, where=case.name, mend="write a length, such as 5mm")


def _place(target: str, name: str, ending: str, *, many: bool) -> str:
    """The file for one of several cases in the folder `target`, or `target` itself for a single case."""
    if target == "-" or (not many and not Path(target).is_dir()):
        return target
    return str(Path(target) / f"{name}.{ending}")


def _write_experiment(target: Path, diagnosis: Diagnosis, *, many: bool) -> str:
    """Write the program of the next experiment; where there is none, say why in one line."""
    from nxt_twin.recording.program import write_program
    from nxt_twin.recording.robot_path import write_path

    experiment = diagnosis.next_experiment
    if experiment is None:
        return f"{diagnosis.name}: nothing is left open, so no experiment is written"
    if experiment.program is None and experiment.path is None:
        return f"{diagnosis.name}: this experiment is no program and no path; it is told in words"
    path = Path(_place(str(target), diagnosis.name, "yaml", many=many))
    path.parent.mkdir(parents=True, exist_ok=True)
    if experiment.program is not None:
        write_program(experiment.program, path)
    elif experiment.path is not None:
        write_path(experiment.path, path)
    return ""


def _write_model(path: Path, model: dict[str, Any]) -> None:
    import yaml

    path.parent.mkdir(parents=True, exist_ok=True)
    config = yaml.safe_dump(model, sort_keys=False, allow_unicode=True)
    path.write_text(config, encoding="utf-8")
