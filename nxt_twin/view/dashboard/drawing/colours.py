"""The dashboard's colours: the report's meanings, in shades that stand out of a dark ground and of a bright one."""

from __future__ import annotations

from typing import Final

RgbaBytes = tuple[int, int, int, int]

MEASURED: Final[RgbaBytes] = (142, 150, 160, 255)
PREDICTED: Final[RgbaBytes] = (42, 143, 208, 255)
BAND: Final[RgbaBytes] = (42, 143, 208, 110)
INNOVATION: Final[RgbaBytes] = (142, 150, 160, 255)
BOUND: Final[RgbaBytes] = (213, 94, 0, 220)
MEAN: Final[RgbaBytes] = (42, 143, 208, 255)
FORMER: Final[RgbaBytes] = (213, 94, 0, 150)
TORQUE: Final[RgbaBytes] = (0, 158, 115, 255)
TORQUE_BAND: Final[RgbaBytes] = (0, 158, 115, 110)
REFUSED: Final[RgbaBytes] = (230, 70, 70, 255)
LINK: Final[RgbaBytes] = (150, 110, 180, 255)
BATTERY: Final[RgbaBytes] = (214, 140, 20, 255)
FIGURES: Final[RgbaBytes] = (240, 240, 240, 255)
CLOUD_MEAN: Final[RgbaBytes] = (255, 255, 255, 255)
HAND: Final[RgbaBytes] = (230, 232, 235, 255)
AXES: Final[RgbaBytes] = (130, 138, 146, 255)
BRICK: Final[RgbaBytes] = (205, 208, 212, 255)
BRICK_DARK: Final[RgbaBytes] = (92, 98, 106, 255)
SCREEN: Final[RgbaBytes] = (148, 168, 140, 255)
ORANGE: Final[RgbaBytes] = (226, 120, 40, 255)
GHOST: Final[RgbaBytes] = (86, 180, 233, 90)

EFFECTS: Final[tuple[RgbaBytes, ...]] = (
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
