"""How one diagnosis compares with the sealed answer."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, final

from nxt_twin.blind.answer import seal
from nxt_twin.blind.case import SEAL_FILE
from nxt_twin.blind.located import NOWHERE, UNPLACED, Located, OnsetPlace, locate_score, parse_place
from nxt_twin.blind.reached import Reach, seconds_of
from nxt_twin.blind.share import NORMAL_95
from nxt_twin.errors import CaseError

CaseKind = Literal["clean", "single", "pair", "triple", "unknown"]

NO_ANSWER: Final = "none"
HOME: Final = "bristle"
"""The family of an answer that names none."""
_KINDS: Final[dict[int, CaseKind]] = {0: "clean", 1: "single", 2: "pair", 3: "triple"}
_RIGHT_VERDICT: Final[dict[CaseKind, str]] = {
    "clean": "adequate",
    "single": "explained",
    "pair": "explained",
    "triple": "explained",
    "unknown": "unexplained",
}


@final
@dataclass(frozen=True)
class Judged:
    """One case, judged.

    Attributes:
        name: of the case.
        kind: how much was hidden in it, and whether a library holds it.
        hidden: ids of what was hidden.
        sizes: small, medium or large, in the order of `hidden`.
        effect_rms_deg: by how much the effects moved the encoder's reading.
        verdict: the diagnosis's, or `none` where there was no diagnosis.
        named: ids that the diagnosis names.
        considered: those, all that it calls confusable with them, and what an `adequate` diagnosis tells as left out.
        exact: whether the verdict fits and the named ids are the hidden ones, no more and no fewer; of an
            unknown effect, whether it was refused.
        holds: whether everything hidden is among `considered`.
        misnamed: whether an explanation names an effect that is not there, nor anything that it is said to be
            confusable with.
        parameter_error: relative error of the main parameter, by hidden id that was named.
        parameter_error_own: `parameter_error` of relative sizes. Torques and inertias are divided by the
            motor's inertia; resistances, inductances and currents by its resistance. Encoder and voltage
            alone do not tell more.
        covered: whether the main parameter lies in its 95 % interval, by hidden id that was named.
        fit_ratio: error of the improved model over the noise floor, on held-out data.
        improved: that error, in the diagnosis's unit.
        reach: what the true structure reaches, where that was computed.
        located: whether it is said where the baseline fails.
        family: which simulator made its truth.
        probability: given for each name; one where a diagnosis gives none.
        floors: what a correct model would reach, as the diagnosis says, by the length of the simulated windows, s.
        reached: the improved model's error, likewise.
    """

    name: str
    kind: CaseKind
    hidden: tuple[str, ...]
    sizes: tuple[str, ...]
    effect_rms_deg: float
    verdict: str
    named: tuple[str, ...]
    considered: frozenset[str]
    exact: bool
    holds: bool
    misnamed: bool
    parameter_error: Mapping[str, float]
    parameter_error_own: Mapping[str, float]
    covered: Mapping[str, bool]
    fit_ratio: float | None
    improved: float | None
    reach: Reach | None = None
    located: Located = UNPLACED
    family: str = HOME
    probability: Mapping[str, float] = field(default_factory=dict)
    floors: Mapping[float, float] = field(default_factory=dict)
    reached: Mapping[float, float] = field(default_factory=dict)


def read_sealed(answer_file: Path, case_folder: Path) -> dict[str, Any]:
    """Read an answer, having checked that it is the one that was sealed with the case.

    Raises:
        CaseError: if the case has no seal, or the answer is another than was sealed.
    """
    seal_file = case_folder / SEAL_FILE
    try:
        sealed = seal_file.read_text(encoding="utf-8").strip()
        answer = answer_file.read_bytes()
    except OSError as failure:
        raise CaseError(f"cannot be read: {failure.strerror}", where=str(failure.filename)) from None
    if seal(answer) != sealed:
        raise CaseError("is not the answer that was sealed with the case", where=str(answer_file))
    return dict(json.loads(answer))


@final
@dataclass(frozen=True)
class Given:
    """The parts of a diagnosis that the benchmark judges.

    Attributes:
        verdict: its verdict, or `none` where there was no diagnosis.
        params: value and standard deviation of each parameter, by named id.
        alike: ids said to be confusable, by named id.
        left_out: ids that an `adequate` diagnosis lists: readings speak for them, and no simulation needs them.
        refit: the re-fitted values of base parameters that moved.
        fit_ratio: improved error over floor, None where the floor is not known.
        improved: the improved error.
        place: where it says that the baseline fails.
        probability: of each name.
        floors: by the length of the simulated windows, s.
        reached: the improved model's error, likewise.
    """

    verdict: str
    params: Mapping[str, Mapping[str, tuple[float, float]]]
    alike: Mapping[str, frozenset[str]]
    refit: Mapping[str, float]
    fit_ratio: float | None
    improved: float | None
    place: OnsetPlace
    probability: Mapping[str, float] = field(default_factory=dict)
    floors: Mapping[float, float] = field(default_factory=dict)
    reached: Mapping[float, float] = field(default_factory=dict)
    left_out: frozenset[str] = frozenset()


NOTHING_GIVEN: Final = Given(NO_ANSWER, {}, {}, {}, None, None, NOWHERE)


def parse_diagnosis(diagnosis: Mapping[str, Any], where: str) -> Given:
    """Take from a diagnosis (docs/formats.md#diagnosis-json) what is judged.

    Raises:
        CaseError: if a key is missing or of another type.
    """
    try:
        effects = diagnosis["effects"]
        improved, floor = diagnosis["fit"]["improved"], diagnosis["fit"]["floor"]
        return Given(
            verdict=str(diagnosis["verdict"]),
            params={
                one["id"]: {
                    name: (float(cell["value"]), float(cell["std"])) for name, cell in one["params"].items()
                }
                for one in effects
            },
            alike={one["id"]: frozenset(other["id"] for other in one["confusable_with"]) for one in effects},
            refit={name: float(moved["to"]) for name, moved in diagnosis["refit"].items()},
            fit_ratio=float(improved) / float(floor) if improved is not None and floor else None,
            improved=None if improved is None else float(improved),
            place=parse_place(diagnosis.get("mismatch", {})),
            probability={one["id"]: float(one.get("probability", 1.0)) for one in effects},
            floors=_by_horizon(diagnosis["fit"], "floor"),
            reached=_by_horizon(diagnosis["fit"], "improved"),
            left_out=_left_out(diagnosis),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as failure:
        mend = "see docs/formats.md#diagnosis-json"
        raise CaseError(f"is no diagnosis: {failure!r}", where=where, mend=mend) from None


def _left_out(diagnosis: Mapping[str, Any]) -> frozenset[str]:
    """The alternatives of an `adequate` diagnosis; those of others are structures with one effect exchanged."""
    listed = diagnosis.get("alternatives", []) if diagnosis["verdict"] == "adequate" else []
    return frozenset(str(one["id"]) for one in listed)


def _by_horizon(fit: Mapping[str, Any], key: str) -> dict[float, float]:
    return {seconds_of(one["seconds"]): float(one[key]) for one in fit.get("horizons", [])}


def judge(answer: Mapping[str, Any], given: Given, reach: Reach | None = None) -> Judged:
    """Compare what was given with the answer, and with what the true structure reaches."""
    effects = answer["effects"]
    hidden = frozenset(effect["id"] for effect in effects)
    kind: CaseKind = _KINDS[len(hidden)] if all(effect["known"] for effect in effects) else "unknown"
    named = frozenset(given.params)
    considered = named.union(given.left_out, *given.alike.values())
    ratios = {one["id"]: _ratios(answer, given, one) for one in effects if _compares(given, one)}
    return Judged(
        name=answer["case"],
        kind=kind,
        hidden=tuple(effect["id"] for effect in effects),
        sizes=tuple(effect["size"] for effect in effects),
        effect_rms_deg=float(answer["effect_rms_deg"]),
        verdict=given.verdict,
        named=tuple(given.params),
        considered=considered,
        exact=given.verdict == _RIGHT_VERDICT[kind] and (kind == "unknown" or named == hidden),
        holds=given.verdict != NO_ANSWER and hidden <= considered,
        misnamed=given.verdict == "explained"
        and any(hidden.isdisjoint({one} | given.alike[one]) for one in named),
        parameter_error={key: abs(pair[0] - 1.0) for key, pair in ratios.items()},
        parameter_error_own={key: abs(pair[1] - 1.0) for key, pair in ratios.items()},
        covered={one["id"]: _covers(given, one) for one in effects if _compares(given, one)},
        fit_ratio=given.fit_ratio,
        improved=given.improved,
        reach=reach,
        located=locate_score(answer, given.place),
        family=str(answer.get("family", HOME)),
        probability=given.probability,
        floors=given.floors,
        reached=given.reached,
    )


def is_exact(case: Judged, verdict: str) -> bool:
    """Whether the case would be exact under another verdict, with the names as they are."""
    fits = verdict == _RIGHT_VERDICT[case.kind]
    return fits and (case.kind == "unknown" or set(case.named) == set(case.hidden))


def _compares(given: Given, effect: Mapping[str, Any]) -> bool:
    told = given.params.get(effect["id"], {})
    return effect["main"] in told and effect["main"] in effect["params"]


def _covers(given: Given, effect: Mapping[str, Any]) -> bool:
    value, std = given.params[effect["id"]][effect["main"]]
    return abs(value - float(effect["params"][effect["main"]])) <= NORMAL_95 * std


def _ratios(answer: Mapping[str, Any], given: Given, effect: Mapping[str, Any]) -> tuple[float, float]:
    """Found over true main parameter: as printed, and relative to the motor's own inertia or resistance."""
    name = effect["main"]
    ratio = given.params[effect["id"]][name][0] / float(effect["params"][name])
    if "_nm" in name or name.endswith("_kg_m2"):
        return ratio, ratio / _believed(answer, given, "inertia_kg_m2")
    if name.endswith(("_ohm", "_h", "_per_joule")):
        return ratio, ratio / _believed(answer, given, "resistance_ohm")
    if name.endswith("_a"):
        return ratio, ratio * _believed(answer, given, "resistance_ohm")
    return ratio, ratio


def _believed(answer: Mapping[str, Any], given: Given, key: str) -> float:
    """A base parameter as the diagnosis has it, over its true value; one where the plant has no such parameter."""
    if not answer["base"][key]:
        return 1.0
    return float(given.refit.get(key, answer["baseline"][key])) / float(answer["base"][key])
