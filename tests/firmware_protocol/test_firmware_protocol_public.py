from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import sys
from pathlib import Path

import firmware_protocol
from firmware_protocol import Command, all_commands
from firmware_protocol.__main__ import table

# How declarations are written is for those who write declarations; the namespaces are exported whole.
INTERNAL = {"wire", "layout", "fields", "__main__"}
NAMESPACES = {"bluetooth", "limits", "ultrasonic", "usb"}


def modules():
    for found in pkgutil.walk_packages(firmware_protocol.__path__, "firmware_protocol."):
        yield importlib.import_module(found.name)


def test_all_is_sorted():
    assert firmware_protocol.__all__ == sorted(firmware_protocol.__all__)


def test_all_holds_every_public_class_and_function_and_the_namespaces():
    public = set(NAMESPACES)
    for module in modules():
        if module.__name__.rpartition(".")[2] in INTERNAL | NAMESPACES:
            continue
        for name, value in vars(module).items():
            declared = inspect.isclass(value) or inspect.isfunction(value)
            if declared and value.__module__ == module.__name__ and not name.startswith("_"):
                public.add(name)
    assert set(firmware_protocol.__all__) == public


def test_everything_in_all_exists():
    assert all(hasattr(firmware_protocol, name) for name in firmware_protocol.__all__)


def test_the_package_needs_the_standard_library_alone_and_nothing_that_does_io():
    imported = set()
    for path in Path(firmware_protocol.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {name.name.partition(".")[0] for name in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.partition(".")[0])
    assert imported - {"firmware_protocol"} <= sys.stdlib_module_names
    assert not imported & {
        "os",
        "sys",
        "io",
        "pathlib",
        "socket",
        "time",
        "subprocess",
        "threading",
        "asyncio",
    }


def test_every_declared_command_is_registered_under_an_opcode_of_its_own():
    declared = set()
    families = Command.__subclasses__()
    for family in families:
        declared |= set(family.__subclasses__())
    assert set(all_commands()) == declared
    assert len({(command.KIND, command.OPCODE) for command in all_commands()}) == len(all_commands())
    assert len({command.NAME for command in all_commands()}) == len(all_commands())


def test_commands_are_listed_by_kind_and_opcode():
    keys = [(command.KIND, command.OPCODE) for command in all_commands()]
    assert keys == sorted(keys)


def test_the_firmwares_opcodes_are_all_there():
    direct = {*range(0x12), 0x13, *range(0x19, 0x22)}
    system = {*range(0x80, 0x8A), 0x8B, 0x8C, 0x8D, 0x90, 0x91, 0x92, 0x94, 0x95, 0x97, 0x98, 0x9A, 0x9B}
    system |= {0xA0, 0xA1, 0xA2, 0xA4}
    opcodes = [(command.KIND, command.OPCODE) for command in all_commands()]
    assert {opcode for kind, opcode in opcodes if kind == 0} == direct
    assert {opcode for kind, opcode in opcodes if kind == 1} == system


def test_the_printed_table_shows_each_telegrams_layout():
    lines = table().splitlines()
    assert len(lines) == 2 + len(all_commands())
    assert "| direct | 09 | MESSAGE_WRITE | mailbox u8, size u8, data bytes[size] | - |" in lines
    assert "| direct | 0B | GET_BATT_LVL | - | voltage_mv u16 |" in lines
    assert all(line.count(" | ") == 4 for line in lines)


def test_the_example_of_the_documentation_runs(capsys):
    page = Path(__file__).parents[2] / "docs" / "protocol.md"
    example = page.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(compile(example, str(page), "exec"), {})
    said = capsys.readouterr().out.strip()
    assert said == example.rpartition("# ")[2].strip()
