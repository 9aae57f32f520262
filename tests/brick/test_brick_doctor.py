"""The doctor's conclusions from the facts about a machine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from nxt_twin.brick.doctor.checks import examine
from nxt_twin.brick.doctor.facts import MachineFacts, PackageFacts, RuleFile, SerialPortFacts, UsbFacts
from nxt_twin.brick.doctor.finding import Finding, Severity
from nxt_twin.brick.doctor.gather import brick_rules, gather_facts, users_of
from nxt_twin.brick.doctor.packages import version_fits
from nxt_twin.brick.doctor.udev import RULE_PATH, install_commands, rule_grants, rule_text

HEALTHY = MachineFacts(
    system="Linux",
    python=(3, 11, 7),
    groups=frozenset({"user", "dialout"}),
    udev_rules=(RuleFile(RULE_PATH, rule_text()),),
    usb=(UsbFacts("USB bus 1 device 5"),),
    bluetooth_adapters=("hci0",),
    bluetooth_tools=frozenset({"bluetoothctl", "rfcomm"}),
    serial_ports=(SerialPortFacts("/dev/rfcomm0", group="dialout"),),
    packages=(PackageFacts("pyusb", ">=1.3", "1.3.1", fits=True),),
)


def findings(check: str, **facts: object) -> list[Finding]:
    return [finding for finding in examine(replace(HEALTHY, **facts)) if finding.check == check]


def only(check: str, **facts: object) -> Finding:
    (finding,) = findings(check, **facts)
    return finding


def test_a_healthy_machine_has_nothing_but_ok():
    assert {finding.verdict for finding in examine(HEALTHY)} == {Severity.OK}


def test_whatever_is_not_ok_says_why_and_how_to_mend_it():
    ill = MachineFacts(
        system="Linux",
        python=(3, 9, 2),
        libusb="not found",
        usb=(UsbFacts("bus 1", "may not be opened by this user", "nxt-twin udev"),),
        bluetooth_sockets="this Python was built without Bluetooth sockets",
        serial_ports=(SerialPortFacts("/dev/rfcomm0", group="dialout", accessible=False),),
        packages=(PackageFacts("pyusb", ">=1.3", "", fits=False),),
    )
    bad = [finding for finding in examine(ill) if finding.verdict is not Severity.OK]
    assert len(bad) == 9
    assert all(finding.why and finding.mend for finding in bad)


def test_without_a_rule_a_user_fails_and_root_is_warned():
    assert only("udev", udev_rules=()).verdict is Severity.FAIL
    assert only("udev", udev_rules=(), is_root=True).verdict is Severity.WARN
    assert RULE_PATH in only("udev", udev_rules=()).mend


def test_a_rule_that_comes_too_late_is_named():
    late = RuleFile("/etc/udev/rules.d/99-nxt.rules", rule_text())
    finding = only("udev", udev_rules=(late,))
    assert finding.verdict is Severity.FAIL
    assert "99-nxt.rules comes too late" in finding.what


def test_other_systems_have_no_udev():
    assert findings("udev", system="Darwin", udev_rules=()) == []


def test_a_busy_port_names_the_program():
    port = SerialPortFacts("/dev/rfcomm0", users=("python3 (4711)",))
    assert "python3 (4711)" in only("serial", serial_ports=(port,)).what


def test_a_user_outside_the_group_is_told_to_join_it():
    port = SerialPortFacts("/dev/rfcomm0", group="tty", accessible=False)
    assert "usermod -aG tty" in only("serial", serial_ports=(port,)).mend


def test_a_group_that_is_not_in_force_yet_needs_a_new_login():
    port = SerialPortFacts("/dev/rfcomm0", group="dialout", accessible=False)
    assert only("serial", serial_ports=(port,)).mend == "log out and in again"


def test_a_package_that_does_not_fit_gives_the_command():
    package = PackageFacts("pyusb", ">=1.3", "1.2.1", fits=False)
    finding = only("package pyusb", packages=(package,))
    assert (finding.verdict, finding.mend) == (Severity.FAIL, "pip install 'pyusb>=1.3'")


def test_no_brick_on_usb_is_a_warning():
    assert only("usb", usb=()).verdict is Severity.WARN


def test_usb_that_cannot_be_searched_fails():
    assert only("usb", usb=(), usb_error="broken").verdict is Severity.FAIL


@pytest.mark.parametrize(
    ("version", "wanted", "fits"),
    [
        ("1.3.1", ">=1.3", True),
        ("1.3", ">=1.3.0", True),
        ("1.2.9", ">=1.3", False),
        ("2.0.0", "<3,>=2", True),
        ("3.0", "<3,>=2", False),
        ("0.41.2", "==0.41.*", True),
        ("0.42.0", "==0.41.*", False),
        ("5", "", True),
        ("2.0rc1", "!=1.0", True),
    ],
)
def test_versions_are_compared_by_number(version: str, wanted: str, fits: bool):
    assert version_fits(version, wanted) is fits


def test_the_printed_rule_grants_access_and_names_both_devices():
    assert rule_grants(RULE_PATH, rule_text())
    for wanted in ('"0694"', '"0002"', '"03eb"', '"6124"', 'TAG+="uaccess"'):
        assert wanted in rule_text()
    assert int(Path(RULE_PATH).name[:2]) < 73
    assert f"nxt-twin udev | sudo tee {RULE_PATH}" in install_commands()


@pytest.mark.parametrize(
    ("line", "grants"),
    [
        ('ATTR{idVendor}=="0694", MODE="0666"', True),
        ('ATTR{idVendor}=="0694", GROUP="lego", MODE="0660"', False),
        ('# ATTR{idVendor}=="0694", MODE="0666"', False),
        ('ATTR{idVendor}=="1234", MODE="0666"', False),
    ],
)
def test_other_people_s_rules_are_understood(line: str, grants: bool):
    assert rule_grants("/etc/udev/rules.d/99-other.rules", line) is grants


def test_rules_are_found_and_an_earlier_folder_hides_a_later_one(tmp_path: Path):
    first, second = tmp_path / "etc", tmp_path / "lib"
    for folder, text in ((first, "# nothing"), (second, rule_text())):
        folder.mkdir()
        (folder / "70-nxt.rules").write_text(text)
    (second / "60-lego.rules").write_text(rule_text())
    (second / "50-other.rules").write_text('ATTR{idVendor}=="1234"')
    assert [Path(rule.path).name for rule in brick_rules([first, second])] == ["60-lego.rules"]


def test_the_users_of_a_port_are_found(tmp_path: Path):
    handles = tmp_path / "4711" / "fd"
    handles.mkdir(parents=True)
    (handles / "3").symlink_to("/dev/rfcomm0")
    (tmp_path / "4711" / "comm").write_text("python3\n")
    (tmp_path / "4712").mkdir()
    assert users_of("/dev/rfcomm0", tmp_path) == ("python3 (4711)",)
    assert users_of("/dev/rfcomm1", tmp_path) == ()


def test_the_facts_about_this_machine_can_be_gathered_and_examined():
    facts = gather_facts()
    assert facts.python >= (3, 11)
    assert {package.name.lower() for package in facts.packages} >= {"pyusb", "pyserial", "libusb-package"}
    assert examine(facts)
