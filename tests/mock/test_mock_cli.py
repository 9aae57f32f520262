"""The command `mock`, and the URL `mock:`, as a user has them."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest
from typer.testing import CliRunner

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError, LinkUrlError
from nxt_twin.brick.open import open_brick, open_link
from nxt_twin.brick.search.tcp import LOCAL_ADDRESS
from nxt_twin.cli.app import program
from nxt_twin.errors import NxtTwinError
from nxt_twin.mock import run as run_module
from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.run import parse_address, serve
from nxt_twin.mock.serve.clock import VirtualClock

WORKSHOP = Path(__file__).parents[2] / "configs" / "worlds" / "workshop.yaml"


def run(*arguments: str):
    return CliRunner().invoke(program(["connect", "mock"]), arguments)


def test_connect_reaches_a_brick_in_its_own_process():
    printed = json.loads(run("connect", "mock:", "--json", "-").stdout)
    assert (printed["firmware"], printed["protocol"]) == ("1.29", "1.124")
    assert 7.0 <= printed["battery_v"] <= 9.0


def test_a_mock_brick_in_process_takes_a_world_and_a_seed():
    with open_brick(f"mock:?world={WORKSHOP}&seed=4", VirtualClock(), OPENERS) as brick:
        assert brick.device.info().value.name == "Workshop"


@pytest.mark.parametrize("url", ["mock:x", "mock:?colour=red", "mock:?seed=many", "mock:?seed"])
def test_a_mock_url_that_is_none_is_wrong_use(url: str):
    with pytest.raises(LinkUrlError):
        open_link(url, VirtualClock(), OPENERS)
    assert run("connect", url).exit_code == 2


def test_a_missing_world_is_one_clear_error():
    with pytest.raises(NxtTwinError, match=r"none\.yaml"):
        open_link("mock:?world=none.yaml", VirtualClock(), OPENERS)


def test_a_mock_brick_in_process_fails_as_any_link_does():
    link = open_link("mock:", VirtualClock(), OPENERS)
    with pytest.raises(LinkTimeoutError):
        link.receive(0.1)
    link.close()
    with pytest.raises(LinkLostError):
        link.receive(0.1)


def test_without_a_place_the_brick_is_where_connect_looks(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as server:
        free = f"localhost:{server.getsockname()[1]}"
    assert parse_address(LOCAL_ADDRESS) == ("localhost", 7000)
    monkeypatch.setattr(run_module, "LOCAL_ADDRESS", free)
    places: list[str] = []
    serve(clock=VirtualClock(), announce=lambda served: places.extend(served.urls), stop=lambda: True)
    assert places == [f"tcp:127.0.0.1:{free.split(':')[1]}"]


def test_a_port_that_is_taken_is_said_in_one_line():
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken = f"127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(ServeError, match="another program listens there") as caught:
            serve(clock=VirtualClock(), announce=print, tcp=taken)
    assert taken in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_mock_prints_json_and_nothing_else_and_ends_quietly_when_interrupted(monkeypatch):
    def interrupted(**settings):
        settings["announce"](run_module.Served("NXT", ("tcp:127.0.0.1:7000",)))
        raise KeyboardInterrupt

    monkeypatch.setattr("nxt_twin.cli.mock.serve", interrupted)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    result = run("mock", "--json", "-")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == {
        "schema": "nxt-twin/mock/1", "name": "NXT", "urls": ["tcp:127.0.0.1:7000"],
    }  # fmt: skip
    assert result.stderr == ""


def test_a_program_of_its_own_finds_the_brick_on_its_usb(tmp_path):
    script, told = tmp_path / "robot.py", tmp_path / "told.txt"
    script.write_text(
        "import sys, pathlib, nxt.locator\n"
        "with nxt.locator.find() as brick:\n"
        "    pathlib.Path(sys.argv[1]).write_text(brick.get_device_info()[0])\n"
    )
    assert (
        run("mock", "--world", str(WORKSHOP), "--usb-fake", str(script), "--argument", str(told)).exit_code
        == 0
    )
    assert told.read_text() == "Workshop"


@pytest.mark.parametrize(("text", "status"), [("raise ValueError('oh')\n", 1), (None, 2)])
def test_a_program_that_fails_or_is_none_is_told_by_the_exit_status(tmp_path, text, status):
    script = tmp_path / "robot.py"
    if text is not None:
        script.write_text(text)
    result = run("mock", "--usb-fake", str(script))
    assert result.exit_code == status
    assert "Traceback" not in result.output
