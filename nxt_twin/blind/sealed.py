"""Cases of somebody else's simulator: what they hide, written as sealed answers, so that they can be scored."""

from __future__ import annotations

import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, final

from pydantic import BaseModel, ConfigDict, Field

from nxt_twin.blind.answer import ANSWER_SCHEMA, encoded, seal
from nxt_twin.blind.case import NOMINAL, SEAL_FILE
from nxt_twin.blind.kinds import Size
from nxt_twin.blind.make import SALT_BYTES
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.blind.whole import write_whole
from nxt_twin.errors import CaseError
from nxt_twin.physics.library import library
from nxt_twin.recording.case import read_case
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.yaml_file import read_model

_SUFFIXES: Final = (".yaml", ".json")


@final
class HiddenEffectFile(BaseModel):
    """One effect that a case hides.

    Attributes:
        id: of the library, or a name of the simulator's own.
        params: true values, by the names of docs/effects.md where the library has them.
        size: small, medium or large.
        known: whether the library holds it; left out, its id tells.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    id: str = Field(min_length=1)
    params: dict[str, float] = Field(default_factory=dict)
    size: Size = "medium"
    known: bool | None = None


@final
class TruthFile(BaseModel):
    """What one case hides.

    Attributes:
        family: the simulator's name, under which tables count the case.
        effects: all that is hidden; none where nothing is missing.
        motor: true values of the baseline's keys; those that are left out are taken to be as the case states them.
        effect_rms_deg: by how much the effects move the encoder's reading.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    family: str = Field(default="another", min_length=1)
    effects: tuple[HiddenEffectFile, ...] = Field(default=(), max_length=3)
    motor: dict[str, float] = Field(default_factory=dict)
    effect_rms_deg: float = Field(default=0.0, ge=0.0)


def seal_cases(folders: Sequence[Path], truths: Path, answers: Path) -> int:
    """Write the sealed answers of cases, and the seals into their folders: of all cases, or of none.

    Cases that a killed run has sealed already are passed over.

    Args:
        folders: of the cases.
        truths: folder that holds a `TruthFile` named after each case.
        answers: folder for the answers.

    Returns:
        How many were sealed now.

    Raises:
        CaseError: where a case has the seal of another answer, or its truth is missing or wrong.
    """
    waiting = [folder for folder in folders if not _is_sealed(folder, answers)]
    made = [(folder, encoded(_answer(folder, truths))) for folder in waiting]
    for folder, answer in made:
        write_whole(answers / f"{folder.name}.json", answer.decode())
        write_whole(folder / SEAL_FILE, seal(answer) + "\n")  # last: a case with a seal has its answer
    return len(made)


def _is_sealed(folder: Path, answers: Path) -> bool:
    if not (folder / SEAL_FILE).exists():
        return False
    answer = answers / f"{folder.name}.json"
    if not answer.exists():
        mend = f"remove {SEAL_FILE} to seal it anew"
        raise CaseError(f"has a seal, and no answer stands in {answers}", where=str(folder), mend=mend)
    read_sealed(answer, folder)
    return True


def _truth_file(truths: Path, name: str) -> Path:
    files = [file for suffix in _SUFFIXES if (file := truths / f"{name}{suffix}").exists()]
    if len(files) != 1:
        what = "hold one" if not files else "hold only one"
        raise CaseError(f"has to {what} of {name}.yaml and {name}.json", where=str(truths))
    return files[0]


def _answer(folder: Path, truths: Path) -> dict[str, Any]:
    file = _truth_file(truths, folder.name)
    truth, where = read_model(file, TruthFile, CaseError), str(file)
    plant = read_case(folder).plant
    stated = load_plant_config(plant) if isinstance(plant, str) else plant
    baseline = {
        key: _number(stated.get(key, 0.0), key, folder) for key in NOMINAL
    }  # left out: it does not act
    unknown = sorted(set(truth.motor) - set(NOMINAL))
    if unknown:
        raise CaseError(f"a motor has no {', '.join(unknown)}", where=f"{where}, key motor")
    return {
        "schema": ANSWER_SCHEMA,
        "case": folder.name,
        "family": truth.family,
        "effects": [_hidden(effect, where) for effect in truth.effects],
        "base": {**baseline, **truth.motor},
        "baseline": baseline,
        "effect_rms_deg": truth.effect_rms_deg,
        "salt": secrets.token_hex(SALT_BYTES),
    }


def _number(value: object, key: str, folder: Path) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(f"{value!r} is no number", where=f"{folder}, plant, key {key}")
    return float(value)


def _hidden(effect: HiddenEffectFile, where: str) -> Mapping[str, Any]:
    held = library().get(effect.id)
    if held is None and effect.known is not False:
        mend = "take an id of docs/effects.md, or write known: false for physics that no library holds"
        raise CaseError(f"the library has no effect {effect.id}", where=f"{where}, key effects", mend=mend)
    main = held.parameters[0].name if held else ""
    return {
        "id": effect.id,
        "known": held is not None and effect.known is not False,
        "size": effect.size,
        "main": main,
        "params": effect.params,
    }
