"""Sensors on the analogue-to-digital converter, and the type and mode of every input.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands and c_input.c.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.fields import S16, U16, Bool8, InputPort8, SensorMode8, SensorType8


@final
@dataclass(frozen=True)
class SetInputMode(DirectCommand[NoData], opcode=0x05, name="SET_IN_MODE"):
    """Say what is plugged in and how to scale it; only the port is checked.

    The values are invalid for a while after it: 20 ms, for sound 300 ms, for colour 400 ms.
    """

    port: InputPort8
    sensor_type: SensorType8
    sensor_mode: SensorMode8


@final
@dataclass(frozen=True)
class GetInputValues(DirectCommand["GetInputValues.Reply"], opcode=0x07, name="GET_IN_VALS"):
    """Read a sensor; a bad port gives an error and 13 zeros."""

    port: InputPort8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The reading: raw 0 to 1023, normalised 0 to 1023, and scaled by the mode.

        The firmware never sets ``calibrated``, and repeats the normalised value as the calibrated one.
        """

        port: InputPort8
        valid: Bool8
        calibrated: Bool8
        sensor_type: SensorType8
        sensor_mode: SensorMode8
        raw: U16
        normalised: U16
        scaled: S16
        calibrated_value: S16


@final
@dataclass(frozen=True)
class ResetInputScaledValue(DirectCommand[NoData], opcode=0x08, name="RESET_IN_VAL"):
    """Set the scaled value (a count, for one) to 0."""

    port: InputPort8
