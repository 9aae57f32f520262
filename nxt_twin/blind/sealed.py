"""Cases of somebody else's simulator: what they hide, written as sealed answers, so that they can be scored."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, final

from pydantic import BaseModel, ConfigDict, Field

from nxt_twin.blind.answer import ANSWER_SCHEMA, encoded, seal
from nxt_twin.blind.case import NOMINAL, SEAL_FILE
from nxt_twin.blind.kinds import Size
from nxt_twin.blind.make import SALT_BYTES
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


def seal_case(folder: Path, truths: Path, answers: Path) -> None:
    """Write the sealed answer of one case, and its seal into the case's folder.

    Args:
        folder: of the case.
        truths: folder that holds a `TruthFile` named after the case.
        answers: folder for the answer.

    Raises:
        CaseError: where the case has a seal already, or its truth is missing or wrong.
    """
    if (folder / SEAL_FILE).exists():
        raise CaseError("has a seal already", where=str(folder), mend=f"remove {SEAL_FILE} to seal it anew")
    file = _truth_file(truths, folder.name)
    answer = encoded(_answer(folder, read_model(file, TruthFile, CaseError), str(file)))
    write_whole(answers / f"{folder.name}.json", answer.decode())
    write_whole(folder / SEAL_FILE, seal(answer) + "\n")


def _truth_file(truths: Path, name: str) -> Path:
    files = [file for suffix in _SUFFIXES if (file := truths / f"{name}{suffix}").exists()]
    if len(files) != 1:
        what = "hold one" if not files else "hold only one"
        raise CaseError(f"has to {what} of {name}.yaml and {name}.json", where=str(truths))
    return files[0]


def _answer(folder: Path, truth: TruthFile, where: str) -> dict[str, Any]:
    plant = read_case(folder).plant
    stated = load_plant_config(plant) if isinstance(plant, str) else plant
    baseline = {key: float(stated.get(key, 0.0)) for key in NOMINAL}  # what is left out acts with nothing
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
