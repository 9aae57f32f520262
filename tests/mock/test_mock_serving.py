"""Ways to reach the mock: in process, TCP, pseudo-terminal, USB; with clients that come, go and misbehave."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest
import usb.core
import usb.util
from mock_rig import BLUETOOTH

import firmware_protocol as fp
from firmware_protocol import usb as nxt_usb
from nxt_twin.errors import NxtTwinError
from nxt_twin.mock import run
from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.errors import ServeError, WorldError
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.firmware.hardware import TICK_S
from nxt_twin.mock.run import Served, parse_address, serve
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.serve.profile import PROFILES, Profile
from nxt_twin.mock.serve.pty import PtyEndpoint
from nxt_twin.mock.serve.tcp import TcpEndpoint
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.mock.start import open_mock_link

VERSIONS = fp.encode_request(fp.GetVersions())
CONFIGS = Path(__file__).parents[2] / "configs" / "worlds"


@pytest.fixture
def host() -> Host:
    world = World()
    return Host(Firmware(world.body(), world.identity()), VirtualClock())


def pump(host: Host, endpoint, passes: int = 20) -> None:
    for _ in range(passes):
        endpoint.take_in()
        host.wait(host.next_tick_s)
        endpoint.hand_out()


def round_trip_ms(link: MockLink, host: Host) -> float:
    start_s = host.clock.now_s()
    link.send(VERSIONS)
    link.receive(1.0)
    return (host.clock.now_s() - start_s) * 1e3


def test_a_link_in_process_takes_and_gives_whole_telegrams(host):
    link = MockLink(host)
    link.send(VERSIONS)
    assert fp.decode_reply(fp.GetVersions, link.receive(1.0)).firmware_minor == 29
    with pytest.raises(TimeoutError):
        link.receive(0.01)
    link.close()
    link.close()
    with pytest.raises(ConnectionError):
        link.send(VERSIONS)


def test_a_link_can_raise_what_its_user_wants():
    class LateError(Exception):
        pass

    link = open_mock_link(VirtualClock(), late=LateError)
    with pytest.raises(LateError, match="sent nothing"):
        link.receive(0.01)
    with pytest.raises(ServeError, match="bluetooth"):
        open_mock_link(VirtualClock(), profile="carrier pigeon")


def test_the_brick_lives_on_between_links_and_makes_up_for_missed_time(host):
    link = MockLink(host)
    link.send(fp.encode_request(fp.SetOutputState(0, 60, 3, 0, 0, 0x20, 0), reply_required=False))
    host.clock.sleep(0.01)
    host.catch_up()
    link.close()
    host.clock.sleep(2.0)
    again = MockLink(host)
    again.send(fp.encode_request(fp.GetOutputState(0)))
    assert fp.decode_reply(fp.GetOutputState, again.receive(1.0)).tacho_count > 500


def test_the_same_seed_gives_the_same_bytes_at_the_same_time():
    def run(seed: int) -> list[tuple[float, bytes]]:
        world = World.model_validate({"sensors": {3: {"kind": "light", "raw": 500, "noise_raw": 5}}})
        host = Host(Firmware(world.body(seed), world.identity()), VirtualClock())
        link = MockLink(host, PROFILES["bluetooth"], seed=seed)
        said = []
        for request in [fp.SetInputMode(2, 6, 0), *[fp.GetInputValues(2)] * 10]:
            link.send(fp.encode_request(request))
            said.append((host.clock.now_s(), link.receive(1.0)))
        return said

    assert run(1) == run(1)
    assert run(1) != run(2)


@pytest.mark.parametrize(
    ("profile", "least_ms", "most_ms"), [("none", 0, 2), ("usb", 1, 4), ("bluetooth", 30, 60)]
)
def test_profiles_take_the_time_of_their_transport(host, profile, least_ms, most_ms):
    link = MockLink(host, PROFILES[profile], seed=3)
    times_ms = [round_trip_ms(link, host) for _ in range(50)]
    assert least_ms <= min(times_ms)
    assert max(times_ms) <= most_ms


def test_lost_and_damaged_bytes_leave_the_brick_alive(host):
    link = MockLink(host, Profile(drop=0.1, corrupt=0.1), seed=1)
    good = 0
    for _ in range(300):
        link.send(VERSIONS)
        try:
            good += link.receive(0.01) == fp.encode_reply(fp.GetVersions, fp.GetVersions.Reply(124, 1, 29, 1))
        except TimeoutError:
            continue
    assert 10 < good < 290


def test_a_brick_that_is_switched_off_is_a_lost_link(host):
    link = MockLink(host)
    host.firmware.switch_off()
    with pytest.raises(ConnectionError, match="off"):
        link.send(VERSIONS)


def test_tcp_serves_one_client_after_another_whatever_they_do(host):
    endpoint = TcpEndpoint(host, ("127.0.0.1", 0), PROFILES["none"])
    for leftover in (b"", b"\x05", b"\x02\x00\x01", b"\xff\xff" + bytes(50)):
        with socket.create_connection(endpoint.address) as client:
            client.settimeout(5)
            client.sendall(fp.frame(VERSIONS) + leftover)
            pump(host, endpoint)
            assert client.recv(100)[2:5] == b"\x02\x88\x00"
        pump(host, endpoint, 3)
    endpoint.close()


def test_two_clients_at_once_are_served_in_turn(host):
    endpoint = TcpEndpoint(host, ("127.0.0.1", 0), PROFILES["none"])
    first = socket.create_connection(endpoint.address)
    second = socket.create_connection(endpoint.address)
    second.settimeout(5)
    pump(host, endpoint)
    second.sendall(fp.frame(VERSIONS))
    pump(host, endpoint)
    first.close()
    pump(host, endpoint)
    assert second.recv(100)[2:4] == b"\x02\x88"
    second.close()
    endpoint.close()


def test_a_second_client_is_told_that_another_one_is_connected(host):
    endpoint = TcpEndpoint(host, ("127.0.0.1", 0), PROFILES["none"])
    with (
        socket.create_connection(endpoint.address) as first,
        socket.create_connection(endpoint.address) as second,
        socket.create_connection(endpoint.address) as silent,
    ):
        for client in (first, second, silent):
            client.settimeout(5)
        second.sendall(fp.frame(VERSIONS))
        pump(host, endpoint, 600)
        assert second.recv(100) == fp.frame(bytes((0x02, 0x88, fp.Status.BLUETOOTH_BUSY)))
        assert second.recv(100) == b""
        pump(host, endpoint, 5000)
        assert silent.recv(100) == b""
        first.sendall(fp.frame(VERSIONS))
        pump(host, endpoint)
        assert first.recv(100)[2:5] == b"\x02\x88\x00"
    endpoint.close()


def test_a_client_that_holds_half_a_telegram_is_let_go(host):
    endpoint = TcpEndpoint(host, ("127.0.0.1", 0), PROFILES["none"])
    with socket.create_connection(endpoint.address) as first:
        first.settimeout(5)
        pump(host, endpoint, 6000)
        first.sendall(fp.frame(VERSIONS) + fp.frame(VERSIONS)[:3])
        pump(host, endpoint, 4000)
        assert first.recv(100)[2:5] == b"\x02\x88\x00"
        pump(host, endpoint, 1100)
        assert first.recv(100) == b""
        with socket.create_connection(endpoint.address) as second:
            second.settimeout(5)
            second.sendall(fp.frame(VERSIONS))
            pump(host, endpoint)
            assert second.recv(100)[2:5] == b"\x02\x88\x00"
    endpoint.close()


def test_a_pseudo_terminal_can_be_opened_again_and_again(host, tmp_path):
    endpoint = PtyEndpoint(host, tmp_path / "brick", PROFILES["none"])
    assert endpoint.url == f"serial:{tmp_path / 'brick'}"
    for _ in range(3):
        pump(host, endpoint, 2)
        client = os.open(tmp_path / "brick", os.O_RDWR | os.O_NOCTTY)
        os.write(client, fp.frame(VERSIONS))
        pump(host, endpoint)
        assert os.read(client, 100) == b"\x07\x00\x02\x88\x00\x7c\x01\x1d\x01"
        os.write(client, fp.frame(VERSIONS))
        os.close(client)
    endpoint.close()
    assert not (tmp_path / "brick").is_symlink()


def test_no_other_file_is_replaced_by_the_link(host, tmp_path):
    (tmp_path / "mine").write_text("precious")
    with pytest.raises(ServeError, match="another name"):
        PtyEndpoint(host, tmp_path / "mine", PROFILES["none"])
    assert (tmp_path / "mine").read_text() == "precious"


@pytest.fixture
def usb_device(host) -> ServedUsbDevice:
    return ServedUsbDevice(host)


def find(device: ServedUsbDevice) -> usb.core.Device:
    return usb.core.find(backend=MockUsbBackend([device]), idVendor=nxt_usb.VENDOR_ID)


def test_pyusb_finds_configures_and_asks_the_brick(usb_device):
    device = find(usb_device)
    device.reset()
    device.set_configuration()
    assert (device.idProduct, device.speed, device.bMaxPacketSize0) == (2, usb.util.SPEED_FULL, 8)
    assert usb.util.get_string(device, device.iSerialNumber) == "0016530A0B0C"
    out, in_ = device.get_active_configuration()[(0, 0)]
    assert (out.bEndpointAddress, in_.bEndpointAddress) == (0x01, 0x82)
    assert out.write(VERSIONS) == 2
    assert in_.read(64, 100).tobytes()[:3] == b"\x02\x88\x00"
    with pytest.raises(usb.core.USBTimeoutError):
        in_.read(64, 20)
    usb.util.dispose_resources(device)


def test_unplugging_closes_files_and_is_noticed(usb_device):
    device = find(usb_device)
    device.set_configuration()
    device.write(1, fp.encode_request(fp.OpenWrite("a.txt", 3)))
    device.read(0x82, 64, 100)
    usb_device.unplug()
    with pytest.raises(usb.core.USBError) as caught:
        device.write(1, VERSIONS)
    assert caught.value.errno == 19
    assert find(usb_device) is None
    usb_device.plug_in()
    again = find(usb_device)
    again.set_configuration()
    again.write(1, fp.encode_request(fp.CloseFile(0)))
    assert again.read(0x82, 64, 100)[2] == fp.Status.HANDLE_ALREADY_CLOSED


def test_a_booted_brick_is_another_device(usb_device):
    device = find(usb_device)
    device.set_configuration()
    device.write(1, fp.encode_request(fp.Boot()))
    assert device.read(0x82, 64, 100).tobytes() == b"\x02\x97\x00Yes\0"
    assert find(usb_device) is None
    boot = usb.core.find(backend=MockUsbBackend([usb_device]), idVendor=nxt_usb.BOOT_VENDOR_ID)
    assert boot.idProduct == nxt_usb.BOOT_PRODUCT_ID


def test_a_brick_that_falls_asleep_hangs_up_and_wakes_with_its_files(tmp_path):
    world = tmp_path / "sleepy.yaml"
    world.write_text("sleep_timeout_min: 1", encoding="utf-8")
    clock = VirtualClock()
    said: list[Served] = []
    talks = [
        (0.1, [fp.OpenWrite("a.txt", 0), fp.CloseFile(0)]),
        (60.5, [fp.FindFirst("a.txt")]),
        (60.6, None),
    ]
    clients: list[socket.socket] = []

    def stop() -> bool:
        if clock.now_s() < talks[0][0]:
            return False
        _, requests = talks.pop(0)
        if requests is None:
            return True
        _, name, port = said[0].urls[0].split(":")
        client = socket.create_connection((name, int(port)), timeout=5)
        client.sendall(b"".join(fp.frame(fp.encode_request(request)) for request in requests))
        clients.append(client)
        return False

    serve(clock=clock, announce=said.append, world=world, stop=stop)
    first, second = (client.makefile("rb").read() for client in clients)
    assert first == b"\x04\x00\x02\x81\x00\x00\x04\x00\x02\x84\x00\x00"
    assert second[2:5] == b"\x02\x86\x00"
    for client in clients:
        client.close()


def test_serving_tells_where_and_ends_when_told(tmp_path):
    said: list[Served] = []
    asked = iter([False] * 30)
    link = tmp_path / "brick"
    serve(
        clock=VirtualClock(),
        announce=said.append,
        tcp="127.0.0.1:0",
        pty=link,
        stop=lambda: next(asked, True),
    )
    assert said[0].name == "NXT"
    assert [url.split(":")[0] for url in said[0].urls] == ["tcp", "serial"]
    assert not link.is_symlink()


@pytest.mark.parametrize("text", ["nowhere", "host:", ":70", "host:99999", "host:x"])
def test_wrong_addresses_are_refused(text):
    with pytest.raises(ServeError, match="HOST:PORT"):
        parse_address(text)


@pytest.mark.parametrize("path", sorted(CONFIGS.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_worlds_that_come_with_the_tool_make_bricks(path):
    world = load_world(path)
    firmware = Firmware(world.body(seed=1, folder=path.parent), world.identity())
    for _ in range(50):
        firmware.tick()
    firmware.receive(BLUETOOTH, fp.frame(VERSIONS))
    firmware.tick()
    assert len(firmware.transmit(BLUETOOTH)) == 1


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("colour: red", "unknown key"),
        ("battery: {voltage_v: -3}", "voltage_v"),
        ("sensors: {1: {kind: radar}}", "sensors"),
        ("motors: {a: nxt_moter}", "nxt_motor"),
        ("sensors: {1: {kind: touch, pressed: {points: [[1, 0], [0, 1]]}}}", "times"),
        ("- a list", "keys"),
    ],
)
def test_a_wrong_world_is_refused_with_the_key_that_is_wrong(tmp_path, text, complaint):
    path = tmp_path / "world.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(NxtTwinError, match=complaint):
        load_world(path).body(folder=tmp_path)


def test_a_world_error_is_one_of_the_tools_errors():
    assert issubclass(WorldError, NxtTwinError)
    assert issubclass(ServeError, NxtTwinError)


def test_after_a_stall_nothing_is_answered_from_before_it_was_asked(host):
    """A server that stood still makes up for its ticks first; what came meanwhile was not there in them."""
    clock, lags_s = host.clock, []

    class Watching:
        def take_in(self):
            lags_s.append(clock.now_s() - host.next_tick_s)

        def hand_out(self):
            if len(lags_s) == 5:
                clock.sleep(0.25)

    run._run(host, [Watching()], lambda: len(lags_s) >= 10)
    assert max(lags_s) < TICK_S
    assert host.next_tick_s > clock.now_s()
