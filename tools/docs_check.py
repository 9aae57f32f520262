"""Check that the docs are whole: no dead link, and a place for each verb, option, key, effect and exit status."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

import cli_page
import house_pages
from pydantic import BaseModel

from nxt_twin.diagnose import sensor
from nxt_twin.diagnose.telling import to_json
from nxt_twin.fleet.finding.fleet_file import FleetFile
from nxt_twin.fleet.row import SCHEMA
from nxt_twin.physics.effects import BUILT_IN
from nxt_twin.physics.layout import BASE_OWNER, BASES, layout
from nxt_twin.physics.robot import drive
from nxt_twin.recording import mapping
from nxt_twin.recording.case import CaseFile
from nxt_twin.recording.program import MotorProgram, Run, Segment
from nxt_twin.recording.robot_path import Leg, RobotPath

ROOT: Final = Path(__file__).parents[1]

_MODELS: Final[dict[str, tuple[type[BaseModel], ...]]] = {
    "Mapping files": (
        mapping.Mapping, mapping.TableFormat, mapping.TimeSource, mapping.InputSource, mapping.OutputSource,
        mapping.SupplySource, mapping.ModeSource, mapping.SplitColumn,
    ),
    "Cases": (CaseFile,),
    "Motor programs": (MotorProgram, Run, Segment),
    "Robot paths": (RobotPath, Leg),
}  # fmt: skip


def main() -> int:
    """Print every finding; 1 if there is one."""
    found = list(findings(ROOT))
    print(*found, sep="\n", end="\n" if found else "")
    if not found:
        print("the docs are whole: links, pages of the site, verbs, options, keys, effects, exit statuses")
    return 1 if found else 0


def findings(root: Path) -> Iterator[str]:
    """Each gap of the docs below `root`, as one line."""
    yield from house_pages.pages(root)
    yield from unlisted(root)
    yield from verbs(prose(root))
    formats = (root / "docs" / "formats.md").read_text(encoding="utf-8")
    yield from keys(formats)
    fleet = (root / "docs" / "fleet.md").read_text(encoding="utf-8")
    yield from _missing("fleet", fleet, "What it finds", FleetFile.model_fields)
    yield from _missing("fleet", fleet, "The table", SCHEMA.names)
    yield from statuses(formats, root / "nxt_twin" / "cli")
    for page in ("effects", "sensors", "robots"):
        yield from effects(page, (root / "docs" / f"{page}.md").read_text(encoding="utf-8"))


def prose(root: Path) -> str:
    """All pages that people wrote."""
    pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
    return "\n".join(page.read_text(encoding="utf-8") for page in pages)


def unlisted(root: Path) -> Iterator[str]:
    """Pages that the site's navigation leaves out; decisions have a list of their own."""
    nav = (root / "mkdocs.yml").read_text(encoding="utf-8")
    for page in sorted((root / "docs").rglob("*.md")):
        name = page.relative_to(root / "docs").as_posix()
        if name not in nav and not name.startswith("decisions/"):
            yield f"docs/{name}: stands in no part of the site; add it to nav in mkdocs.yml"


def verbs(text: str) -> Iterator[str]:
    """Commands that no page calls, and arguments and options whose help says nothing."""
    for names, command in cli_page.commands():
        words = names.split()
        if not re.search(rf"(?:nxt-twin |`){' '.join(words)}\b", text):
            yield f"nxt-twin {names}: no page tells of this command; write `nxt-twin {names}` in one"
        if not (command.help or "").strip():
            yield f"nxt-twin {names}: says nothing of itself; write its docstring"
        for one in cli_page.parameters(command):
            if not (one.help or "").strip():
                yield f"nxt-twin {names} {'/'.join(one.opts)}: has no help"


def keys(formats: str) -> Iterator[str]:
    """Keys of mappings, cases, programs, paths, plants and answers that the page of formats leaves out."""
    for section, models in _MODELS.items():
        read = {key for model in models for key in model.model_fields}
        yield from _missing("formats", formats, section, read - {"name"})
    yield from _missing("formats", formats, "Plant files", _plant_keys())
    written = ast.parse(Path(to_json.__file__).read_text(encoding="utf-8"))
    dicts = (node for node in ast.walk(written) if isinstance(node, ast.Dict))
    said = {key.value for node in dicts for key in node.keys if isinstance(key, ast.Constant)}
    yield from _missing("formats", formats, "Diagnosis JSON", map(str, said))


def _plant_keys() -> set[str]:
    """The keys of every kind of plant; those of a robot's own body stand on the robots' page."""
    frames = [layout(base.kind, frame) for base in BASES.values() for frame in sorted(base.frames)]
    axis = {
        parameter.in_frame(plan.frame).name
        for plan in frames
        for parameters in (plan.base.parameters, *(e.parameters for e in plan.effects if e.plain))
        for parameter in parameters
    }
    robot = {name for names in drive.GEOMETRY_EFFECTS.values() for name in names} - {
        "mean_wheel_radius_m",
        "wheel_radius_ratio",
    }
    return {"kind", "effects", *axis, *robot} - {BASE_OWNER}


def _missing(page: str, text: str, section: str, wanted: Iterable[str]) -> Iterator[str]:
    for key in sorted(set(wanted) - named(text, section)):
        yield f"docs/{page}.md, {section}: leaves out the key '{key}'"


def named(page: str, section: str) -> set[str]:
    """Every name in code marks, and every word of the examples, of one section; the empty set without that section."""
    _, _, after = page.partition(f"\n## {section}\n")
    body = after.split("\n## ")[0]
    return set(re.findall(r"[\w/]+", " ".join(re.findall(r"`[^`]+`|(?m:^    .*$)", body))))


def effects(page: str, text: str) -> Iterator[str]:
    """Effects of motors, sensors or robots that their page leaves out."""
    ids = {
        "effects": [effect.id for effect in BUILT_IN],
        "sensors": sorted(_of_sensors()),
        "robots": [*drive.GEOMETRY_EFFECTS, *drive.OTHER_EFFECTS, *drive.DYNAMIC_EFFECTS],
    }
    for effect in ids[page]:
        if f"`{effect}`" not in text:
            yield f"docs/{page}.md: leaves out the effect '{effect}'"


def _of_sensors() -> set[str]:
    declared = Path(sensor.__path__[0]).glob("*_effects.py")
    return {
        found for path in declared for found in re.findall(r'\bid="(\w+)"', path.read_text(encoding="utf-8"))
    }


def statuses(formats: str, cli: Path) -> Iterator[str]:
    """Exit statuses that a command leaves with and the page of formats does not tell."""
    told = set(re.findall(r"^\| (\d+) \|", formats.partition("\n## Exit statuses\n")[2], re.MULTILINE))
    for path in sorted(cli.glob("*.py")):
        for number, status in _left_with(path):
            if status not in told:
                yield f"{path.name}:{number}: leaves with {status}, which docs/formats.md, Exit statuses, leaves out"


def _left_with(path: Path) -> Iterator[tuple[int, str]]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("sys.exit", "typer.Exit", "SystemExit"):
            for given in (*node.args, *(keyword.value for keyword in node.keywords)):
                if isinstance(given, ast.Constant):
                    yield node.lineno, str(given.value)


if __name__ == "__main__":
    sys.exit(main())
