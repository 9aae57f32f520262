"""Random telegrams to the mock and to the firmware's own source, compiled for this machine.

    git clone https://github.com/schodet/nxt-firmware
    python tools/beside_firmware nxt-firmware --sessions 50

Prints what they answer differently. Needs gcc on 64-bit Linux and Pillow. Left out are telegrams after which
the source reads or writes memory that is not its own. Left out too are those that need an answer of the radio
or the co-processor, and bytes that a brick does not initialise.
"""

from __future__ import annotations

import argparse
import re
import struct
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

import firmware_protocol as fp  # noqa: E402
from benchmarks.mock_fuzz import random_telegram  # noqa: E402
from nxt_twin.mock.body.world import World  # noqa: E402
from nxt_twin.mock.firmware.channel import Transport  # noqa: E402
from nxt_twin.mock.firmware.firmware import Firmware  # noqa: E402

SOURCES = (
    "c_button", "c_cmd", "c_comm", "c_display", "c_input", "c_ioctrl", "c_loader", "c_lowspeed", "c_output", "c_sound",
    "c_ui", "d_loader", "d_output", "m_sched",
)  # fmt: skip
FLAGS = (
    "-w -O1 -fno-pie -funsigned-char -fno-strict-aliasing -fcommon -D__ramfunc= -DSAM7S256 -DPROTOTYPE_PCB_4"
)
PATCHES = {
    # A word of the brick is 32 bits; what it reads beyond a table's end, or at address 0, ends a process here.
    "stdconst.h": (
        (r"unsigned long(\s+ULONG)", r"unsigned int\1"),
        (r"signed long(\s+SLONG)", r"signed int\1"),
    ),
    "c_cmd.h": ((r"#define SIM_NXT", "#define ARM_NXT"),),
    "d_loader.c": (
        (r"(\*pFileLength\s*= 0;)", r"if (pFileLength) \1"),
        (r"if \((DLERROR == WriteBuffer\[HandleTable\[Handle\])", r"if (Handle < 0x8000 && \1"),
    ),
    "c_loader.c": (
        (r"if \((\(\*\(pHeaders\[Tmp\]\)\)\.ModuleID)", r"if (pHeaders[Tmp] && \1"),
        ("Tmp < 32", "Tmp < 15"),
    ),
}
DOORS = """
void beside_wake(void)
{
  strcpy((char *)IOMapComm.BrickData.Name, "NXT");
  VarsComm.BtState = BT_ARM_DATA_MODE;
  VarsComm.ActiveUpdate = UPD_IDLE;
  VarsComm.CmdSwitchCnt = 0;
  VarsComm.BtAdrStatus = INITIALIZED;
  pMapUi->BluetoothState = 0;
}
int beside_busy(void) { return VarsComm.ActiveUpdate != UPD_IDLE; }
UBYTE *beside_buffer(void) { return VarsComm.BtModuleInBuf.Buf; }
"""

FILES = (("main.rxe", b"no program at all"), ("a.txt", b"hello"), ("b.bin", bytes(range(256)) * 2))
READINGS = (1023, 950, 700, 1023)
BATTERY_V = 580 * 13.848e-3 + 1e-6
DIRECT, SYSTEM = 0, 1
HANDLES = 16
USB_READ = 58
MAPS = (fp.ModuleId.OUTPUT, fp.ModuleId.INPUT, fp.ModuleId.SOUND)
"""IO maps without pointers, which are longer here."""

Answers = dict[str, bytes]


def build(checkout: Path, work: Path) -> Path:
    """The firmware as a program."""
    source, made = work / "src", work / "gen"
    made.mkdir()
    source.mkdir()
    for path in (checkout / "src").iterdir():
        text = path.read_text(encoding="latin-1")
        for pattern, instead in PATCHES.get(path.name, ()):
            text = re.sub(pattern, instead, text)
        if path.name == "c_comm.c":
            text += DOORS
        source.joinpath(path.name).write_text(text, encoding="latin-1")
    for table in sorted((checkout / "data").rglob("*.toml")):
        picture = table.with_suffix(".png")
        tool = checkout / "tools" / ("img2src" if picture.exists() else "menu2src")
        inputs = [str(table), str(picture)] if picture.exists() else [str(table)]
        run(sys.executable, str(tool), "-o", str(made / f"{table.stem}.h"), *inputs)
    include = [f"-I{folder}" for folder in (source, made, checkout / "include")]
    for name in SOURCES:
        run(
            "gcc",
            *FLAGS.split(),
            "-Dmain=firmware_main",
            *include,
            "-c",
            f"{source / name}.c",
            "-o",
            f"{work / name}.o",
        )
    objects = [f"{work / name}.o" for name in SOURCES]
    harness = str(Path(__file__).with_name("harness.c"))
    run("gcc", *FLAGS.split(), "-no-pie", *include, harness, *objects, "-lm", "-o", str(work / "firmware"))
    return work / "firmware"


def run(*command: str) -> None:
    """Run a tool; what it says is the error."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"beside_firmware: {command[0]}: {done.stderr.strip()[:500]}")


class Source:
    """The firmware's own source, in a process."""

    def __init__(self, program: Path) -> None:
        self.process = subprocess.Popen([str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.busy = False

    def send(self, transport: Transport, telegram: bytes) -> None:
        """A telegram on its way."""
        self._tell(b"U" if transport is Transport.USB else b"B", len(telegram), telegram)

    def run(self, ticks: int) -> Answers:
        """Let time pass; what is said meanwhile."""
        self._tell(b"T", ticks)
        self._tell(b"Q", 0)
        self.process.stdin.flush()
        said = {"u": b"", "b": b""}
        while len(head := self.process.stdout.read(3)) == len(b"q00"):
            data = self.process.stdout.read(head[1] | head[2] << 8)
            if head[:1] == b"q":
                self.busy = bool(data[0])
                return said
            said[chr(head[0])] += data
        raise EOFError

    def _tell(self, what: bytes, size: int, data: bytes = b"") -> None:
        self.process.stdin.write(what + struct.pack("<H", size) + data)

    def close(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


class Mock:
    """The mock, its body as still as the harness's."""

    def __init__(self) -> None:
        world = World()
        body = world.body(ready=False)
        for port, sensor in enumerate(body.sensors):
            sensor.reading = lambda _, port=port: READINGS[port]
            sensor.i2c_write = lambda *_: False
        body.step = lambda: None
        body.battery_v = lambda: BATTERY_V
        self.firmware = Firmware(body, world.identity())
        self.firmware.radio.address = bytes(7)

    @property
    def busy(self) -> bool:
        """Whether a long READ is under way."""
        return self.firmware.radio.reading

    def send(self, transport: Transport, telegram: bytes) -> None:
        """A telegram on its way."""
        self.firmware.receive(transport, telegram if transport is Transport.USB else fp.frame(telegram))

    def run(self, ticks: int) -> Answers:
        """Let time pass; what is said meanwhile."""
        said = {"u": b"", "b": b""}
        for _ in range(ticks):
            self.firmware.tick()
            for transport, key in ((Transport.USB, "u"), (Transport.BLUETOOTH, "b")):
                said[key] += b"".join(self.firmware.transmit(transport))
        return said


def comparable(telegram: bytes, transport: Transport) -> bool:
    """Whether both can be asked it."""
    if len(telegram) < 3:
        return False
    kind, opcode, first = telegram[0] & 0x7F, telegram[1], telegram[2]
    if kind == DIRECT:
        return opcode != fp.LowSpeedWrite.OPCODE and not (opcode == fp.SetProperty.OPCODE and first == 0)
    if kind != SYSTEM:
        return True
    if opcode in (0x97, 0x98, 0xA0, 0xA4):  # boot, and what the radio or an erased flash would answer
        return False
    if opcode in (fp.FindNext.OPCODE, fp.CropDataFile.OPCODE):
        return first < HANDLES
    if opcode == fp.ReadFile.OPCODE and transport is Transport.USB:
        return len(telegram) > 4 and telegram[3] <= USB_READ and telegram[4] == 0
    if opcode in (fp.IoMapRead.OPCODE, fp.IoMapWrite.OPCODE):
        return len(telegram) > 9 and int.from_bytes(telegram[2:6], "little") in MAPS
    return True


def plain(telegram: bytes, said: Answers) -> Answers:
    """The answers, without bytes that a brick leaves to chance and without sizes that pointers change."""
    head = {"u": 0, "b": fp.bluetooth.LENGTH_PREFIX_SIZE}
    kept = dict(said)
    for key, offset in head.items():
        reply = said[key][offset:]
        if telegram[1] == fp.OpenRead.OPCODE and len(reply) > 3 and reply[2]:
            kept[key] = reply[:4]
        if telegram[1] in (fp.FindFirstModule.OPCODE, fp.FindNextModule.OPCODE):
            kept[key] = reply[:-2]
    return kept


def session(program: Path, seed: int, count: int) -> Counter[str]:
    """Send both the same telegrams; return the number of equal answers."""
    random, seen = Random(seed), Counter[str]()
    sides = (Source(program), Mock())
    try:
        prepare(sides)
        while sum(seen.values()) < count:
            transport = random.choice((Transport.USB, Transport.BLUETOOTH))
            telegram = random_telegram(random)[: 64 if transport is Transport.USB else 128]
            if comparable(telegram, transport):
                ours, theirs = asked(sides, transport, telegram, random.choice((1, 2, 2, 5, 30)))
                seen["alike" if ours == theirs else "not alike"] += 1
                if ours != theirs:
                    print(f"seed {seed}: {transport.value} {telegram.hex()}: {theirs} here, {ours} there")
    except EOFError:
        seen["source ended"] += 1
    finally:
        sides[0].close()
    return seen


def asked(
    sides: tuple[Source, Mock], transport: Transport, telegram: bytes, ticks: int
) -> tuple[Answers, Answers]:
    """What each says to a telegram."""
    for side in sides:
        side.send(transport, telegram)
    said = [side.run(ticks) for side in sides]
    while any(side.busy for side in sides):
        for so_far, side in zip(said, sides, strict=True):
            for key, more in side.run(4).items():
                so_far[key] += more
    return plain(telegram, said[0]), plain(telegram, said[1])


def prepare(sides: tuple[Source, Mock]) -> None:
    """Upload three files to both."""
    for name, data in FILES:
        writes = [fp.WriteFile(0, data[at : at + 50]) for at in range(0, len(data), 50)]
        for request in (fp.OpenWrite(name, len(data)), *writes, fp.CloseFile(0)):
            for side in sides:
                side.send(Transport.USB, fp.encode_request(request))
                side.run(2)


def main() -> None:
    """Build, compare, count."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path, help="of github.com/schodet/nxt-firmware")
    parser.add_argument("--sessions", type=int, default=20)
    parser.add_argument("--telegrams", type=int, default=400, help="in each session")
    given = parser.parse_args()
    seen = Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        program = build(given.checkout.resolve(), Path(folder))
        for seed in range(given.sessions):
            seen += session(program, seed, given.telegrams)
    whole = seen["alike"] + seen["not alike"]
    share = f"{seen['alike']} of {whole} telegrams ({seen['alike'] / whole:.2%})"
    print(f"{share} answered alike, in {given.sessions} sessions")
    print(f"of which {seen['source ended']} ended early, as the source reached beyond its memory")


if __name__ == "__main__":
    main()
