"""A rehearsal of a session: it compiles all code that the session needs, so no poll waits for a compiler."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.history import History

_LASTS_S: Final = 3.0
_POLL_S: Final = 0.025
_TURN_S: Final = 0.5
_POWERS_PCT: Final = (60, -45, 0, 30)
_LOADED: Final = ("constant_load", {"load": 0.03})


def rehearse(
    plants: Mapping[Port, Plant], options: TwinOptions | None = None, *, adopting: bool = False
) -> None:
    """Hold a short session with motors that carry a load; takes half a minute where nothing was compiled yet.

    Args:
        plants: the model of each motor.
        options: the twin's.
        adopting: whether diagnoses will run beside the session: one is made of what was rehearsed.

    Raises:
        PlantError: the plants cannot stand side by side.
    """
    twin = BrickTwin(plants, options)
    actors = BrickTwin({port: plant.with_effect(*_LOADED) for port, plant in plants.items()})
    histories = {port: History(port) for port in plants}
    for poll in range(round(_LASTS_S / _POLL_S)):
        now_s = poll * _POLL_S
        power_pct = _POWERS_PCT[int(now_s / _TURN_S) % len(_POWERS_PCT)]
        actors.move(now_s)
        for port, history in histories.items():
            tacho_deg = int(actors.state(port).angle_deg // 1)
            twin.read_tacho(port, now_s, tacho_deg, 1e-3)
            history.count(now_s, tacho_deg)
            history.command(now_s, twin.command(port, power_pct, "drive", now_s, 1e-3))
            actors.command(port, power_pct, "drive", now_s)
    if adopting:
        port, history = next(iter(histories.items()))
        Adopter(AtOnce()).start(port, twin.plant_as_run(port), history.recording(0.0, twin.supply_at))
