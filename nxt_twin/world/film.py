"""Pictures of a world and films of a run, drawn by PyBullet's own renderer, which needs no screen."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Final, final

import numpy as np
from PIL import Image

from nxt_twin.arrays import FloatArray
from nxt_twin.mock.errors import WorldError
from nxt_twin.world.arena import Arena
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.scene import Floor
from nxt_twin.world.video import encoder, write_video

VIDEO: Final = ".mp4"
FORMATS: Final = (".gif", ".webp", ".png", VIDEO)
"""The first three are Pillow's; a PNG with more than one picture is an animated one."""
_TEXTURE_EDGE: Final = 1024
_ABOVE_M: Final = 1e-3
"""The floor's picture lies on the floor, which the renderer draws in squares, and is no body."""
_FIELD_DEG: Final = 45.0
_NEAR_M, _FAR_M = 0.02, 20.0


@final
@dataclass(frozen=True)
class View:
    """From where a picture is taken.

    Attributes:
        distance_m: from what it looks at.
        yaw_deg, pitch_deg: of the camera; from above a pitch is negative.
        size: width and height in pixels.
    """

    distance_m: float = 0.9
    yaw_deg: float = 40.0
    pitch_deg: float = -35.0
    size: tuple[int, int] = (480, 320)


DEFAULT_VIEW: Final = View()


@final
class Camera:
    """Looks at a world; it sees what is printed on its floor.

    Args:
        arena: the robot in its scene.
        view: from where.
    """

    def __init__(self, arena: Arena, view: View = DEFAULT_VIEW) -> None:
        self._arena, self._view = arena, view
        _show_floor(arena)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of its pictures, pixels."""
        return self._view.size

    def picture(self, at_m: FloatArray | None = None) -> Image.Image:
        """A picture of a place, or of the robot."""
        p, number = self._arena.engine.client
        view, target = self._view, self._arena.robot_pose().at_m if at_m is None else at_m
        width, height = view.size
        turned = p.computeViewMatrixFromYawPitchRoll(
            [*target[:2].tolist(), 0.05], view.distance_m, view.yaw_deg, view.pitch_deg, 0.0, 2
        )
        lens = p.computeProjectionMatrixFOV(_FIELD_DEG, width / height, _NEAR_M, _FAR_M)
        taken = p.getCameraImage(
            width,
            height,
            turned,
            lens,
            shadow=1,
            lightDirection=[-1.0, 1.5, 3.0],
            renderer=p.ER_TINY_RENDERER,
            physicsClientId=number,
        )
        pixels = np.reshape(np.array(taken[2], dtype=np.uint8), (height, width, 4))
        return Image.fromarray(pixels[..., :3])


@final
class Film:
    """A picture of the robot every so often of the world's time, from now on; kept compressed, without loss.

    Args:
        arena: the robot in its scene.
        view: from where.
        per_second: pictures in a second.
    """

    def __init__(self, arena: Arena, view: View = DEFAULT_VIEW, per_second: int = 10) -> None:
        self._camera = Camera(arena, view)
        self._per_second = per_second
        self._every = round(1000 / per_second)
        self._ticks = 0
        self._kept: list[bytes] = []
        arena.watchers.append(self._watch)

    def _watch(self) -> None:
        if self._ticks % self._every == 0:
            file = BytesIO()
            self._camera.picture().save(file, "PNG", compress_level=1)
            self._kept.append(file.getvalue())
        self._ticks += 1

    def pictures(self) -> Iterator[Image.Image]:
        """The pictures, in order."""
        for kept in self._kept:
            yield Image.open(BytesIO(kept)).convert("RGB")

    def write(self, path: Path) -> None:
        """Write it in the format that the file's name says.

        Raises:
            WorldError: that is none of `FORMATS`, nothing was filmed, or PyAV is not installed for an `.mp4`.
        """
        refuse_unknown(path)
        if not self._kept:
            raise WorldError("there is nothing to show: no time has passed", where=str(path))
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix.lower() == VIDEO:
            write_video(path, self.pictures(), self._camera.size, self._per_second)
        else:
            first, *others = self.pictures()
            first.save(path, save_all=True, append_images=others, duration=self._every, loop=0)


def refuse_unknown(path: Path) -> None:
    """Refuse a film's name that says no format.

    Raises:
        WorldError: it is none of `FORMATS`, or PyAV is not installed for an `.mp4`.
    """
    if path.suffix.lower() not in FORMATS:
        raise WorldError("is no kind of film", where=str(path), mend=f"end its name in {', '.join(FORMATS)}")
    if path.suffix.lower() == VIDEO:
        encoder()


def _show_floor(arena: Arena) -> None:
    """Put the floor's picture, which only eyes see, on the floor."""
    p, number = arena.engine.client
    floor: Floor = arena.setting.scene.floor
    shades = FloorPicture(floor, arena.setting.file).shades
    grey = Image.fromarray(np.flipud(np.round(255.0 * shades.T).astype(np.uint8)))
    width, depth = (1e-3 * size for size in floor.size_mm)
    right, far = 0.5 * width, 0.5 * depth
    plate = p.createVisualShape(
        p.GEOM_MESH,
        vertices=[[-right, -far, 0.0], [right, -far, 0.0], [right, far, 0.0], [-right, far, 0.0]],
        indices=[0, 1, 2, 0, 2, 3],
        uvs=[[0, 0], [1, 0], [1, 1], [0, 1]],
        normals=[[0, 0, 1]] * 4,
        physicsClientId=number,
    )
    body = p.createMultiBody(0.0, -1, plate, basePosition=[0.0, 0.0, _ABOVE_M], physicsClientId=number)
    with tempfile.TemporaryDirectory(prefix="nxt-twin-") as folder:
        path = Path(folder) / "floor.png"
        grey.resize((_TEXTURE_EDGE, _TEXTURE_EDGE)).convert("RGB").save(path)
        texture = p.loadTexture(str(path), physicsClientId=number)
    p.changeVisualShape(
        body, -1, textureUniqueId=texture, rgbaColor=[1.0, 1.0, 1.0, 1.0], physicsClientId=number
    )
