"""Whether a divergence is named and vanishes: live sessions with --adopt on mock bricks that conceal one effect each.

The brick's motor is the benchmark's own simulator, polled over the mock's USB-like link in virtual time.
`python -m benchmarks.twin_adoption EFFECT…` watches these alone.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from benchmarks.steps import motor
from nxt_twin.blind.body import hiding
from nxt_twin.blind.secret import Secret, concealed
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Event, MotorBelief, Tick
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES
from nxt_twin.twin.sinks import Memory

SECONDS: Final = 60.0
SEED: Final = 7
PERIOD_S: Final = 0.01
SHORT: Final = ("spring_load", "constant_load", "quadratic_drag")
LONG: Final = (
    *SHORT,
    "coulomb_friction",
    "viscous_friction",
    "payload_inertia",
    "stiction",
    "voltage_drop",
    "gravity_load",
    "load_dependent_friction",
    "backlash",
    "cogging",
    "power_curve",
    "asymmetric_friction",
)
_MORE: Final = {
    "coulomb_friction": {"coulomb_forward_nm": 0.02, "coulomb_reverse_nm": 0.02},
    "viscous_friction": {"viscous_friction_nm_s_per_rad": 5e-3},
}
"""What the model has already is concealed as more of it."""
_LOOK_S: Final = 10.0


@final
@dataclass(frozen=True)
class Watched:
    """What became of one session.

    Attributes:
        effect: concealed.
        noticed_s: when the divergence was called; None if never.
        panel: what the weighed effects said just before something was adopted: the likeliest, its probability.
        named: effects of the last adopted diagnosis, with what each could be confused with.
        near: ids that those could be confused with.
        adopted_s: when it was adopted first; None if never.
        torque_nm: RMS of the unknown torque in the last ten seconds before adoption and of the session.
        square: mean normalised squared innovation likewise.
        diverging: at the end.
    """

    effect: str
    noticed_s: float | None
    panel: tuple[str, float]
    named: tuple[str, ...]
    near: frozenset[str]
    adopted_s: float | None
    torque_nm: tuple[float, float]
    square: tuple[float, float]
    diverging: bool

    @property
    def verdict(self) -> str:
        """How near the name came; more of what the model has is named by re-fitting it, and by that alone."""
        if self.effect in _MORE:
            return "exact" if self.adopted_s is not None and not self.named else "missed"
        if set(self.named) == {self.effect}:
            return "exact"
        return "among" if self.effect in {*self.named, *self.near} else "missed"

    def line(self) -> str:
        """One row of the table."""
        after = [
            f"{a:.3g} → {b:.3g}" for a, b in ((1e3 * self.torque_nm[0], 1e3 * self.torque_nm[1]), self.square)
        ]
        end = "apart" if self.diverging else "together"
        when = "never" if self.noticed_s is None else f"{self.noticed_s:.1f} s"
        what = ", ".join(self.named) or ("re-fitted only" if self.adopted_s is not None else "nothing")
        return (
            f"{self.effect:24} noticed {when:>7}  panel: {self.panel[0]} {self.panel[1]:.2f}  named: {what} "
            f"({self.verdict})  torque {after[0]} mN·m  square {after[1]}  {end}"
        )


def report() -> Iterator[str]:
    """Lines for `make bench`."""
    return table(SHORT)


def table(effects: Iterable[str]) -> Iterator[str]:
    """A row for each concealed effect, then how many came out."""
    found = []
    for effect in effects:
        found.append(watch(effect))
        yield found[-1].line()
    yield from _sums(found)


def _sums(found: Sequence[Watched]) -> Iterator[str]:
    right = [each for each in found if each.verdict == "exact"]
    listed = [each for each in found if each.effect in DEFAULT_CANDIDATES]
    hits = sum(each.panel[0] == each.effect for each in listed)
    calm = sum(not each.diverging for each in right)
    noticed = sum(each.noticed_s is not None for each in found)
    held = sum(each.verdict != "missed" for each in found)
    yield (
        f"of {len(found)}: noticed {noticed}, named exactly {len(right)}, held {held}; of those named exactly, "
        f"together at the end {calm}; the panel had the right one first in {hits} of the {len(listed)} that it weighs"
    )


def watch(effect: str) -> Watched:
    """One session in virtual time."""
    clock = VirtualClock()
    link = open_mock_link(
        clock,
        profile="usb",
        seed=3,
        change=hiding(_secret(effect)),
        late=LinkTimeoutError,
        lost=LinkLostError,
    )
    memory, adopter = Memory(10**6), Adopter(AtOnce())
    session = Session(
        Parts(
            open_brick=lambda: Brick(link, clock),
            clock=clock,
            twin=BrickTwin({"a": motor()}),
            sink=memory,
            plan=Plan(period_s=PERIOD_S),
            pace=PACES["usb"],
            driver=ProgramDriver(excitation(("a",))),
            adopter=adopter,
        )
    )
    session.run(SECONDS)
    return _judged(effect, memory, adopter, diverging=session.monitors["a"].diverging)


def _secret(effect: str) -> Secret:
    if effect not in _MORE:
        return concealed(SEED, effects=(effect,), size="medium")
    plain = concealed(SEED, effects=())
    return replace(plain, motor=replace(plain.motor, **_MORE[effect]))


def _judged(effect: str, memory: Memory, adopter: Adopter, *, diverging: bool) -> Watched:
    noticed = _first(memory.events, "divergence")
    adopted = _first(memory.events, "adopted")
    adopted_s = None if adopted is None else adopted.time_s
    ticks = [tick for tick in memory.ticks if tick.motors]
    before = [tick for tick in ticks if tick.received_s < (adopted_s or SECONDS)]
    state = before[-1].motors[0]
    diagnoses = [diagnosis for _, diagnosis in adopter.diagnoses if diagnosis.effects]
    last = diagnoses[-1].effects if diagnoses else ()
    return Watched(
        effect=effect,
        noticed_s=None if noticed is None else noticed.time_s,
        panel=_likeliest(state),
        named=tuple(each.id for each in last),
        near=frozenset(other.id for each in last for other in each.confusable_with),
        adopted_s=adopted_s,
        torque_nm=(_torque_nm(_last(before)), _torque_nm(_last(ticks))),
        square=(_square(_last(before)), _square(_last(ticks))),
        diverging=diverging,
    )


def _first(events: Sequence[Event], kind: str) -> Event | None:
    return next((event for event in events if event.kind == kind), None)


def _likeliest(state: MotorBelief) -> tuple[str, float]:
    name = max(state.effects, key=lambda each: state.effects[each])
    return name, state.effects[name]


def _last(ticks: Sequence[Tick]) -> list[Tick]:
    return [tick for tick in ticks if tick.received_s > ticks[-1].received_s - _LOOK_S]


def _torque_nm(ticks: Sequence[Tick]) -> float:
    return float(np.sqrt(np.mean([tick.motors[0].unknown_torque_nm ** 2 for tick in ticks])))


def _square(ticks: Sequence[Tick]) -> float:
    return float(np.mean([each.normalised_square for tick in ticks for each in tick.innovations]))


if __name__ == "__main__":
    for line in table(sys.argv[1:] or LONG):
        print(line, flush=True)
