"""Programs of `examples/worlds`, run unchanged in a world, and what the world saw of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import Ran, run_program
from nxt_twin.world.trace import Trace

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / "examples" / "worlds"


@dataclass(frozen=True)
class Run:
    arena: Arena
    trace: Trace
    ran: Ran


def run(world: str, program: str, *arguments: str) -> Run:
    arena = open_arena(load_setting(world))
    trace = Trace(arena)
    ran = run_program(arena, PROGRAMS / program, arguments, limit_s=60.0)
    assert (ran.ending, ran.said) == ("done", "")
    return Run(arena, trace, ran)
