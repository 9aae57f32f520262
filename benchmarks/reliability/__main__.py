"""`python -m benchmarks.reliability NAME`: the programs behind `make fuzz` and `make soak`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping

from benchmarks.reliability import cuts, flips, full_disk, fuzz, kills, session, stalls, two_clients

FLIPS = 2000
KILLS = 1000
HOURS = 1.0
_BAD = ("LOST", "LINES", "ANSWERED", "WRONG")


def main() -> int:
    """Run what is asked for; 1 if something was lost or a rule broken."""
    given = _arguments()
    if given.program == "fuzz":
        return fuzz.main(given.count, given.seed, given.only)
    parts = _parts(given)
    bad = False
    for name in given.parts or parts:
        for line in parts[name]():
            print(line, flush=True)
            bad = bad or any(word in line for word in _BAD)
    return int(bad)


def _parts(given: argparse.Namespace) -> Mapping[str, Callable[[], Iterator[str]]]:
    return {
        "flips": lambda: flips.report(given.flips, given.seed),
        "cuts": cuts.report,
        "disk": full_disk.report,
        "clients": two_clients.report,
        "stalls": stalls.report,
        "kills": lambda: kills.report(given.kills, given.seed, given.only),
        "session": lambda: session.report(given.hours, given.seed),
    }


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reliability")
    programs = parser.add_subparsers(dest="program", required=True)
    inputs = programs.add_parser("fuzz", help="hostile inputs for every parser")
    inputs.add_argument(
        "--count", type=int, default=fuzz.MILLION, help="with those of earlier runs of this seed"
    )
    inputs.add_argument("--only", default="", help="a part of a parser's name")
    soak = programs.add_parser(
        "soak",
        help="flipped bits, cut links, full disks, two clients, a host that stalls, kills, a long session",
    )
    soak.add_argument(
        "parts", nargs="*", help="flips, cuts, disk, clients, stalls, kills, session; all without"
    )
    soak.add_argument("--flips", type=int, default=FLIPS)
    soak.add_argument(
        "--kills",
        type=int,
        default=KILLS,
        help="of record, of live and of recover each, earlier ones included",
    )
    soak.add_argument("--only", default="", choices=("", "record", "live", "recover"), help="of kills")
    soak.add_argument("--hours", type=float, default=HOURS, help="of virtual time")
    for each in (inputs, soak):
        each.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
