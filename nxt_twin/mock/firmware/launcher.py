"""How the user interface executes a file: through its menus, which take their time before and after.

Source: LEGO NXT firmware 1.29, c_ui.c (EXECUTE_FILE, EXECUTING_FILE), Functions.inl cUiFileRun, and
c_display.c cDisplayCtrl, which draws one thing a pass.
"""

from __future__ import annotations

from enum import Enum
from typing import Final, final

from nxt_twin.mock.firmware.program import ProgramModule, ProgramStatus
from nxt_twin.mock.firmware.sound import STATE_IDLE as SOUND_IDLE
from nxt_twin.mock.firmware.sound import SoundModule
from nxt_twin.mock.firmware.ui import FLAG_BUSY, FLAG_EXECUTE_FILE, STATE_MENU, UiModule

DRAWING_TICKS: Final = 3
"""The screen is erased and two lines are written."""
SHOWING_TICKS: Final = 750
"""How long the end is shown: 1500 on a timer that this menu counts up twice a pass."""

_STATE_EXECUTE: Final = 13
_STATE_EXECUTING: Final = 14


class _Phase(Enum):
    MENU = "nothing is executed"
    ENTER = "the menus are gone through"
    CLAIM = "the display is claimed"
    AWAIT_SILENCE = "a sound has to end first"
    DRAW = "the screen is drawn"
    START_PROGRAM = "a program is to start"
    WATCH_PROGRAM = "a program runs"
    START_SOUND = "a sound is to start"
    WATCH_SOUND = "a sound plays"
    CLOSE = "it has ended"
    SHOW = "its end is shown"


_BY_ENDING: Final = {
    "rxe": _Phase.START_PROGRAM,
    "rtm": _Phase.START_PROGRAM,
    "rso": _Phase.START_SOUND,
    "rpg": _Phase.CLOSE,
    "log": _Phase.SHOW,
}
"""What a file is by its name; on-brick programs (rpg) are not run."""


@final
class Launcher:
    """Executes one file at a time; a wish that comes meanwhile is forgotten when the first is through.

    A file of no known kind is left at once, yet the user interface stays busy: no other is ever executed.

    Args:
        ui: where the wishes stand.
        program: runs programs.
        sound: plays sounds.
    """

    def __init__(self, ui: UiModule, program: ProgramModule, sound: SoundModule) -> None:
        self._ui = ui
        self._program = program
        self._sound = sound
        self._phase = _Phase.MENU
        self._wait_ticks = 0
        self._selected = ""

    def tick(self) -> None:
        """The user interface's pass, so far as it executes files."""
        if self._phase is not _Phase.MENU:
            self._phase = self._next()
        ui = self._ui
        if ui.flags & FLAG_EXECUTE_FILE and not ui.flags & FLAG_BUSY:
            ui.stay_awake()
            ui.flags |= FLAG_BUSY
            ui.state = _STATE_EXECUTE
            self._phase = _Phase.ENTER

    def _next(self) -> _Phase:
        phase = self._phase
        match phase:
            case _Phase.ENTER:
                self._selected = self._ui.file_name
                self._ui.state = _STATE_EXECUTING
                return _Phase.CLAIM
            case _Phase.CLAIM:
                return _Phase.AWAIT_SILENCE
            case _Phase.AWAIT_SILENCE if self._sound.state == SOUND_IDLE:
                self._wait_ticks = DRAWING_TICKS
                return _Phase.DRAW
            case _Phase.DRAW:
                return self._chosen() if self._waited() else phase
            case _Phase.CLOSE:
                self._wait_ticks = SHOWING_TICKS
                return _Phase.SHOW
            case _Phase.SHOW if self._waited():
                return self._leave()
        return self._watch(phase)

    def _watch(self, phase: _Phase) -> _Phase:
        match phase:
            case _Phase.START_PROGRAM if self._program.status is ProgramStatus.IDLE:
                self._program.start(self._selected)
                return _Phase.WATCH_PROGRAM
            case _Phase.WATCH_PROGRAM if self._program.status is not ProgramStatus.RUNNING:
                return _Phase.CLOSE
            case _Phase.START_SOUND:
                self._sound.volume = self._ui.volume
                self._sound.play_file(self._selected, loop=False)
                return _Phase.WATCH_SOUND
            case _Phase.WATCH_SOUND if self._sound.state == SOUND_IDLE:
                return _Phase.CLOSE
        return phase

    def _waited(self) -> bool:
        self._wait_ticks -= 1
        return self._wait_ticks <= 0

    def _chosen(self) -> _Phase:
        _, dot, ending = self._selected.rpartition(".")
        chosen = _BY_ENDING.get(ending.lower()) if dot else None
        if chosen is None:
            self._forget()
            return _Phase.MENU
        self._wait_ticks = SHOWING_TICKS
        return chosen

    def _leave(self) -> _Phase:
        if self._program.status is not ProgramStatus.IDLE:
            self._program.status = ProgramStatus.RESET
        self._ui.flags &= ~FLAG_BUSY
        self._forget()
        return _Phase.MENU

    def _forget(self) -> None:
        self._ui.flags &= ~FLAG_EXECUTE_FILE
        self._ui.state = STATE_MENU
