"""Viewers that are missing, dead or stuck, ports that are taken, and who may listen."""

from __future__ import annotations

import ast
import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from view_ticks import CHANNELS, PORTS, some_ticks

import nxt_twin
from nxt_twin.errors import NxtTwinError
from nxt_twin.view.dashboard import Dashboard, open_dashboard, viewer
from nxt_twin.view.dashboard.page import page_url, policy
from nxt_twin.view.dashboard.viewer import find_viewer, free_port, listens, require_display, silenced

_POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals")


def _open(view="web", save: Path | None = None, web_port: int = 0) -> Dashboard:
    return open_dashboard(
        view=view, save=save, ports=PORTS, channels=CHANNELS, title="a test's session", web_port=web_port
    )


def test_without_rerun_there_is_one_line_that_says_what_to_install(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(NxtTwinError, match=r"pip install nxt-twin\[view\]") as caught:
        _open()
    assert "\n" not in str(caught.value)


def test_without_rerun_nothing_is_needed_where_nothing_is_shown(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    dashboard = _open("none")
    dashboard.tick(some_ticks(1)[0])
    dashboard.close()
    assert dashboard.processes == ()


def test_without_a_display_no_window_is_tried():
    with pytest.raises(NxtTwinError, match="--view web"):
        require_display({}, "linux")
    require_display({"DISPLAY": ":0"}, "linux")
    require_display({"WAYLAND_DISPLAY": "wayland-0"}, "linux")
    require_display({}, "darwin")


def test_spawn_without_a_display_starts_nothing(monkeypatch):
    monkeypatch.setattr(viewer.os, "environ", {})
    monkeypatch.setattr(viewer.sys, "platform", "linux")
    monkeypatch.setattr("nxt_twin.view.dashboard.require_display", lambda: require_display({}, "linux"))
    with pytest.raises(NxtTwinError, match="there is no display"):
        _open("spawn")


def test_a_port_that_is_taken_is_told():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert listens(port)
        with pytest.raises(NxtTwinError, match=f"port {port} is taken"):
            _open(web_port=port)
    assert free_port() > 0


def test_a_file_that_cannot_be_written_is_told(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(NxtTwinError, match="cannot be written"):
        _open("none", save=blocked / "run.rrd")


def test_only_one_folder_imports_rerun():
    root = Path(nxt_twin.__file__).parent
    importers = {
        path.relative_to(root).parent.as_posix()
        for path in root.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if (isinstance(node, ast.Import) and any(name.name.split(".")[0] == "rerun" for name in node.names))
        or (isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "rerun")
    }
    # The command line may look whether rerun is there.
    assert importers - {"cli"} == {"view/dashboard/drawing"}


def test_opening_a_dashboard_does_not_import_rerun():
    code = "import sys, nxt_twin.view.dashboard; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_all_that_listens_is_bound_to_this_machine():
    dashboard = _open()
    try:
        assert dashboard.url.startswith("http://127.0.0.1:")
        _await_server(dashboard)
        assert _addresses(_family(dashboard.processes[0])) == {"127.0.0.1"}
    finally:
        dashboard.close()


@_POSIX
def test_a_frozen_dashboard_costs_polls_and_nothing_else(tmp_path):
    dashboard = _open(save=tmp_path / "run.rrd")
    shown, written = dashboard.processes
    os.kill(shown, signal.SIGSTOP)
    ticks = some_ticks(4000)
    for tick in ticks:
        dashboard.tick(tick)
    assert dashboard.dropped > 0
    dashboard.close()
    assert any("viewer did not finish in time" in trouble for trouble in dashboard.troubles)
    assert not any("file" in trouble for trouble in dashboard.troubles)
    assert (tmp_path / "run.rrd").stat().st_size > 100_000
    assert _all_end({shown, written})


@_POSIX
def test_a_dashboard_that_was_killed_is_told_and_closing_ends_what_it_started():
    dashboard = _open()
    family = _await_server(dashboard)
    os.kill(dashboard.processes[0], signal.SIGKILL)
    for tick in some_ticks(100):
        dashboard.tick(tick)
    dashboard.close()
    assert any("viewer" in trouble for trouble in dashboard.troubles)
    assert _all_end(family)


@_POSIX
def test_an_ordinary_end_leaves_nothing_behind(tmp_path):
    dashboard = _open(save=tmp_path / "run.rrd")
    family = _await_server(dashboard)
    for tick in some_ticks(50):
        dashboard.tick(tick)
    dashboard.rest()
    assert listens(_data_port(dashboard))
    assert dashboard.serving
    dashboard.close()
    assert _all_end(family)
    assert not listens(_data_port(dashboard))
    assert not dashboard.serving


@_POSIX
def test_a_server_that_is_stuck_is_given_up():
    dashboard = _open()
    family = _await_server(dashboard)
    for pid in family - {dashboard.processes[0]}:
        os.kill(pid, signal.SIGSTOP)
    for tick in some_ticks(3000):
        dashboard.tick(tick)
    dashboard.close()
    assert len(family) > 1
    assert _all_end(family)
    assert not listens(_data_port(dashboard))


def test_usage_reports_are_switched_off_in_a_folder_of_our_own(tmp_path, monkeypatch):
    monkeypatch.setattr(viewer.platformdirs, "user_cache_path", lambda name: tmp_path / name)
    environment = silenced(find_viewer())
    if sys.platform.startswith("linux"):
        told = tmp_path / "nxt-twin" / "rerun-settings" / "rerun" / "analytics.json"
        assert json.loads(told.read_text(encoding="utf-8"))["analytics_enabled"] is False
        assert environment["XDG_CONFIG_HOME"].startswith(str(tmp_path))


def test_the_page_may_talk_to_this_machine_only():
    rule = policy(4711)
    named = {word for part in rule.split(";") for word in part.split()[1:] if "//" in word}
    assert named == {"http://127.0.0.1:4711"}
    assert page_url(1234, 4711).startswith(
        "http://127.0.0.1:1234/?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A4711%2Fproxy"
    )


def _await_server(dashboard: Dashboard) -> set[int]:
    """Wait until the server listens; the ids of the dashboard's process and of what it started."""
    for _ in range(600):
        if listens(_data_port(dashboard)):
            return _family(dashboard.processes[0])
        subprocess.run(["sleep", "0.1"], check=True)
    raise AssertionError("the server did not start")


def _data_port(dashboard: Dashboard) -> int:
    return int(dashboard.url.split("127.0.0.1%3A")[1].split("%2F")[0])


def _family(pid: int) -> set[int]:
    told = subprocess.run(
        ["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False
    )
    return {pid, *map(int, told.stdout.split())}


def _all_end(pids: set[int]) -> bool:
    """Whether all of them end; one that was killed may take the system a moment."""
    for _ in range(100):
        if not any(_runs(pid) for pid in pids):
            return True
        subprocess.run(["sleep", "0.1"], check=True)
    return False


def _runs(pid: int) -> bool:
    state = Path(f"/proc/{pid}/stat")
    if not state.parent.parent.exists():
        return subprocess.run(["kill", "-0", str(pid)], capture_output=True, check=False).returncode == 0
    return state.exists() and state.read_text().rpartition(")")[2].split()[0] != "Z"


def _addresses(pids: set[int]) -> set[str]:
    """Addresses on which any of the processes listens."""
    sockets = set()
    for pid in pids:
        for handle in Path(f"/proc/{pid}/fd").iterdir():
            try:
                target = str(handle.readlink())
            except OSError:
                continue
            if target.startswith("socket:["):
                sockets.add(target[8:-1])
    found = set()
    for table, zero in (("tcp", 8), ("tcp6", 32)):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in sockets:
                found.add(_dotted(fields[1].partition(":")[0], zero))
    return found


def _dotted(address: str, digits: int) -> str:
    if digits != 8:
        return address
    return socket.inet_ntoa(bytes.fromhex(address)[::-1])
