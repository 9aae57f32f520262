"""Every way into the program for what others wrote, with valid examples to begin from."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Final, final

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
from scipy.io import savemat

import firmware_protocol as fp
from firmware_protocol.layout import fixed_size_of
from nxt_twin.api.openers import mock_options
from nxt_twin.blind.secret import read_secret
from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.brick.tap import read_tap
from nxt_twin.brick.url import checked_bluetooth_address, host_and_port, parse_url, usb_serial
from nxt_twin.experiment.plan import read_experiment
from nxt_twin.experiment.positioner.spec import read_spec
from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware, Power
from nxt_twin.mock.run import parse_address
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.case import read_as_case, read_case
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.mapped import read_all_mapped
from nxt_twin.recording.mapping import Mapping, read_mapping
from nxt_twin.recording.program import read_program
from nxt_twin.recording.stream import RecordingWriter, recover, stream_path
from nxt_twin.sensors.light import LightParameters
from nxt_twin.sensors.sound import SoundParameters
from nxt_twin.sensors.touch import TouchParameters
from nxt_twin.sensors.ultrasonic_parameters import UltrasonicParameters

_RUN: Final = b"time_s,a_power_pct,a_mode,a_tacho_deg,battery_v,s1_touch\n" + b"".join(
    b"%.2f,%d,drive,%d,,%d\n" % (n / 100, 40 + n, n * n, n % 2) for n in range(20)
)
_CASE: Final = b"plant: nxt_motor\nrecordings: [a.csv]\nholdout: [b.csv]\nport: a\n"
_PLANTS: Final = (
    b"kind: rigid_body\ninertia: 95.0\nviscous_friction: 200.0\ncoulomb_friction: 20.0\n",
    b"kind: dc_motor\nresistance_ohm: 7.6\ntorque_constant_nm_per_a: 0.49\nback_emf_v_s_per_rad: 0.49\n"
    b"inertia_kg_m2: 1.2e-3\neffects:\n  stiction: {breakaway_torque_nm: 0.03, stribeck_speed_rad_s: 1.0}\n",
)
_SECRETS: Final = (b"port: b\neffects: [stiction, backlash]\nsize: medium\nseed: 3\nmotor: {drop_v: 0.4}\n",)
_SPECS: Final = (b"hand", b"rail:b,mm_per_deg=0.3", b"nx100:192.168.255.1:10040,along=z,value_now=100")
_URLS: Final = (
    b"usb:001653010203", b"bt:00:16:53:01:02:03", b"tcp:localhost:7000", b"tcp:[::1]:7000",
    b"mock:?world=w.yaml&seed=4&profile=usb&conceal=7", b"serial:/dev/rfcomm0",
)  # fmt: skip
_SIDECARS: Final = (b"plant: nxt_motor\npulse_steps: 125\nrow_lags: {read_before_s: {a: 0.004}}\n",)
_ELSEWHERE: Final = ("csv", "json", "lines", "feather")
_TAPS: Final = (
    b'{"schema": "nxt-twin/tap/1", "link": "usb:"}\n{"at_s": 0.1, "way": "out", "hex": "0006"}\n'
    b'{"at_s": 0.2, "way": "in", "hex": "020600"}\n{"at_s": 0.3, "way": "none", "error": "LinkTimeoutError"}\n',
)
_MAPPED: Final = {"time": {"column": "t"}, "input": {"column": "u", "kind": "torque_nm"},
                  "output": {"column": "y", "kind": "position_rad"}}  # fmt: skip


@final
@dataclass(frozen=True)
class Parser:
    """One way in.

    Attributes:
        name: what it reads.
        seeds: valid inputs.
        read: takes a folder of its own and an input.
        share: the part of all inputs that it gets; few where each costs a process.
    """

    name: str
    seeds: tuple[bytes, ...]
    read: Callable[[Path, bytes], object]
    share: float


def parsers() -> Sequence[Parser]:
    """All of them; shares add up to about one."""
    tables = _tables()
    return (
        Parser("telegrams, decoded", _telegrams(), _decode, 0.31),
        Parser("telegrams, to the mock", _telegrams(), _Mock().take, 0.15),
        Parser("URLs and addresses", _URLS, _urls, 0.25),
        Parser("positioners", _SPECS, lambda _, data: read_spec(_text(data)), 0.02),
        Parser("CSV", (_RUN,), _file("run.csv", read_recording), 0.03),
        Parser("sidecar YAML", _SIDECARS, _sidecar, 0.02),
        Parser("Parquet", (tables["parquet"],), _file("run.parquet", read_recording), 0.02),
        Parser("tables from elsewhere", tuple(tables[name] for name in _ELSEWHERE), _table, 0.03),
        Parser("MAT in its process", (tables["mat"], tables["packed"]), _table, 0.0005),
        Parser("streams", (_stream(),), _recover, 0.03),
        Parser("mapping YAML", _folder("mappings"), _file("m.yaml", read_mapping), 0.03),
        Parser("plant YAML", (*_folder("plants"), *_PLANTS), _file("p.yaml", _plant), 0.03),
        Parser("sensor YAML", _folder("sensors"), _file("s.yaml", _sensor), 0.02),
        Parser("world YAML", _folder("worlds"), _file("w.yaml", load_world), 0.02),
        Parser("program YAML", _folder("programs"), _file("p.yaml", read_program), 0.02),
        Parser("experiment YAML", _folder("experiments"), _file("e.yaml", read_experiment), 0.02),
        Parser("case YAML", (_CASE, *_folder("cases")), _case, 0.01),
        Parser("secret YAML", _SECRETS, _file("s.yaml", read_secret), 0.005),
        Parser("taps", _TAPS, lambda _, data: read_tap(_text(data).splitlines()), 0.005),
    )  # fmt: skip


def _file(name: str, read: Callable[[Path], object]) -> Callable[[Path, bytes], object]:
    def put_and_read(folder: Path, data: bytes) -> object:
        (folder / name).write_bytes(data)
        return read(folder / name)

    return put_and_read


def _folder(name: str) -> tuple[bytes, ...]:
    return tuple(file.read_bytes() for file in sorted((configs_dir() / name).rglob("*.yaml")))


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _sidecar(folder: Path, data: bytes) -> object:
    (folder / "run.csv").write_bytes(_RUN)
    (folder / "run.yaml").write_bytes(data)
    return read_as_case(folder / "run.csv")


def _table(folder: Path, data: bytes) -> object:
    (folder / "table").write_bytes(data)
    return read_all_mapped(folder / "table", Mapping.model_validate(_MAPPED))


def _case(folder: Path, data: bytes) -> object:
    for name in ("a.csv", "b.csv"):
        (folder / name).write_bytes(_RUN)
    (folder / "case.yaml").write_bytes(data)
    return read_case(folder)


def _plant(path: Path) -> object:
    config = load_plant_config(path)
    return plant_from_config(config, "torque_nm" if config.get("kind") == "rigid_body" else "power_pct")


def _sensor(path: Path) -> object:
    config = load_plant_config(path)
    kinds = (LightParameters, UltrasonicParameters, SoundParameters, TouchParameters)
    of = next((each for each in kinds if each.layout.kind == config.get("kind")), LightParameters)
    return of.from_config(config)


def _recover(folder: Path, data: bytes) -> object:
    path = folder / "r.csv"
    path.unlink(missing_ok=True)
    stream_path(path).write_bytes(data)
    return recover(path)


def _urls(_: Path, data: bytes) -> object:
    """All that is done with a URL before anything is opened."""
    url = parse_url(_text(data), ("usb", "bt", "serial", "tcp", "mock"))
    match url.scheme:
        case "usb":
            return usb_serial(url.address)
        case "bt":
            return checked_bluetooth_address(url.address)
        case "tcp":
            parse_address(url.address)
            return host_and_port(url.address)
        case "mock":
            return mock_options(url.address)
        case _:
            return url.address


def _decode(_: Path, data: bytes) -> object:
    try:
        return fp.decode_request(data)
    except fp.ProtocolError:
        kind = fp.TelegramType.SYSTEM if data[1:2] >= b"\x80" else fp.TelegramType.DIRECT
        return fp.decode_answer(fp.find_command(kind, data[1] if len(data) > 1 else 0), data)


@final
class _Mock:
    """A brick that gets telegrams, replaced now and then."""

    def __init__(self) -> None:
        self._random = Random(1)
        self._firmware = self._fresh()
        self._count = 0

    def take(self, _: Path, data: bytes) -> object:
        self._count += 1
        if self._count % 500 == 0 or self._firmware.power is not Power.ON:
            self._firmware = self._fresh()
        if data[:2] in (b"\x01\xa0", b"\x81\xa0"):
            return None  # erasing stalls the brick for seconds, as it does the real one
        transport = self._random.choice((Transport.USB, Transport.BLUETOOTH))
        telegram = data[:64] if transport is Transport.USB else fp.frame(data[:1000])
        self._firmware.receive(transport, telegram)
        for _tick in range(3):
            self._firmware.tick()
        return self._firmware.transmit(transport)

    @staticmethod
    def _fresh() -> Firmware:
        world = World(sleep_timeout_min=0)
        return Firmware(world.body(), world.identity())


def _telegrams() -> tuple[bytes, ...]:
    """A request of each command with zeros in its fields, and a reply."""
    sizes = {command: fixed_size_of(command) or 4 for command in fp.all_commands()}
    asked = [bytes((command.KIND, command.OPCODE)) + bytes(size) for command, size in sizes.items()]
    return (*asked, *(bytes((2, command.OPCODE, 0)) + bytes(30) for command in sizes))


def _stream() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.parquet"
        with RecordingWriter(path, ("time_s", "a_power_pct", "a_mode", "a_tacho_deg", "battery_v")) as writer:
            for n in range(40):
                writer.row({"time_s": n / 100, "a_power_pct": 40.0, "a_mode": 0.0, "a_tacho_deg": float(n)})
            return stream_path(path).read_bytes()


def _tables() -> dict[str, bytes]:
    """One small recording in several formats."""
    t = np.arange(30) / 100
    columns = {"t": t, "u": np.sin(t), "y": np.cumsum(t)}
    run = pa.table(
        {"time_s": t, "a_power_pct": np.full(30, 40), "a_mode": ["drive"] * 30, "a_tacho_deg": np.arange(30)}
    )
    lists = {name: values.tolist() for name, values in columns.items()}
    rows = [dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        pyarrow.parquet.write_table(run, place / "parquet")
        pyarrow.feather.write_feather(pa.table(columns), str(place / "feather"), compression="uncompressed")
        savemat(place / "mat", columns, appendmat=False)
        savemat(place / "packed", columns, appendmat=False, do_compression=True)
        found = {file.name: file.read_bytes() for file in place.iterdir()}
    text = "t,u,y\n" + "".join(f"{row['t']},{row['u']},{row['y']}\n" for row in rows)
    return {
        **found,
        "csv": text.encode(),
        "json": json.dumps(lists).encode(),
        "lines": "\n".join(map(json.dumps, rows)).encode(),
    }


REFUSALS: Final = (fp.ProtocolError, LinkUrlError)
"""Documented failures beside `NxtTwinError`."""
