"""Motors: set an output, read it, reset its counters. Tacho counts are degrees of the output hub.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands and d_output.c.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.fields import S8, S32, U32, Bool8, MotorMode8, OutputPort8, RegulationMode8, RunState8


@final
@dataclass(frozen=True)
class SetOutputState(DirectCommand[NoData], opcode=0x04, name="SET_OUT_STATE"):
    """Drive, brake or release a motor, or all three at once.

    Only the port is checked: the power is neither clamped nor refused beyond ±100. A tacho limit of 0 is
    "for ever"; another counts from the previous target, so that errors do not add up.
    """

    port: OutputPort8
    power: S8
    mode: MotorMode8
    regulation: RegulationMode8
    turn_ratio: S8
    run_state: RunState8
    tacho_limit: U32


@final
@dataclass(frozen=True)
class GetOutputState(DirectCommand["GetOutputState.Reply"], opcode=0x06, name="GET_OUT_STATE"):
    """Read a motor's settings and counters; a bad port gives an error and 22 zeros."""

    port: OutputPort8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The settings in force and the three counters.

        The tacho count restarts with a program, the block count with each block of the LEGO software,
        the rotation count only on demand.
        """

        port: OutputPort8
        power: S8
        mode: MotorMode8
        regulation: RegulationMode8
        turn_ratio: S8
        run_state: RunState8
        tacho_limit: U32
        tacho_count: S32
        block_tacho_count: S32
        rotation_count: S32


@final
@dataclass(frozen=True)
class ResetMotorPosition(DirectCommand[NoData], opcode=0x0A, name="RESET_POSITION"):
    """Set the block count (relative) or the rotation count (not relative) to 0."""

    port: OutputPort8
    relative: Bool8


@final
@dataclass(frozen=True)
class ResetTachoCount(DirectCommand[NoData], opcode=0x21, name="RESET_COUNT"):
    """Set the tacho count and the pending target to 0; only enhanced firmwares (1.29 builds) know it."""

    port: OutputPort8
