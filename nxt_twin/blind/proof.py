"""Run a named range: make, solve, reach, delete, score; what is there already is kept."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, final

from nxt_twin.blind.aims import detectable
from nxt_twin.blind.families.family import Family
from nxt_twin.blind.families.orders import make_orders
from nxt_twin.blind.ranges import SeedRange
from nxt_twin.blind.score import score
from nxt_twin.blind.solve import case_folders, reach_all, solve_all
from nxt_twin.blind.spread import Outcome
from nxt_twin.blind.verdict import Judged
from nxt_twin.fleet.workers.place import Place

DELETED: Final = "deleted"

_CONTAINED_IN: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "gravity_load": ("hanging_payload",),
        "payload_inertia": ("hanging_payload",),
        "hanging_payload": ("gravity_load", "payload_inertia"),
        "coulomb_friction": ("asymmetric_friction",),
        "viscous_friction": ("asymmetric_viscous_friction",),
    }
)
"""Effects that hold the physics of another, or its parts: they go with it."""


def taken_out(effect: str) -> frozenset[str]:
    """What leaves the library so that nobody knows an effect's physics."""
    return frozenset((effect, *_CONTAINED_IN.get(effect, ())))


@final
@dataclass(frozen=True)
class Proof:
    """Where a range is kept, and what is known of it."""

    folder: Path
    chosen: SeedRange
    families: tuple[Family, ...]

    def run(self, place: Place) -> Iterator[tuple[str, int, Iterator[Outcome]]]:
        """Each stage: what it does, on how many cases at most, and its outcomes as they come."""
        for seed, orders in self.chosen.orders(self.families).items():
            cases, answers, diagnoses, reached, deleted = self._folders(seed)
            yield f"making {seed}", len(orders), make_orders(orders, cases, answers, place=place)
            folders = case_folders(cases)
            yield f"solving {seed}", len(folders), solve_all(folders, diagnoses, seed=0, place=place)
            yield f"reaching {seed}", len(folders), reach_all(folders, answers, reached, place=place)
            alone = self._alone(seed)
            without = {case.name: taken_out(case.hidden[0]) for case in alone}
            kept = [folder for folder in folders if folder.name in without]
            yield (
                f"solving {seed} with what is hidden taken out of the library",
                len(kept),
                solve_all(kept, deleted, seed=0, place=place, without=without),
            )

    def judged(self) -> tuple[Judged, ...]:
        """Every case of the range."""
        return tuple(case for seed in self.chosen.seeds for case in self._scored(seed))

    def deletions(self) -> dict[str, list[str]]:
        """The verdicts of cases whose effect was taken out, by effect."""
        found: dict[str, list[str]] = {}
        for seed in self.chosen.seeds:
            deleted = self._folders(seed)[4]
            for case in self._alone(seed):
                file = deleted / f"{case.name}.json"
                if file.exists():
                    verdict = str(json.loads(file.read_text(encoding="utf-8"))["verdict"])
                    found.setdefault(case.hidden[0], []).append(verdict)
        return found

    def _scored(self, seed: int) -> Sequence[Judged]:
        cases, answers, diagnoses, reached, _ = self._folders(seed)
        return score(cases, answers, diagnoses, reached).cases

    def _alone(self, seed: int) -> list[Judged]:
        """Detectable single effects that are not small, in the first seed."""
        if seed != self.chosen.seeds[0]:
            return []
        return [
            case
            for case in self._scored(seed)
            if case.kind == "single" and case.sizes[0] != "small" and detectable(case)
        ]

    def _folders(self, seed: int) -> tuple[Path, Path, Path, Path, Path]:
        root = self.folder / str(seed)
        cases, answers, diagnoses, reached, deleted = (
            root / name for name in ("cases", "answers", "diagnoses", "reached", DELETED)
        )
        return cases, answers, diagnoses, reached, deleted
