"""What differs on a motor since its model was identified: the session beside what that model would have done."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import numpy as np

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.simulate import Simulator, free_job, with_supply
from nxt_twin.physics.start import moving_start
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import BATTERY, Port, tacho_column
from nxt_twin.recording.recording import Recording

_LEAST_S = 10.0
_LEAST_TURN_DEG = 90.0
_AS_WELL_AS_MODELS_DO = math.radians(2.0)  # a model's run has no repeats that tell how far sessions differ
_SUPPLY = Slot(BASE_OWNER, "supply_v")


@final
@dataclass(frozen=True)
class Since:
    """A motor as it was identified, and as a session saw it.

    Attributes:
        name: of the file in which the model stands.
        port: of the motor.
        plant: its model then.
        seen: the session's recording of it.
    """

    name: str
    port: Port
    plant: Plant
    seen: Recording

    def changes(self) -> Changes:
        """What differs now. The side before is that model under the session's own commands.

        Raises:
            DiagnosisError: the motor turned too little to tell.
            NxtTwinError: the session cannot be compared; its text says why.
        """
        self._refuse_too_little()
        config = self.plant.to_config()
        before = Case(self.name, Path(), config, (self._as_it_was(),), (), self.port)
        after = Case(f"port {self.port.upper()}", Path(), config, (self.seen,), (), self.port)
        return changed(before, [after], tolerance=_AS_WELL_AS_MODELS_DO)[0]

    def _refuse_too_little(self) -> None:
        counts = self.seen.columns[tacho_column(self.port)]
        turned = float(np.nanmax(counts) - np.nanmin(counts)) if np.isfinite(counts).any() else 0.0
        if self.seen.duration_s < _LEAST_S or turned < _LEAST_TURN_DEG:
            what = f"turned by {turned:.0f} deg in {self.seen.duration_s:.1f} s, too little to compare"
            mend = f"watch it for {_LEAST_S:.0f} s or more while it turns"
            raise DiagnosisError(what, where=f"port {self.port.upper()}", mend=mend)

    def _as_it_was(self) -> Recording:
        """The counts that the model predicts under these commands, on the battery that it was identified with."""
        columns = dict(self.seen.columns)
        supply_v = self.plant.values.get(_SUPPLY)
        if supply_v is not None:
            columns[BATTERY] = np.where(np.isfinite(columns[BATTERY]), supply_v, np.nan)
        seen = replace(self.seen, name=self.name, columns=columns)
        signals = with_supply(signals_of(seen, self.port), self.plant)
        with Simulator(self.plant.layout, workers=1) as simulator:
            predicted = simulator.trace(self.plant, free_job(signals, moving_start(signals)))["predicted"]
        counts = np.floor(predicted * 180.0 / math.pi)
        read = np.isfinite(columns[tacho_column(self.port)])
        columns[tacho_column(self.port)] = np.where(read, counts, np.nan)
        return replace(seen, columns=columns)
