"""`nxt-twin blind`: the concealed-effect benchmark: make cases, solve them, score the answers."""

from __future__ import annotations

import json as json_format
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.follow import follow_cases
from nxt_twin.cli.output import JsonOption, emit_json, fail, progress
from nxt_twin.cli.pairs import pairs as changed
from nxt_twin.cli.proof import proof

if TYPE_CHECKING:
    from nxt_twin.blind.families.family import Family
    from nxt_twin.blind.polling import LinkName
    from nxt_twin.blind.silence import Remains
    from nxt_twin.fleet.workers.place import Place

# Each command imports what it needs when it runs: its help would wait a second for the simulators.
_BRISTLE, _ALL = "bristle", "all"
_LINKS: dict[str, tuple[LinkName, ...]] = {
    "usb": ("usb",),
    "bluetooth": ("bluetooth",),
    "both": ("usb", "bluetooth"),
}

EffectsOption = Annotated[
    str | None, typer.Option(help="Only these effect ids, comma-separated; none: no single effects.")
]
FamilyOption = Annotated[
    str, typer.Option(help="Truth families, comma-separated, or all; nxt-twin blind families lists them.")
]
CleanOption = Annotated[int, typer.Option(min=0, help="Cases of each family in which nothing is missing.")]
PairsOption = Annotated[int, typer.Option(min=0, help="Cases of each family with two effects.")]
TriplesOption = Annotated[int, typer.Option(min=0, help="Cases of each family with three effects.")]
UnknownOption = Annotated[
    int, typer.Option(min=0, help="Cases of each family with an effect that no library holds.")
]
JobsOption = Annotated[int, typer.Option(min=1, help="Processes that share the work.")]
ClusterOption = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS", help="A Dask scheduler whose workers do the work; they see these folders."
    ),
]

blind = typer.Typer(no_args_is_help=True, help="The concealed-effect benchmark: make, solve and score cases.")
blind.add_typer(changed, name="changed")
blind.command()(proof)


@blind.command()
def make(
    cases: Annotated[Path, typer.Argument(help="Folder for the cases.")],
    answers: Annotated[Path, typer.Argument(help="Another folder, for the sealed answers.")],
    seed: Annotated[int, typer.Option(help="Random seed of the set.")] = 1,
    family: FamilyOption = _BRISTLE,
    effects: EffectsOption = None,
    clean: CleanOption = 40,
    pairs: PairsOption = 30,
    triples: TriplesOption = 10,
    unknown: UnknownOption = 10,
    link: Annotated[str, typer.Option(help="usb, bluetooth, or both in turn, for bristle.")] = "both",
    duration: Annotated[
        float | None, typer.Option(min=5.0, help="Length of a recording, s; by default the family's.")
    ] = None,
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
) -> None:
    """Make a set of each family: every effect in three sizes, clean ones, combinations, and unknown ones."""
    if link not in _LINKS:
        raise typer.BadParameter(f"'{link}' is none of {', '.join(_LINKS)}", param_hint="--link")
    from nxt_twin.blind.families.orders import Amounts, make_orders, plan_orders

    amounts = Amounts(_chosen(effects), clean, pairs, triples, unknown)
    orders = plan_orders(_families(family), seed, amounts, links=_LINKS[link], duration_s=duration)
    follow_cases(
        "making cases", make_orders(orders, cases, answers, place=_place(jobs, cluster)), len(orders)
    )
    print(f"{len(orders)} cases in {cases}, answers in {answers}")


@blind.command()
def families() -> None:
    """List the truth families: what simulates each, and which effects it can hide."""
    from nxt_twin.blind.families.table import FAMILIES

    every = sorted({effect for family in FAMILIES.values() for effect in family.known})
    for family in FAMILIES.values():
        lacking = [effect for effect in every if effect not in family.known]
        print(f"{family.name}: {family.simulator}")
        print(
            f"  hides {len(family.known)} of {len(every)} effects; left out: {', '.join(lacking) or 'none'}"
        )
        print(f"  in nobody's library: {', '.join(family.unknown)}")


@blind.command()
def seal(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases.")],
    truths: Annotated[Path, typer.Argument(help="Folder of what each hides: NAME.yaml or NAME.json.")],
    answers: Annotated[Path, typer.Argument(help="Another folder, for the sealed answers.")],
) -> None:
    """Seal what cases of your own simulator hide, so that they can be solved and scored."""
    from nxt_twin.blind.sealed import seal_cases
    from nxt_twin.blind.solve import case_folders
    from nxt_twin.errors import CaseError

    folders = case_folders(cases)
    if not folders:
        raise CaseError(
            "holds no case", where=str(cases), mend="name the folder of the folders with a case.yaml"
        )
    print(f"{seal_cases(folders, truths, answers)} of {len(folders)} cases sealed, answers in {answers}")


@blind.command()
def solve(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases.")],
    out: Annotated[Path, typer.Argument(help="Folder for one JSON a case.")],
    seed: Annotated[int, typer.Option(help="Random seed of the diagnoses.")] = 0,
    without: Annotated[
        str, typer.Option(help="Effect ids that the diagnoses must not try, comma-separated.")
    ] = "",
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
) -> None:
    """Diagnose every case of a folder; skip cases that have their JSON already."""
    from nxt_twin.blind.solve import case_folders, solve_all

    tell_of_compiling()
    folders = case_folders(cases)
    hidden = dict.fromkeys((folder.name for folder in folders), frozenset(filter(None, without.split(","))))
    follow_cases(
        "solving",
        solve_all(folders, out, seed=seed, place=_place(jobs, cluster), without=hidden),
        len(folders),
    )
    print(f"{len(folders)} cases, diagnoses in {out}")


@blind.command()
def reach(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases, which carry the seals.")],
    answers: Annotated[Path, typer.Argument(help="Folder of the answers.")],
    out: Annotated[Path, typer.Argument(help="Folder for one JSON a case.")],
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
) -> None:
    """Fit the true structure to every case: whether its effects are detectable, and the error that it reaches."""
    from nxt_twin.blind.solve import case_folders, reach_all

    tell_of_compiling()
    folders = case_folders(cases)
    follow_cases("reaching", reach_all(folders, answers, out, place=_place(jobs, cluster)), len(folders))
    print(f"{len(folders)} cases, what the truth reaches in {out}")


@blind.command()
def score(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases, which carry the seals.")],
    answers: Annotated[Path, typer.Argument(help="Folder of the answers.")],
    diagnoses: Annotated[Path, typer.Argument(help="Folder of the diagnoses.")],
    reached: Annotated[Path | None, typer.Option(help="Folder of what the true structures reach.")] = None,
    json: JsonOption = None,
) -> None:
    """Compare diagnoses with the sealed answers and print the table."""
    from nxt_twin.blind.score import score as score_answers

    table = score_answers(cases, answers, diagnoses, reached)
    if json:
        emit_json(json, json_format.dumps(table.as_dict()))
    if json != "-":
        print(table.as_text())


@blind.command()
def peers(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases, which carry the seals.")],
    answers: Annotated[Path, typer.Argument(help="Folder of the answers.")],
    out: Annotated[Path, typer.Argument(help="Folder for the methods' answers, one folder each.")],
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
    diagnoses: Annotated[
        Path | None, typer.Option(help="Folder of nxt-twin's diagnoses, to put beside them.")
    ] = None,
) -> None:
    """Let other methods diagnose these cases, and score them."""
    from nxt_twin.blind.peers.answers import PEERS, answer_all
    from nxt_twin.blind.peers.localised import OURS, localise_all
    from nxt_twin.blind.peers.rows import peer_rows
    from nxt_twin.blind.score import score as score_answers
    from nxt_twin.blind.solve import case_folders
    from nxt_twin.blind.tables import as_text

    if not find_spec("pysindy"):
        fail("pysindy is not installed; mend: pip install 'nxt-twin[proof]'")
        raise typer.Exit(1)
    folders = case_folders(cases)
    follow_cases("letting others answer", answer_all(folders, out, _place(jobs, cluster)), len(folders))
    named = {OURS: diagnoses} if diagnoses else {}
    cells = localise_all(folders, answers, out, named)
    every = {**named, **{peer.name: out / peer.name for peer in PEERS}}
    judged = {method: score_answers(cases, answers, given).cases for method, given in every.items()}
    print("\n".join(f"{peer.name}: {peer.words}" for peer in PEERS) + "\n")
    print(as_text(peer_rows(judged, cells)))


@blind.command()
def silence(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases, which carry the seals.")],
    answers: Annotated[Path, typer.Argument(help="Folder of the answers.")],
) -> None:
    """Print how far clean motors are from the plain model: the residual of windows of 2 s after its best fit."""
    from nxt_twin.blind.silence import remains_of

    found: dict[str, list[Remains]] = {}
    for family, name, left in remains_of(cases, answers):
        found.setdefault(family, []).append(left)
        print(
            f"{name:16} {left.rms_deg:6.2f} deg, worst window {left.worst_deg:6.2f}, encoder {left.step_deg:g}"
        )
    for family, each in found.items():
        rms = sorted(left.rms_deg for left in each)
        print(f"{family}: {len(rms)} clean, median {rms[len(rms) // 2]:.2f} deg, largest {rms[-1]:.2f}")


@blind.command()
def reveal(
    conceal: Annotated[
        str,
        typer.Argument(
            help="The seed or file given to mock --conceal or mock:?conceal=.", metavar="SEED|FILE"
        ),
    ],
    json: JsonOption = None,
) -> None:
    """Print the effects that a mock brick conceals."""
    from nxt_twin.blind.secret import secret_of

    truth = secret_of(conceal).revealed()
    if json:
        emit_json(json, json_format.dumps({"schema": "nxt-twin/reveal/1", **truth}))
    if json != "-":
        for effect in truth["effects"]:
            params = ", ".join(f"{name} = {value:.4g}" for name, value in effect["params"].items())
            print(f"port {truth['port'].upper()}: {effect['id']} ({params})")
        if not truth["effects"]:
            numbers = ", ".join(f"{name} = {value:.4g}" for name, value in truth["motor"].items())
            print(f"port {truth['port'].upper()}: {numbers or 'nothing is concealed'}")


@blind.command()
def bench(
    folder: Annotated[Path, typer.Argument(help="Folder for all files; a second run continues.")],
    seed: Annotated[int, typer.Option(help="Random seed of the set.")] = 1,
    family: FamilyOption = _BRISTLE,
    effects: EffectsOption = None,
    clean: CleanOption = 40,
    pairs: PairsOption = 30,
    triples: TriplesOption = 10,
    unknown: UnknownOption = 10,
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
    json: JsonOption = None,
) -> None:
    """Make a set, solve it, fit the true structures, score it, and print the table with the aims."""
    from nxt_twin.blind.families.orders import Amounts, make_orders, plan_orders
    from nxt_twin.blind.solve import case_folders, reach_all, solve_all

    cases, answers, diagnoses, reached = (
        folder / name for name in ("cases", "answers", "diagnoses", "reached")
    )
    amounts = Amounts(_chosen(effects), clean, pairs, triples, unknown)
    orders = plan_orders(_families(family), seed, amounts)
    follow_cases(
        "making cases", make_orders(orders, cases, answers, place=_place(jobs, cluster)), len(orders)
    )
    tell_of_compiling()
    folders = case_folders(cases)
    follow_cases("solving", solve_all(folders, diagnoses, seed=0, place=_place(jobs, cluster)), len(folders))
    follow_cases("reaching", reach_all(folders, answers, reached, place=_place(jobs, cluster)), len(folders))
    score(cases, answers, diagnoses, reached, json)


@blind.command()
def robots(
    folder: Annotated[Path, typer.Argument(help="Folder for one JSON a case; a second run continues.")],
    seed: Annotated[int, typer.Option(help="Random seed of the first case; the other cases count on.")] = 1,
    singles: Annotated[int, typer.Option(min=0, help="Cases with one effect, in turn.")] = 60,
    pairs: Annotated[int, typer.Option(min=0, help="Cases with two effects.")] = 20,
    clean: Annotated[int, typer.Option(min=0, help="Cases in which nothing is missing.")] = 30,
    unknown: Annotated[int, typer.Option(min=0, help="Cases with an effect that no library holds.")] = 10,
    jobs: JobsOption = 1,
    cluster: ClusterOption = None,
) -> None:
    """Make, solve and score concealed robots on two wheels, and print the table with the aims."""
    from nxt_twin.blind.robot.bench import plan_robots, robots_as_text, solve_robots

    plans = plan_robots(seed, singles=singles, pairs=pairs, clean=clean, unknown=unknown)
    outcomes = []
    with progress("robots") as tell:
        for number, outcome in enumerate(solve_robots(plans, folder, _place(jobs, cluster)), start=1):
            tell(f"{number} of {len(plans)}")
            outcomes.append(outcome)
    print(robots_as_text(sorted(outcomes, key=lambda one: one.plan.seed)))


def _families(names: str) -> tuple[Family, ...]:
    from nxt_twin.blind.families.orders import families_of
    from nxt_twin.blind.families.table import FAMILIES

    return families_of(tuple(FAMILIES) if names == _ALL else names.split(","))


def _chosen(effects: str | None) -> tuple[str, ...] | None:
    if effects == "none":
        return ()
    return tuple(effects.split(",")) if effects else None


def _place(jobs: int, cluster: str | None) -> Place:
    from nxt_twin.fleet.workers.place import place_of

    return place_of(jobs, cluster)
