"""Motors: drive them, let them go, read where they are."""

from __future__ import annotations

from typing import Final, NamedTuple, final

from firmware_protocol import (
    GetOutputState,
    MotorMode,
    OutputPort,
    RegulationMode,
    ResetMotorPosition,
    ResetTachoCount,
    RunState,
    SetOutputState,
)
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.question import Question, compiled_question
from nxt_twin.brick.stamped import Stamped

_PORTS: Final = (OutputPort.A, OutputPort.B, OutputPort.C)


class MotorState(NamedTuple):
    """A motor's settings in force and its three counters, degrees of the output hub.

    Attributes:
        port: the motor port.
        power_pct: the power set, -100…100 (the brick stores what it is sent, beyond that too).
        mode: on, brake, regulated.
        regulation: what it is regulated to.
        turn_ratio_pct: how a synchronised pair shares the power, -100…100.
        run_state: idle, ramping or running.
        tacho_limit_deg: the travel after which the motor goes idle; 0 for never.
        tacho_deg: the count since the last reset by `reset_tacho` or a program.
        block_deg: the count since the last `reset_position(relative=True)`.
        rotation_deg: the count since the last `reset_position(relative=False)`.
    """

    port: int
    power_pct: int
    mode: int
    regulation: int
    turn_ratio_pct: int
    run_state: int
    tacho_limit_deg: int
    tacho_deg: int
    block_deg: int
    rotation_deg: int


@final
class Motors:
    """The motors of a brick; every method raises what `Exchange.put` does.

    Once a motor was engaged through here, leaving the brick lets all of them coast.
    """

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._states: dict[int, Question[MotorState]] = {
            port: compiled_question(GetOutputState(port), MotorState) for port in _PORTS
        }

    def set_output_state(
        self,
        port: int,
        *,
        power_pct: int,
        mode: int,
        regulation: int = RegulationMode.IDLE,
        turn_ratio_pct: int = 0,
        run_state: int = RunState.RUNNING,
        tacho_limit_deg: int = 0,
        confirm: bool = True,
    ) -> Stamped[None]:
        """Send SET_OUT_STATE with all its fields; `drive`, `coast` and `brake` are the common cases.

        Args:
            port: the motor, or `OutputPort.ALL`.
            power_pct: -100…100.
            mode: `MotorMode` bits. Without ON the motor coasts, whatever else is set.
            regulation: to what; needs `MotorMode.REGULATED`. First acts 101 ms later.
            turn_ratio_pct: for a synchronised pair.
            run_state: `RunState`.
            tacho_limit_deg: counted from the previous target, so that errors do not add up; 0 for ever.
                Reaching it, the motor coasts even if BRAKE is set.
            confirm: whether to wait for the brick's word; without, errors go unnoticed.
        """
        request = SetOutputState(
            port=port,
            power=power_pct,
            mode=mode,
            regulation=regulation,
            turn_ratio=turn_ratio_pct,
            run_state=run_state,
            tacho_limit=tacho_limit_deg,
        )
        return self._exchange.ask(request).having(None) if confirm else self._exchange.tell(request)

    def drive(
        self,
        port: int,
        power_pct: int,
        *,
        floating: bool = False,
        tacho_limit_deg: int = 0,
        confirm: bool = True,
    ) -> Stamped[None]:
        """Drive without regulation.

        Args:
            port: the motor, or `OutputPort.ALL`.
            power_pct: the duty, -100…100.
            floating: whether the off phase leaves the winding open instead of shorted; the speed is then far
                from proportional to the power.
            tacho_limit_deg: where to stop, as with `set_output_state`.
            confirm: whether to wait for the brick's word.
        """
        mode = MotorMode.ON if floating else MotorMode.ON | MotorMode.BRAKE
        return self.set_output_state(
            port, power_pct=power_pct, mode=mode, tacho_limit_deg=tacho_limit_deg, confirm=confirm
        )

    def coast(self, port: int = OutputPort.ALL, *, confirm: bool = True) -> Stamped[None]:
        """Let go; the firmware still drives the motor, by 1 % less each ms."""
        return self.set_output_state(
            port, power_pct=0, mode=MotorMode.COAST, run_state=RunState.IDLE, confirm=confirm
        )

    def brake(self, port: int = OutputPort.ALL, *, confirm: bool = True) -> Stamped[None]:
        """Short the winding; costs battery until the motor coasts."""
        return self.set_output_state(port, power_pct=0, mode=MotorMode.ON | MotorMode.BRAKE, confirm=confirm)

    def read(self, port: int) -> Stamped[MotorState]:
        """The motor's settings and counters (GET_OUT_STATE)."""
        ready = self._states.get(port) or compiled_question(GetOutputState(port), MotorState)
        return self._exchange.put(ready)

    def tacho_deg(self, port: int) -> Stamped[int]:
        """The motor's tacho count, degrees of the output hub."""
        state = self.read(port)
        return state.having(state.value.tacho_deg)

    def reset_position(self, port: int, *, relative: bool, confirm: bool = True) -> Stamped[None]:
        """Set the block count (relative) or the rotation count to 0; the tacho count stays."""
        request = ResetMotorPosition(port, relative)
        return self._exchange.ask(request).having(None) if confirm else self._exchange.tell(request)

    def reset_tacho(self, port: int) -> Stamped[None]:
        """Set the tacho count and the pending target to 0; stock firmwares before 1.29 builds refuse it."""
        return self._exchange.ask(ResetTachoCount(port)).having(None)
