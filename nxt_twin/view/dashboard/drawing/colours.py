"""The dashboard's colours: the report's meanings, in shades that stand out of a dark ground and of a bright one."""

from __future__ import annotations

from typing import Final

Colour = tuple[int, int, int, int]

MEASURED: Final[Colour] = (142, 150, 160, 255)
PREDICTED: Final[Colour] = (42, 143, 208, 255)
BAND: Final[Colour] = (42, 143, 208, 110)
INNOVATION: Final[Colour] = (142, 150, 160, 255)
BOUND: Final[Colour] = (213, 94, 0, 220)
MEAN: Final[Colour] = (42, 143, 208, 255)
FORMER: Final[Colour] = (213, 94, 0, 150)
TORQUE: Final[Colour] = (0, 158, 115, 255)
TORQUE_BAND: Final[Colour] = (0, 158, 115, 110)
REFUSED: Final[Colour] = (230, 70, 70, 255)
LINK: Final[Colour] = (150, 110, 180, 255)
BATTERY: Final[Colour] = (214, 140, 20, 255)
FIGURES: Final[Colour] = (240, 240, 240, 255)
CLOUD_MEAN: Final[Colour] = (255, 255, 255, 255)
HAND: Final[Colour] = (230, 232, 235, 255)
AXES: Final[Colour] = (130, 138, 146, 255)
BRICK: Final[Colour] = (205, 208, 212, 255)
BRICK_DARK: Final[Colour] = (92, 98, 106, 255)
SCREEN: Final[Colour] = (148, 168, 140, 255)
ORANGE: Final[Colour] = (226, 120, 40, 255)
GHOST: Final[Colour] = (86, 180, 233, 90)

EFFECTS: Final[tuple[Colour, ...]] = (
    (230, 159, 0, 255),
    (0, 158, 115, 255),
    (204, 121, 167, 255),
    (190, 170, 20, 255),
    (213, 94, 0, 255),
    (86, 180, 233, 255),
    (160, 130, 240, 255),
    (120, 220, 120, 255),
    (240, 140, 150, 255),
    (176, 112, 62, 255),
)
"""For effects in the order in which they are first named; the first, `nothing`, has `MEASURED`."""
