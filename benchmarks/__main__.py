"""Run every module of this folder that has a `report`, or those that are named."""

from __future__ import annotations

import importlib
import os
import pkgutil
import platform
import sys

import benchmarks
from nxt_twin.threads import ask_for_one_thread


def main(wanted: list[str]) -> None:
    """Print the lines of each benchmark under its name."""
    names = [module.name for module in pkgutil.iter_modules(benchmarks.__path__)]
    if unknown := sorted(set(wanted) - set(names)):
        sys.exit(f"benchmarks: there is no {', '.join(unknown)}; there are {', '.join(names)}")
    ask_for_one_thread()  # as the command line does, before anything imports numpy
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    for name in wanted or names:
        if name == "__main__":
            continue
        report = getattr(importlib.import_module(f"benchmarks.{name}"), "report", None)
        if report is not None:
            print(f"\n{name}", flush=True)
            for line in report():
                print(f"  {line}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
