"""`nxt-twin diagnose`: say what physics a model leaves out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, final

import typer
import yaml

from nxt_twin.cli.output import JsonOption, emit_json, fail, progress
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.engine import diagnose as run_diagnosis
from nxt_twin.diagnose.sensor.engine import diagnose_sensor, is_sensor_case
from nxt_twin.diagnose.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.case import read_as_case
from nxt_twin.view.report import write_report


def diagnose(
    paths: Annotated[
        list[Path], typer.Argument(help="Case folders or recordings, each diagnosed by itself.")
    ],
    json: JsonOption = None,
    model_out: Annotated[
        Path | None, typer.Option(help="Write the improved plant as YAML (of several cases: a folder).")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write an HTML report into this folder.")] = None,
    seed: Annotated[int, typer.Option(help="Of the random shifts behind p-values.")] = 0,
) -> None:
    """Find the physics that a model leaves out, from recordings.

    Re-fits the baseline, locates the mismatch, tries every known effect, and judges on data that was not
    fitted. Exit status 0 whatever the verdict; 1 if a case cannot be diagnosed.
    """
    failed = False
    for path, label in zip(paths, _labels(paths), strict=True):
        try:
            answer = _diagnose_one(path, label, seed)
        except NxtTwinError as error:
            fail(str(error))
            failed = True
            continue
        many = len(paths) > 1
        if json:
            emit_json(_place(json, answer.diagnosis.name, "json", many=many), to_json(answer.diagnosis))
        if model_out:
            _write_model(Path(_place(str(model_out), answer.diagnosis.name, "yaml", many=many)), answer.model)
        page = write_report(answer.diagnosis, report) if report else None
        if json != "-":
            show(answer.diagnosis, page)
    if failed:
        raise typer.Exit(1)


def show(diagnosis: Diagnosis, page: Path | None) -> None:
    """Print a diagnosis for a person."""
    fit = diagnosis.fit
    print(f"\n{diagnosis.name}: {diagnosis.verdict}")
    print(diagnosis.sentence)
    print(f"  {fit.metric}: {fit.baseline:.4g} → {fit.improved:.4g} {fit.unit} (noise alone {fit.floor:.3g})")
    for effect in diagnosis.effects:
        print(f"  {effect.id}, probability {effect.probability:.2f}")
        for name, estimate in effect.params.items():
            print(f"    {name} = {estimate.value:.4g} ± {estimate.std:.2g} {estimate.unit}")
        for other in effect.confusable_with:
            print(f"    could be {other.id}: {other.why}")
    if diagnosis.refit:
        print("  re-fitted")
    for name, moved in diagnosis.refit.items():
        print(f"    {name} {moved.before:.4g} → {moved.after:.4g} ± {moved.std:.2g} {moved.unit}")
    for note in diagnosis.notes:
        print(f"  · {note}")
    if diagnosis.next_experiment:
        print(f"  next: {diagnosis.next_experiment.input}")
    if page:
        print(f"  report: {page}")


def _labels(paths: list[Path]) -> list[str | None]:
    """A name for each of several cases that would otherwise share one; None keeps a case's own."""
    stems = [path.resolve().stem for path in paths]
    return [
        f"{path.resolve().parent.name}-{stem}" if stems.count(stem) > 1 else None
        for path, stem in zip(paths, stems, strict=True)
    ]


@final
@dataclass(frozen=True)
class _Answered:
    """A diagnosis, and the keys of the improved plant or sensor."""

    diagnosis: Diagnosis
    model: dict[str, Any]


def _diagnose_one(path: Path, label: str | None, seed: int) -> _Answered:
    with progress(str(path)) as tell:
        case = read_as_case(path)
        case = replace(case, name=label or case.name)
        if is_sensor_case(case):
            told = diagnose_sensor(case, seed=seed, progress=tell)
            return _Answered(told.diagnosis, told.model.to_config())
        answer = run_diagnosis(case, seed=seed, progress=tell)
        return _Answered(answer.diagnosis, answer.plant.to_config())


def _place(target: str, name: str, ending: str, *, many: bool) -> str:
    """The file for one of several cases in the folder `target`, or `target` itself for a single case."""
    if target == "-" or (not many and not Path(target).is_dir()):
        return target
    return str(Path(target) / f"{name}.{ending}")


def _write_model(path: Path, model: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    config = yaml.safe_dump(model, sort_keys=False, allow_unicode=True)
    path.write_text(config, encoding="utf-8")
