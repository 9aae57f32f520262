"""Make concealed cases: draw a motor, hide effects in it, record it, seal the answer."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import yaml

from nxt_twin.blind.answer import ANSWER_SCHEMA, encoded, seal, true_parameters, truth_of_recordings
from nxt_twin.blind.bench import draw_commands, draw_families, draw_starts_deg
from nxt_twin.blind.case import NOMINAL, SEAL_FILE, ConcealedCase
from nxt_twin.blind.conceal import conceal, look_up
from nxt_twin.blind.effects.concealed import ConcealedEffect
from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.kinds import Size
from nxt_twin.blind.polling import LinkName
from nxt_twin.blind.record import take
from nxt_twin.blind.whole import write_whole
from nxt_twin.recording.files import write_recording

HOLDOUT_CHANCE: Final = 0.5
SALT_BYTES: Final = 16


def make_case(
    seed: int,
    *,
    effects: tuple[str, ...] | None = None,
    size: Size | None = None,
    link: LinkName = "usb",
    duration_s: float = 15.0,
    recordings: int = 3,
    torque_noise_nm: float = 0.0,
    name: str | None = None,
) -> ConcealedCase:
    """Make one case; the same arguments make the same case.

    Args:
        seed: of all chance in the case.
        effects: ids to hide; `()` hides nothing; None hides one motor effect of docs/effects.md.
        size: how large; None draws a size for each effect.
        link: how the brick is polled.
        duration_s: length of each recording, s.
        recordings: how many; in half of the cases the last of several is named as held out.
        torque_noise_nm: standard deviation of an unmodelled random torque, N·m.
        name: of the case; by default from the seed.

    Raises:
        CaseError: for an effect that is not known here, or for two that cannot stand together.
    """
    rng = np.random.default_rng(seed)
    chosen = (str(rng.choice(list(KNOWN_EFFECTS))),) if effects is None else effects
    to_hide = look_up(chosen)
    coasting = any(effect.needs_coasting for effect in to_hide)
    families = draw_families(rng, recordings, coasting=coasting)
    starts_deg = draw_starts_deg(rng, recordings)
    commands = [
        draw_commands(rng, family, link, duration_s, start, torque_noise_nm)
        for family, start in zip(families, starts_deg, strict=True)
    ]
    hidden = conceal(rng, to_hide, size, commands, duration_s)
    taken = [
        take(rng, f"r{k + 1}.csv", hidden.motor_in(k), hidden.sensing, run) for k, run in enumerate(commands)
    ]
    held_out = 1 if recordings > 1 and rng.random() < HOLDOUT_CHANCE else 0
    content = _content(to_hide, [one.recording.name for one in taken], held_out)
    case_name = name or f"case-{seed}"
    answer = {
        "schema": ANSWER_SCHEMA,
        "case": case_name,
        "seed": seed,
        "link": link,
        "torque_noise_nm": torque_noise_nm,
        "effects": list(hidden.effects),
        "base": true_parameters(hidden.motor),
        "baseline": content["plant"],
        **truth_of_recordings(hidden, commands, families, taken),
        "salt": rng.bytes(SALT_BYTES).hex(),
    }
    return ConcealedCase(case_name, content, tuple(one.recording for one in taken), answer)


def _content(effects: tuple[ConcealedEffect, ...], names: list[str], held_out: int) -> dict[str, Any]:
    left_out = {effect.leaves_out for effect in effects}
    plant = {key: value for key, value in NOMINAL.items() if key not in left_out}
    fitted = len(names) - held_out
    content = {"plant": {"kind": "dc_motor", **plant}, "port": "a", "recordings": names[:fitted]}
    return {**content, "holdout": names[fitted:]} if held_out else content


def write_case(case: ConcealedCase, cases_dir: Path, answers_dir: Path) -> Path:
    """Write the case's folder, and its answer elsewhere; the folder carries the answer's SHA-256.

    Returns:
        The case's folder.
    """
    folder = cases_dir / case.name
    folder.mkdir(parents=True, exist_ok=True)
    answers_dir.mkdir(parents=True, exist_ok=True)
    for recording in case.recordings:
        write_recording(recording, folder / recording.name)
        if case.sidecar:
            beside = (folder / recording.name).with_suffix(".yaml")
            beside.write_text(yaml.safe_dump(dict(case.sidecar)), encoding="utf-8")
    content = yaml.safe_dump(dict(case.content), sort_keys=False)
    (folder / "case.yaml").write_text(content, encoding="utf-8")
    answer = encoded(case.answer)
    (answers_dir / f"{case.name}.json").write_bytes(answer)
    write_whole(folder / SEAL_FILE, seal(answer) + "\n")  # last: a case with a seal is whole
    return folder
