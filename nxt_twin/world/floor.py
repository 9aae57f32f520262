"""The print on a floor, as a picture of the light that each spot reflects."""

from __future__ import annotations

from pathlib import Path
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.mock.errors import WorldError
from nxt_twin.recording.yaml_place import YamlPlace
from nxt_twin.world.blame import blaming
from nxt_twin.world.scene import Floor, Print, Spot

_GREATEST_SPOTS = 25_000_000


@final
class FloorPicture:
    """Shades 0 (black) to 1 (white) on a grid, the world's origin in its middle.

    Args:
        floor: what was written.
        file: the world file, beside which paths of pictures start.

    Raises:
        WorldError: a picture cannot be read, or the floor has too many spots.
    """

    def __init__(self, floor: Floor, file: Path) -> None:
        place = YamlPlace(file, ("scene", "floor"))
        width, depth = (round(size / floor.grain_mm) for size in floor.size_mm)
        if width * depth > _GREATEST_SPOTS:
            mend = f"at most {_GREATEST_SPOTS} spots: make size_mm smaller or grain_mm larger"
            raise WorldError("has too many spots", where=place.of(("size_mm",)), mend=mend)
        self._grain_m = 1e-3 * floor.grain_mm
        self._corner_m = -0.5 * self._grain_m * np.array([width, depth])
        self.shades = np.full((width, depth), floor.shade)
        x = (self._corner_m[0] + self._grain_m * (np.arange(width) + 0.5)) * 1e3
        y = (self._corner_m[1] + self._grain_m * (np.arange(depth) + 0.5)) * 1e3
        for number, each in enumerate(floor.prints):
            with blaming(place, "prints", str(number), "picture"):
                _put(self.shades, each, x[:, None], y[None, :], file.parent)
        self._framed = np.pad(self.shades, 1, constant_values=floor.shade)
        self._corner_m -= self._grain_m
        self._last = np.array(self._framed.shape) - 0.5

    def shade(self, place_m: FloatArray) -> FloatArray:
        """The shades at places on the floor, shape (places,), each given by x and y, shape (places, 2)."""
        # A margin of what is beyond runs round the grid, so that each place has its spot.
        index = np.clip((place_m - self._corner_m) / self._grain_m, 0.0, self._last).astype(np.int64)
        return self._framed[index[:, 0], index[:, 1]]


def _put(shades: FloatArray, what: Print, x: FloatArray, y: FloatArray, folder: Path) -> None:
    """Print over what is there; x of shape (width, 1) and y of shape (1, depth), mm."""
    if what.line_mm is not None:
        for start, end in zip(what.line_mm, what.line_mm[1:], strict=False):
            shades[_distance(x, y, start, end) <= 0.5 * what.width_mm] = what.shade
    elif what.disc_mm is not None:
        shades[_distance(x, y, what.disc_mm, what.disc_mm) <= 0.5 * what.width_mm] = what.shade
    elif what.gradient_mm is not None:
        (x0, _), (x1, _) = what.gradient_mm
        share = np.clip((x - x0) / (x1 - x0 or 1.0), 0.0, 1.0) + 0.0 * y
        inside = _inside(x, y, what.gradient_mm)
        shades[inside] = (what.shade + share * (what.to_shade - what.shade))[inside]
    elif what.patch_mm is not None:
        inside = _inside(x, y, what.patch_mm)
        shades[inside] = what.shade if what.picture is None else _picture(what, x, y, folder)[inside]


def _distance(x: FloatArray, y: FloatArray, start: Spot, end: Spot) -> FloatArray:
    """From each spot to a straight piece of line, mm."""
    along = np.subtract(end, start)
    length2 = float(along @ along) or 1.0
    share = np.clip(((x - start[0]) * along[0] + (y - start[1]) * along[1]) / length2, 0.0, 1.0)
    away: FloatArray = np.hypot(x - start[0] - share * along[0], y - start[1] - share * along[1])
    return away


def _inside(x: FloatArray, y: FloatArray, corners: tuple[Spot, Spot]) -> BoolArray:
    (x0, y0), (x1, y1) = corners
    return (x >= min(x0, x1)) & (x <= max(x0, x1)) & (y >= min(y0, y1)) & (y <= max(y0, y1))


def _picture(what: Print, x: FloatArray, y: FloatArray, folder: Path) -> FloatArray:
    """A picture's shades at every spot; its left is at the smaller x, its top at the larger y."""
    from matplotlib.image import imread

    path = folder / (what.picture or "")
    if not path.is_file():
        raise WorldError("there is no such file", where=str(what.picture), mend="give a PNG file")
    try:
        pixels = np.asarray(imread(path), dtype=np.float64)
    except (OSError, SyntaxError, ValueError):
        raise WorldError("is no picture", where=str(what.picture), mend="give a PNG file") from None
    grey = pixels[..., :3].mean(axis=2) if pixels.ndim == 3 else pixels
    (x0, y0), (x1, y1) = what.patch_mm or ((0.0, 0.0), (1.0, 1.0))
    column = np.clip((x - min(x0, x1)) / abs(x1 - x0) * grey.shape[1], 0, grey.shape[1] - 1).astype(np.int64)
    row = np.clip((max(y0, y1) - y) / abs(y1 - y0) * grey.shape[0], 0, grey.shape[0] - 1).astype(np.int64)
    shades: FloatArray = grey[row, column]
    return shades
