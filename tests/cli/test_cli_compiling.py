"""The first command on a machine says on a terminal what it compiles; later ones, and pipes, are not told."""

import pytest

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
    assert ("about 20 s, once" in capsys.readouterr().err) is told
