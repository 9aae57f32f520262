"""What no diagnosis may say, counted over the answers of a proof."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

from nxt_twin.blind.by_family import EVERY, TableRow
from nxt_twin.blind.share import NORMAL_95

HALF: Final = 0.5
RIVAL_NATS: Final = 3.0
"""A rival that is better by more has to replace a name."""
FACTOR: Final = 3.0
"""By how much a positive parameter may leave its given value before the answer has to tell."""
_WORSE, _WORSE_BEYOND_2_S = 1.02, 1.1
"""Errors of the improved plant, over those of another one, that are chance; a whole run is one number."""
NOISE_NAMED: Final = 0.01
"""Share of synthetic clean recordings in which noise alone may get a name."""
_SHORT_S: Final = 2.0
_HANDED_ON: Final = "is handed on"

Answer = Mapping[str, Any]
"""A diagnosis as JSON has it (docs/formats.md#diagnosis-json)."""


@final
@dataclass(frozen=True)
class Sentence:
    """One sentence of what no answer may say.

    Attributes:
        words: what is counted, for the table.
        asked: which answers or names could say it, as values of a kind that `broken` takes.
        broken: whether one of them does.
    """

    words: str
    asked: Callable[[Answer], Sequence[Any]]
    broken: Callable[[Any], bool]

    def cell(self, answers: Sequence[Answer]) -> str:
        """How many break it, of how many that could."""
        each = [one for answer in answers for one in self.asked(answer)]
        return f"{sum(map(self.broken, each))} of {len(each)}"


def absurd_rows(answers: Sequence[tuple[str, Answer]]) -> list[TableRow]:
    """Each sentence, by family and over all; `answers` are diagnoses beside the family of their truth."""
    families = [*sorted({family for family, _ in answers}), EVERY]
    own = {name: [answer for family, answer in answers if name in (family, EVERY)] for name in families}
    return [("", *families), *((one.words, *(one.cell(own[name]) for name in families)) for one in SENTENCES)]


def told_names(answer: Answer) -> list[tuple[Answer, Answer]]:
    """The named effects of an explanation, each beside its answer."""
    return [(answer, effect) for effect in answer["effects"]] if answer["verdict"] == "explained" else []


def is_improbable_alone(name: tuple[Answer, Answer]) -> bool:
    """Whether an effect is named with less than even odds, and no set stands beside it."""
    _, effect = name
    return effect.get("probability", 1.0) < HALF and not effect["confusable_with"]


def is_beaten(name: tuple[Answer, Answer]) -> bool:
    """Whether a listed alternative is better than a name by more than `RIVAL_NATS`."""
    answer, effect = name
    least = effect.get("probability", 1.0) * math.exp(RIVAL_NATS)
    return any((one.get("probability") or 0.0) > least for one in answer["alternatives"])


def is_vague(name: tuple[Answer, Answer]) -> bool:
    """Whether the 95 % interval of a name's size is wider than the size.

    The size is the effect's first parameter. A ratio stands for it where the recordings fix that alone.
    """
    _, effect = name
    size = next(iter(effect["params"].values()), None)
    if size is None:
        return False
    told = size.get("ratio") or size
    return bool(2.0 * NORMAL_95 * told["std"] > abs(told["value"]))


def is_of_noise(name: tuple[Answer, Answer]) -> bool:
    """Whether noise alone would get a name in more than `NOISE_NAMED` of such recordings, by parametric bootstrap."""
    alarms = name[0].get("false_alarm_rate")
    return bool(alarms and alarms["rate"] > NOISE_NAMED)


def horizons(answer: Answer) -> list[tuple[Answer, Mapping[str, float]]]:
    """The horizons of an answer, each beside it."""
    return [(answer, one) for one in answer["fit"].get("horizons", [])]


def explained_horizons(answer: Answer) -> list[tuple[Answer, Mapping[str, float]]]:
    """The horizons of an explanation at which it leaves an error that matters."""
    if answer["verdict"] != "explained" or not (tolerance := answer.get("tolerance")):
        return []
    return [pair for pair in horizons(answer) if pair[1]["improved"] > tolerance["value"]]


def leaves_most(pair: tuple[Answer, Mapping[str, float]]) -> bool:
    """Whether more than half of the baseline's error above the floor is left at a horizon, and more than matters."""
    answer, at = pair
    half = HALF * max(at["baseline"] - at["floor"], 0.0)
    return bool(at["improved"] - at["floor"] > max(half, answer["tolerance"]["value"]))


def is_worse_untold(pair: tuple[Answer, Mapping[str, float]]) -> bool:
    """Whether the plant that is written errs more than the baseline or the given model, above the tolerance.

    Where the improved plant does, the answer has to say that another one is handed on.
    """
    answer, at = pair
    slack = _WORSE if (at["seconds"] or math.inf) <= _SHORT_S else _WORSE_BEYOND_2_S
    matters = answer["tolerance"]["value"] if answer.get("tolerance") else 0.0
    worse = at["improved"] > max(slack * min(at["given"], at["baseline"]), matters)
    return worse and not any(
        _HANDED_ON in note or "best at every horizon" in note for note in answer["notes"]
    )


def far_moves(answer: Answer) -> list[tuple[Answer, Mapping[str, float]]]:
    """The positive parameters that a re-fit left further than `FACTOR` away, in an answer that names no doubt."""
    if answer["verdict"] == "unexplained":
        return []
    return [
        (answer, moved)
        for moved in answer["refit"].values()
        if moved["from"] > 0.0 and not moved["from"] / FACTOR <= moved["to"] <= moved["from"] * FACTOR
    ]


def is_untold(pair: tuple[Answer, Mapping[str, float]]) -> bool:
    """Whether the answer's sentence says nothing of a re-fit that moved far."""
    return "re-fit moved" not in pair[0]["sentence"]


SENTENCES: Final = (
    Sentence("names below one half that stand alone", told_names, is_improbable_alone),
    Sentence("names with a rival better by 3 nats", told_names, is_beaten),
    Sentence("names whose 95 % interval is wider than the size", told_names, is_vague),
    Sentence("names where noise alone gets one in over 1 %", told_names, is_of_noise),
    Sentence("explained, over half of the error above the floor left", explained_horizons, leaves_most),
    Sentence("horizons at which the written plant is worse, untold", horizons, is_worse_untold),
    Sentence("parameters moved by over three times, untold", far_moves, is_untold),
)
