"""The viewer's program: where it is, whether it can open, and how it is started."""

from __future__ import annotations

import importlib.util
import os
import socket
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final, Literal

import platformdirs

from nxt_twin.errors import NxtTwinError

LOOPBACK: Final = "127.0.0.1"
VIEWER_MEMORY: Final = "1GiB"
SERVER_MEMORY: Final = "256MiB"

_PROBE_S: Final = 0.1
_PROGRAMS: Final = ("Rerun.app/Contents/MacOS/Rerun", "rerun", "rerun.exe")


def find_viewer() -> Path:
    """The viewer's program, without importing anything of it.

    It is the program proper, not the script of that name: that would stand between us and what we have to end.

    Raises:
        NxtTwinError: it is not installed.
    """
    mend = "pip install nxt-twin[view]"
    found = importlib.util.find_spec("rerun_cli")
    if importlib.util.find_spec("rerun") is None or found is None:
        raise NxtTwinError("the dashboard needs rerun, which is not installed", mend=mend)
    for folder in found.submodule_search_locations or ():
        for name in _PROGRAMS:
            if (Path(folder) / name).is_file():
                return Path(folder) / name
    raise NxtTwinError("rerun is installed without its viewer's program", mend=mend)


def require_display(environment: Mapping[str, str] = os.environ, platform: str = sys.platform) -> None:
    """See to it that a window can be opened.

    Raises:
        NxtTwinError: there is no display.
    """
    if platform.startswith("linux") and not (
        environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY")
    ):
        raise NxtTwinError(
            "there is no display to open the dashboard on",
            mend="--view web serves it to a browser, --save FILE.rrd keeps it for later",
        )


def free_port(wanted: int = 0) -> int:
    """`wanted` if nothing listens there, or any free port for 0.

    Raises:
        NxtTwinError: the port is taken.
    """
    with socket.socket() as probe:
        if sys.platform != "win32":
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, wanted))
        except OSError as error:
            raise NxtTwinError(
                f"port {wanted} is taken", where="the dashboard", mend="choose another one, or 0 for any"
            ) from error
        return int(probe.getsockname()[1])


def listens(port: int) -> bool:
    """Whether something on this machine takes connections at `port`."""
    with socket.socket() as probe:
        probe.settimeout(_PROBE_S)
        return probe.connect_ex((LOOPBACK, port)) == 0


def start_viewer(
    program: Path, kind: Literal["spawn", "web"], *, port: int, page_port: int
) -> subprocess.Popen[bytes]:
    """Start the native viewer, or the server of the web viewer's parts; bound to this machine alone.

    The native viewer lives on when the session ends, the server ends with who started it.
    """
    command = [
        str(program),
        f"--bind={LOOPBACK}",
        f"--port={port}",
        f"--memory-limit={VIEWER_MEMORY}",
        f"--server-memory-limit={SERVER_MEMORY}",
        "--hide-welcome-screen",
    ]
    if kind == "web":
        command += ["--serve-web", f"--web-viewer-port={page_port}"]
    else:
        command += ["--expect-data-soon"]
    return subprocess.Popen(  # noqa: S603 - the command is ours
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=silenced(program),
        start_new_session=kind == "spawn",
    )


def silenced(program: Path) -> dict[str, str]:
    """The environment for rerun's programs, with its usage reports switched off.

    On Linux in a settings folder of our own; elsewhere in rerun's own settings, as `rerun analytics disable` does.
    """
    folder = platformdirs.user_cache_path("nxt-twin") / "rerun-settings"
    environment = {**os.environ}
    if sys.platform.startswith("linux"):
        environment["XDG_CONFIG_HOME"] = str(folder)
    if not (folder / "silenced").exists():
        folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(  # noqa: S603 - the command is ours
            [str(program), "analytics", "disable"], env=environment, capture_output=True, check=False
        )
        if done.returncode == 0:
            (folder / "silenced").touch()
    return environment
