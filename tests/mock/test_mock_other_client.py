"""nxt-python, a client by other people, drives the mock through its public API, on every way to reach it."""

from __future__ import annotations

import contextlib
import socket
import struct
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import nxt.backend.devfile
import nxt.backend.socket
import nxt.backend.usb
import nxt.brick
import nxt.error
import nxt.motor
import nxt.sensor
import nxt.sensor.generic
import pytest
import usb.backend.libusb1

import firmware_protocol as fp
from nxt_twin.brick.clock import SystemClock
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.run import serve
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.dialect import Heard, Unframed
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import PROFILES
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.mock.thread import served_in_thread

PROGRAM = b"MindstormsNXT\0" + bytes(50)


class TcpSock:
    """The framing of a Bluetooth device file over TCP, in the shape that nxt-python asks of a socket."""

    bsize = 118
    type = "bluetooth"

    def __init__(self, address: tuple[str, int]) -> None:
        self._sock = socket.create_connection(address, timeout=5)
        self._stream = self._sock.makefile("rb")

    def send(self, data: bytes) -> None:
        self._sock.sendall(struct.pack("<H", len(data)) + data)

    def recv(self) -> bytes:
        (length,) = struct.unpack("<H", self._stream.read(2))
        return self._stream.read(length)

    def close(self) -> None:
        self._stream.close()
        self._sock.close()


@contextlib.contextmanager
def serving(**places: object) -> Iterator[tuple[str, ...]]:
    """A mock brick in real time, in a thread; gives its URLs."""
    with served_in_thread(partial(serve, clock=SystemClock(), **places)) as served:
        yield served.urls


@contextlib.contextmanager
def over_tcp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[nxt.brick.Brick]:
    del tmp_path, monkeypatch
    with serving(tcp="127.0.0.1:0") as (url,):
        _, host, port = url.split(":")
        with nxt.brick.Brick(TcpSock((host, int(port)))) as brick:
            yield brick


@contextlib.contextmanager
def over_pty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[nxt.brick.Brick]:
    del monkeypatch
    link = tmp_path / "brick"
    with serving(pty=link):
        (brick,) = nxt.backend.devfile.Backend().find(filename=str(link))
        with brick:
            yield brick


@contextlib.contextmanager
def over_usb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[nxt.brick.Brick]:
    """In virtual time: the client's own waits let the mock's time pass."""
    del tmp_path
    clock = VirtualClock()
    world = World()
    host = Host(Firmware(world.body(), world.identity()), clock)
    bus = MockUsbBackend([ServedUsbDevice(host, profile=PROFILES["none"])])
    monkeypatch.setattr(usb.backend.libusb1, "get_backend", lambda *_, **__: bus)
    monkeypatch.setattr(time, "sleep", clock.sleep)
    monkeypatch.setattr(time, "time", clock.now_s)
    (brick,) = nxt.backend.usb.Backend().find()
    with brick:
        yield brick


@contextlib.contextmanager
def over_raw_tcp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[nxt.brick.Brick]:
    """nxt-python's own socket backend, which sends telegrams without frames."""
    del tmp_path, monkeypatch
    with serving(tcp_raw="127.0.0.1:0") as (url,):
        _, host, port = url.split(":")
        (brick,) = nxt.backend.socket.Backend().find(server_host=host, server_port=port)
        with brick:
            yield brick


WAYS: dict[str, Callable[..., contextlib.AbstractContextManager[nxt.brick.Brick]]] = {
    "tcp": over_tcp,
    "raw tcp": over_raw_tcp,
    "pty": over_pty,
    "usb": over_usb,
}


@pytest.fixture(params=WAYS)
def brick(request, tmp_path, monkeypatch):
    with WAYS[request.param](tmp_path, monkeypatch) as brick:
        yield brick


def wait_until(done: Callable[[], bool], timeout_s: float = 5.0) -> None:
    end = time.time() + timeout_s
    while not done():
        assert time.time() < end
        time.sleep(0.01)


def test_other_client_reads_who_the_brick_is(brick):
    name, address, _, free = brick.get_device_info()
    assert (name, address.upper()) == ("NXT", "00:16:53:0A:0B:0C")
    assert free > 100_000
    assert brick.get_firmware_version() == ((1, 124), (1, 29))
    assert 7000 <= brick.get_battery_level() <= 9000
    assert brick.keep_alive() == 600_000
    assert next(brick.find_modules("*.*"))[0] == "Comm.mod"


def test_other_client_runs_and_stops_a_motor(brick):
    motor = brick.get_motor(nxt.motor.Port.A)
    motor.run(80)
    wait_until(lambda: motor.get_tacho().tacho_count > 50)
    motor.brake()
    motor.idle()
    motor.reset_position(relative=False)
    wait_until(lambda: motor.get_tacho().rotation_count < 50)


def test_other_client_turns_a_motor_by_an_angle(brick):
    motor = brick.get_motor(nxt.motor.Port.B)
    motor.turn(70, 360, brake=True, timeout=5, emulate=True)
    assert abs(motor.get_tacho().tacho_count - 360) < 200


def test_other_client_sets_a_tacho_limit(brick):
    motor = brick.get_motor(nxt.motor.Port.C)
    motor.weak_turn(60, 90)
    wait_until(lambda: motor.get_tacho().tacho_count >= 90)
    wait_until(lambda: brick.get_output_state(nxt.motor.Port.C)[5] == nxt.motor.RunState.IDLE)


def test_other_client_regulates_the_speed(brick):
    motor = brick.get_motor(nxt.motor.Port.A)
    motor.run(50, regulated=True)
    wait_until(lambda: motor.get_tacho().tacho_count > 300)
    start_s, start_deg = time.time(), motor.get_tacho().tacho_count
    wait_until(lambda: motor.get_tacho().tacho_count > start_deg + 300)
    speed_deg_per_s = (motor.get_tacho().tacho_count - start_deg) / (time.time() - start_s)
    assert speed_deg_per_s == pytest.approx(500, rel=0.3)
    assert brick.get_output_state(nxt.motor.Port.A)[3] == nxt.motor.RegulationMode.SPEED
    motor.idle()


def test_other_client_regulates_a_pair(brick):
    pair = nxt.motor.SynchronizedMotors(
        brick.get_motor(nxt.motor.Port.B), brick.get_motor(nxt.motor.Port.C), 0
    )
    pair.run(60)
    wait_until(lambda: brick.get_output_state(nxt.motor.Port.B)[7] > 200)
    counts = [brick.get_output_state(port)[8] for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
    assert abs(counts[0] - counts[1]) < 60
    pair.idle()


def test_other_client_reads_all_four_sensors(brick):
    touch = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.generic.Touch)
    sound = brick.get_sensor(nxt.sensor.Port.S2, nxt.sensor.generic.Sound)
    light = brick.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Light)
    sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
    assert touch.is_pressed() is False
    assert 0 < sound.get_loudness() < 300
    assert 400 < light.get_lightness() < 800
    assert sonar.get_distance() == 60
    assert sonar.get_sensor_info() is not None


def test_other_client_writes_finds_reads_and_deletes_files(brick):
    data = bytes(range(256)) * 3
    with brick.open_file("hello.bin", "wb", len(data)) as file:
        file.write(data)
    assert list(brick.find_files("*.bin")) == [("hello.bin", len(data))]
    with brick.open_file("hello.bin", "rb") as file:
        assert file.read() == data
    brick.file_delete("hello.bin")
    assert [name for name, _ in brick.find_files("*.*")] == ["NVConfig.sys"]


def test_other_client_exchanges_messages_with_a_program(brick):
    with pytest.raises(nxt.error.NoActiveProgramError):
        brick.message_write(0, b"nobody")
    with brick.open_file("main.rxe", "wb", len(PROGRAM)) as file:
        file.write(PROGRAM)
    brick.start_program("main.rxe")
    wait_until(lambda: _running(brick))
    assert brick.get_current_program_name() == "main.rxe"
    brick.message_write(3, b"hello")
    assert brick.message_read(3, 0, remove=True) == (0, b"hello\0")
    with pytest.raises(nxt.error.EmptyMailboxError):
        brick.message_read(3, 0, remove=True)
    brick.stop_program()
    wait_until(lambda: not _running(brick))


def _running(brick: nxt.brick.Brick) -> bool:
    try:
        return bool(brick.get_current_program_name())
    except nxt.error.NoActiveProgramError:
        return False


def test_other_client_is_told_of_errors(brick):
    with pytest.raises(nxt.error.FileNotFoundError):
        brick.file_open_read("none.txt")
    with pytest.raises(nxt.error.ModuleNotFoundError):
        brick.read_io_map(0x00FF0001, 0, 4)
    with pytest.raises(nxt.error.DirectProtocolError):
        brick.start_program("none.rxe")
    with pytest.raises(nxt.error.I2CError):
        brick.ls_get_status(nxt.sensor.Port.S1)


def test_other_client_reads_and_writes_io_maps_and_its_name(brick):
    assert brick.read_io_map(0x00020001, 96, 1) == (0x00020001, b"\x64")
    brick.write_io_map(0x00020001, 96, b"\x0a")
    assert brick.read_io_map(0x00020001, 96, 1)[1] == b"\x0a"
    brick.set_brick_name("Rover")
    wait_until(lambda: brick.get_device_info()[0] == "Rover")
    brick.play_tone(440, 100)
    brick.stop_sound_playback()


def test_telegrams_without_frames_that_arrive_at_once_are_told_apart():
    drive = fp.encode_request(fp.SetOutputState(1, 40, 3, 0, 0, 0x20, 0), reply_required=False)
    ask = fp.encode_request(fp.GetOutputState(1))
    heard = Unframed().hear(b"\x98" + drive + ask + b"\x99", first=True)
    assert heard == Heard((drive, ask), answer=b"usb", bye=True)
    write = fp.encode_request(fp.WriteFile(0, bytes(30)))
    assert Unframed().hear(write, first=False).parts == (write,)


def test_an_unframed_greeting_at_a_framed_place_is_turned_away():
    with serving(tcp="127.0.0.1:0") as (url,):
        _, host, port = url.split(":")
        with socket.create_connection((host, int(port)), timeout=5) as client:
            client.sendall(b"\x98")
            said = b"".join(iter(lambda: client.recv(100), b""))
    assert b"--tcp-raw" in said
