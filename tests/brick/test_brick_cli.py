"""The commands connect, udev and doctor, as a user runs them."""

# ruff: noqa: ARG001, ARG005 - what stands in for something takes what that takes

from __future__ import annotations

import json

import pytest
import typer
from brick_fakes import ScriptedLink, VirtualClock
from typer.testing import CliRunner

import firmware_protocol as fp
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.brick.question import question
from nxt_twin.brick.search.finding import FoundBrick, Reason, WayReport
from nxt_twin.cli import connect as connect_module
from nxt_twin.cli import doctor as doctor_module
from nxt_twin.cli.connect import connect
from nxt_twin.cli.doctor import doctor
from nxt_twin.cli.udev import udev

REPLIES = {
    fp.GetVersions: fp.GetVersions.Reply(124, 1, 29, 1),
    fp.GetDeviceInfo: fp.GetDeviceInfo.Reply("Robbie", bytes.fromhex("00165301020300"), bytes(4), 60_000),
    fp.GetBatteryLevel: fp.GetBatteryLevel.Reply(7950),
    fp.GetProperty: fp.GetProperty.Reply.of(2, 600_000),
}


def answer(telegram: bytes) -> list[bytes]:
    request = fp.decode_request(telegram).request
    if isinstance(request, fp.GetCurrentProgram):
        return [fp.encode_reply(request, status=fp.Status.NO_ACTIVE_PROGRAM)]
    reply = REPLIES.get(type(request)) or fp.blank_reply(request)
    encoded = fp.encode_reply(request, reply)
    head = question(request).head
    return [head + encoded[len(head) :]]


@pytest.fixture
def run():
    app = typer.Typer()
    for command in (connect, udev, doctor):
        app.command()(command)
    return lambda *arguments: CliRunner().invoke(app, list(arguments))


@pytest.fixture
def link(monkeypatch) -> ScriptedLink:
    clock = VirtualClock()
    scripted = ScriptedLink(clock, answer)
    monkeypatch.setattr(connect_module, "open_brick", lambda url, *_, tap=None: Brick(scripted, clock))
    return scripted


def searching(monkeypatch, *reports: WayReport) -> None:
    monkeypatch.setattr(connect_module, "search_ways", lambda clock, ways, timeout_s: reports)


def test_connect_says_who_the_brick_is_and_moves_nothing(run, link: ScriptedLink):
    result = run("connect", "usb:")
    assert result.exit_code == 0
    for wanted in ("Robbie", "00:16:53:01:02:03", "1.29", "7.95 V", "60000 bytes", "A 0°", "10 min"):
        assert wanted in result.stdout
    assert link.closed
    assert {sent[0] for sent in link.sent} == {0x00, 0x01}
    assert 0x04 not in [sent[1] for sent in link.sent]


def test_connect_prints_json_and_nothing_else(run, link: ScriptedLink):
    printed = json.loads(run("connect", "usb:", "--json", "-").stdout)
    assert printed["name"] == "Robbie"
    assert printed["battery_v"] == 7.95
    assert [motor["port"] for motor in printed["motors"]] == ["A", "B", "C"]
    assert len(printed["sensors"]) == 4


def test_connect_with_a_url_that_is_none_is_wrong_use(run):
    assert run("connect", "ftp:there").exit_code == 2


def test_connect_to_a_brick_that_cannot_be_reached_raises_what_the_program_reports(run):
    result = run("connect", "tcp:127.0.0.1:1")
    assert result.exit_code == 1
    assert isinstance(result.exception, LinkRefusedError)


def test_a_search_prints_the_url_to_paste(run, monkeypatch):
    found = WayReport("usb", (FoundBrick("usb:001653010203", "USB bus 1 device 5"),))
    searching(
        monkeypatch, found, WayReport("tcp", reasons=(Reason("nobody listens", Refusal.NOT_FOUND, "start"),))
    )
    result = run("connect")
    assert result.exit_code == 0
    assert result.stdout.startswith("usb:001653010203")
    assert "tcp: nobody listens (start)" in result.stderr


def test_a_search_that_finds_nothing_fails_and_says_why(run, monkeypatch):
    searching(
        monkeypatch, WayReport("usb", reasons=(Reason("no rule", Refusal.NO_PERMISSION, "nxt-twin udev"),))
    )
    result = run("connect", "--json", "-")
    assert result.exit_code == 1
    (way,) = json.loads(result.stdout)["ways"]
    assert way["reasons"] == [{"what": "no rule", "cause": "no_permission", "mend": "nxt-twin udev"}]


def test_udev_prints_nothing_but_the_rule_on_standard_output(run):
    result = run("udev")
    assert result.exit_code == 0
    assert all(line.startswith(("#", "SUBSYSTEM")) for line in result.stdout.splitlines())
    assert "sudo tee" in result.stderr


def test_udev_prints_json(run):
    printed = json.loads(run("udev", "--json", "-").stdout)
    assert printed["path"].endswith("70-nxt-twin.rules")
    assert 'TAG+="uaccess"' in printed["rule"]


def test_doctor_fails_where_something_is_wrong_and_prints_json(run, monkeypatch):
    ill = doctor_module.gather_facts()
    monkeypatch.setattr(doctor_module, "gather_facts", lambda: type(ill)(system="Linux", python=(3, 11, 0)))
    result = run("doctor", "--json", "-")
    assert result.exit_code == 1
    checks = {finding["check"]: finding for finding in json.loads(result.stdout)["findings"]}
    assert checks["udev"]["verdict"] == "fail"
    assert "sudo udevadm" in run("doctor").stdout
