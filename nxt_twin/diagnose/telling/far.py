"""Parameters that a re-fit moved so far that the answer has to tell of them."""

from __future__ import annotations

import math

from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.plant import Plant

_TENFOLD = 10.0


def moved_far(given: Plant, found: Plant) -> tuple[str, ...]:
    """A sentence on the positive quantities of `given` that vanished or changed tenfold in `found`, if any did."""
    said = []
    for slot, parameter in given.layout.parameters.items():
        before, after = given.values.get(slot, 0.0), found.values.get(slot)
        if after is None or before <= 0.0 or parameter.lower < 0.0 or parameter.frozen:
            continue
        if before / _TENFOLD < after < before * _TENFOLD:
            continue
        times = f"{after / before:.3g} times" if after > 0.0 else "none of"
        value = f"{after / parameter.si:.3g} {parameter.unit}"
        said.append(f"{parameter.name} to {value}, {times} the given {before / parameter.si:.3g}")
    return (f"The re-fit moved {listed(said)}.",) if said else ()


def furthest_off(given: Plant, found: Plant) -> str:
    """The number of `given` that `found` has furthest off, by how sure it was given to be; in words."""
    off = {
        slot: abs(math.log(found.values[slot] / given.values[slot])) / parameter.doubt
        for slot, parameter in given.layout.parameters.items()
        if min(given.values.get(slot, 0.0), found.values.get(slot, 0.0)) > 0.0
        and math.isfinite(parameter.doubt)
    }
    if not off:
        return ""
    slot = max(off, key=off.__getitem__)
    parameter = given.layout.parameters[slot]
    before, after = (plant.values[slot] / parameter.si for plant in (given, found))
    return f"{parameter.name} would be {after:.3g} {parameter.unit}, {after / before:.3g} times the given {before:.3g}"
