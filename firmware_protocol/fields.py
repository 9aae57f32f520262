"""The vocabulary of the declarations: each name is a Python type together with its kind on the wire."""

from __future__ import annotations

from typing import Annotated

from firmware_protocol.enums import (
    InputPort,
    LowSpeedFault,
    LowSpeedMode,
    LowSpeedState,
    ModuleId,
    MotorMode,
    OutputFlags,
    OutputPort,
    PollBuffer,
    PropertyId,
    RegulationMode,
    RunState,
    SensorMode,
    SensorType,
)
from firmware_protocol.layout import Repeat
from firmware_protocol.wire import Choice, FixedBytes, Number, Remaining, Text, Truth

U8 = Annotated[int, Number(1)]
S8 = Annotated[int, Number(1, signed=True)]
U16 = Annotated[int, Number(2)]
S16 = Annotated[int, Number(2, signed=True)]
U32 = Annotated[int, Number(4)]
S32 = Annotated[int, Number(4, signed=True)]
Bool8 = Annotated[bool, Truth()]

Name15 = Annotated[str, Text(15)]
Name16 = Annotated[str, Text(16)]
Name17 = Annotated[str, Text(17)]
Name20 = Annotated[str, Text(20)]

Bytes4 = Annotated[bytes, FixedBytes(4)]
Bytes7 = Annotated[bytes, FixedBytes(7)]
Bytes16 = Annotated[bytes, FixedBytes(16)]
Rest = Annotated[bytes, Remaining()]

OutputPort8 = Annotated[int, Choice(OutputPort)]
MotorMode8 = Annotated[int, Choice(MotorMode)]
RegulationMode8 = Annotated[int, Choice(RegulationMode)]
RunState8 = Annotated[int, Choice(RunState)]
OutputFlags8 = Annotated[int, Choice(OutputFlags)]
InputPort8 = Annotated[int, Choice(InputPort)]
SensorType8 = Annotated[int, Choice(SensorType)]
SensorMode8 = Annotated[int, Choice(SensorMode)]
PropertyId8 = Annotated[int, Choice(PropertyId)]
PollBuffer8 = Annotated[int, Choice(PollBuffer)]
ModuleId32 = Annotated[int, Choice(ModuleId, size=4)]

LowSpeedModes = Annotated[tuple[int, ...], Repeat(4, Choice(LowSpeedMode))]
LowSpeedStates = Annotated[tuple[int, ...], Repeat(4, Choice(LowSpeedState))]
LowSpeedFaults = Annotated[tuple[int, ...], Repeat(4, Choice(LowSpeedFault))]
