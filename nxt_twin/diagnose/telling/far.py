"""Parameters that a re-fit moved so far that the answer has to tell of them."""

from __future__ import annotations

import math
from collections.abc import Collection

from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

_TENFOLD = 10.0  # by factor: the answer begins with it
_NOTABLE = 3.0  # by factor: the answer tells it after what is missing
_FEW = 2  # more numbers at once speak of another motor, or of other units
_CHECK = "Check the units of command and reading, and whether the model is of this motor."
_FAR_OFF = 1.1  # by factor: less is within what motors of one make differ by


def moved_far(given: Plant, found: Plant, doubtful: Collection[str] = ()) -> tuple[str, ...]:
    """Sentences on the positive quantities of `given` that vanished or changed tenfold in `found`, if any did.

    Where several did, another motor or other units are likelier than another motor's state. The names in `doubtful`
    may not have moved at all.
    """
    far = [
        slot
        for slot, parameter in given.layout.parameters.items()
        if parameter.name not in doubtful and _is_far(given, found, slot, _TENFOLD)
    ]
    if len(far) > _FEW:
        each = listed(
            [f"{given.layout.parameters[slot].name} ({_times(given, found, slot)})" for slot in far]
        )
        return (f"The re-fit moved {len(far)} numbers tenfold or to nothing: {each}.", _CHECK)
    said = listed([_moved(given, found, slot) for slot in far])
    return (f"The re-fit moved {said}.",) if said else ()


def moved_notably(given: Plant, found: Plant, doubtful: Collection[str] = ()) -> tuple[str, ...]:
    """A sentence on the positive quantities that `found` has three to ten times as large or small as `given`.

    Those in `doubtful` may not have moved at all.
    """
    some = [
        slot
        for slot, parameter in given.layout.parameters.items()
        if parameter.name not in doubtful
        and _is_far(given, found, slot, _NOTABLE)
        and not _is_far(given, found, slot, _TENFOLD)
    ]
    return (f"The re-fit moved {listed([_moved(given, found, slot) for slot in some])}.",) if some else ()


def _is_far(given: Plant, found: Plant, slot: Slot, times: float) -> bool:
    """Whether a positive quantity vanished or changed by so many times."""
    parameter = given.layout.parameters[slot]
    before, after = given.values.get(slot, 0.0), found.values.get(slot)
    if after is None or before <= 0.0 or parameter.lower < 0.0 or parameter.frozen:
        return False
    return not before / times < after < before * times


def _times(given: Plant, found: Plant, slot: Slot) -> str:
    """By what a quantity was multiplied, in words."""
    after = found.values[slot]
    return f"{after / given.values[slot]:.3g} times" if after > 0.0 else "none"


def _moved(given: Plant, found: Plant, slot: Slot) -> str:
    """A quantity, with its value before and after."""
    parameter = given.layout.parameters[slot]
    before, after = (plant.values[slot] / parameter.si for plant in (given, found))
    times = _times(given, found, slot) if after > 0.0 else "none of"
    return f"{parameter.name} to {after:.3g} {parameter.unit}, {times} the given {before:.3g}"


def stays(given: Plant, kept: Plant, wanted: Plant, *, coloured: bool) -> tuple[str, ...]:
    """A remark where the given numbers stay, since a simulation errs more with those that single steps ask for.

    Args:
        given: the model as it came.
        kept: the baseline that the diagnosis shows.
        wanted: the baseline as single steps have it.
        coloured: whether errors of single steps go on from reading to reading.
    """
    other = _apart(given, wanted)
    moved = any(not math.isclose(kept.values.get(slot, 0.0), value) for slot, value in given.values.items())
    if moved or not other:
        return ()
    most = max(other, key=lambda slot: abs(math.log(other[slot])))
    parameter = given.layout.parameters[most]
    value = given.values[most] / parameter.si
    why = (
        " Errors of single steps go on from reading to reading, as where readings are held, stamped late or taken at "
        "another rate."
        if coloured
        else ""
    )
    return (
        f"Single steps ask for other numbers, with which a simulation errs more: the given ones stay. They ask most of "
        f"{parameter.name}, {other[most] * value:.3g} {parameter.unit} in place of {value:.3g}.{why}",
    )


def _apart(given: Plant, found: Plant) -> dict[Slot, float]:
    """By which factors positive numbers of `given` are others in `found`, where that is more than they scatter."""
    factors = {
        slot: found.values[slot] / value
        for slot, value in given.values.items()
        if min(value, found.values.get(slot, 0.0)) > 0.0
    }
    return {slot: by for slot, by in factors.items() if not 1.0 / _FAR_OFF < by < _FAR_OFF}


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
