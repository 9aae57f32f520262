"""The first command on a machine says on a terminal what it compiles; later ones, and pipes, are not told."""

from importlib import import_module

import pytest

from nxt_twin.cli.app import program
from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.physics.kernel import CACHE_VARIABLE, kernel
from nxt_twin.physics.layout import layout


@pytest.mark.parametrize(
    ("terminal", "cached", "told"), [(True, False, True), (True, True, False), (False, False, False)]
)
def test_only_the_first_command_on_a_terminal_says_so(terminal, cached, told, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr("sys.stderr.isatty", lambda: terminal)
    if cached:
        kernel.__wrapped__(layout("dc_motor", "motor"))  # writes the module, which nothing has called yet
        (module,) = tmp_path.glob("*.py")
        (tmp_path / "__pycache__").mkdir(exist_ok=True)
        (tmp_path / "__pycache__" / f"{module.stem}.run_many-1.py311.nbi").touch()
    tell_of_compiling()
    assert ("half a minute of an idle core, once" in capsys.readouterr().err) is told


@pytest.mark.parametrize(
    "line",
    [
        ("mock", "--tcp", "127.0.0.1:0"),
        ("live", "mock:", "--seconds", "1"),
        ("replay", "run.csv"),
        ("demo",),
        ("drive", "nudge", "mock:"),
        ("fleet", "diagnose", "runs"),
        ("world", "bench"),
        ("blind", "solve", "cases", "out"),
        ("identify", "motor_steps", "mock:", "--out", "steps"),
    ],
)
def test_a_command_says_so_before_it_keeps_anybody_waiting(line, tmp_path, monkeypatch):
    class SaidSoError(Exception):
        """Ends the command where it would have told."""

    def said():
        raise SaidSoError

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(import_module(f"nxt_twin.cli.{line[0]}"), "tell_of_compiling", said)
    with pytest.raises(SaidSoError):
        program([line[0]])(list(line), standalone_mode=False)
    assert not list(tmp_path.iterdir())
