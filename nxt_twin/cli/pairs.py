"""`nxt-twin blind changed`: pairs of recordings before and after a touch: make, solve, reach, score."""

from __future__ import annotations

import json as json_format
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.follow import follow_cases
from nxt_twin.cli.output import JsonOption, emit_json

CasesArgument = Annotated[Path, typer.Argument(help="Folder for the pairs, one case each.")]
AnswersArgument = Annotated[Path, typer.Argument(help="Another folder, for the sealed answers.")]
FoundArgument = Annotated[Path, typer.Argument(help="Folder for one JSON a pair.")]
JobsOption = Annotated[int, typer.Option(min=1, help="Processes that share the work.")]

pairs = typer.Typer(
    no_args_is_help=True,
    help="Pairs of recordings before and after a touch: make, solve, reach and score them.",
)


@pairs.command()
def make(
    cases: CasesArgument,
    answers: AnswersArgument,
    seed: Annotated[int, typer.Option(help="Of the whole set.")] = 1,
    family: Annotated[
        str, typer.Option(help="Truth families, comma-separated.")
    ] = "bristle,mujoco,stiff,workshop",
    none: Annotated[int, typer.Option(min=0, help="Pairs in which nothing changes.")] = 40,
    one: Annotated[int, typer.Option(min=0, help="Pairs with one change.")] = 40,
    two: Annotated[int, typer.Option(min=0, help="Pairs with two changes.")] = 40,
    jobs: JobsOption = 1,
) -> None:
    """Record motors before and after they are touched, and seal what was done."""
    from nxt_twin.blind.families.orders import families_of
    from nxt_twin.blind.pairs.make import make_pairs, plan_pairs
    from nxt_twin.fleet.workers.place import place_of

    names = [each.name for each in families_of(family.split(","))]
    plans = plan_pairs(seed, names, none=none, one=one, two=two)
    follow_cases("making pairs", make_pairs(plans, cases, answers, place=place_of(jobs, None)), len(plans))
    print(f"{len(plans)} pairs in {cases}, answers in {answers}")


@pairs.command()
def solve(cases: CasesArgument, out: FoundArgument, jobs: JobsOption = 1) -> None:
    """Say of every pair what changed; pairs that have their JSON already are passed over."""
    from nxt_twin.blind.pairs.score import solve_pairs
    from nxt_twin.blind.solve import case_folders
    from nxt_twin.fleet.workers.place import place_of

    folders = case_folders(cases)
    follow_cases("solving", solve_pairs(folders, out, place=place_of(jobs, None)), len(folders))
    print(f"{len(folders)} pairs, answers in {out}")


@pairs.command()
def reach(cases: CasesArgument, answers: AnswersArgument, out: FoundArgument, jobs: JobsOption = 1) -> None:
    """Fit the true changes to every pair: whether its recordings show them at all."""
    from nxt_twin.blind.pairs.reach import reach_pairs
    from nxt_twin.blind.solve import case_folders
    from nxt_twin.fleet.workers.place import place_of

    folders = case_folders(cases)
    follow_cases("reaching", reach_pairs(folders, answers, out, place=place_of(jobs, None)), len(folders))
    print(f"{len(folders)} pairs, what the true changes gain in {out}")


@pairs.command()
def score(
    cases: CasesArgument,
    answers: AnswersArgument,
    found: FoundArgument,
    reached: Annotated[Path | None, typer.Option(help="Folder of what the true changes gain.")] = None,
    json: JsonOption = None,
) -> None:
    """Hold what is said to have changed against the sealed answers: the shares, and what was wrong."""
    from nxt_twin.blind.aims import as_text
    from nxt_twin.blind.pairs.score import aims_of_pairs, as_lines, score_pairs

    judged = score_pairs(cases, answers, found, reached)
    if json:
        emit_json(
            json, json_format.dumps({"schema": "nxt-twin/pairs/1", "pairs": [asdict(one) for one in judged]})
        )
    if json != "-":
        print(as_text(aims_of_pairs(judged)))
        print(as_lines(judged), end="")
