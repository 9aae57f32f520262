"""Pictures as an .mp4 film: H.264 where the installed PyAV has an encoder for it, else MPEG-4 part 2."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from PIL import Image

from nxt_twin.mock.errors import WorldError

ENCODERS: Final = ("libx264", "libopenh264", "mpeg4")
"""By FFmpeg's names, the best first. The last is FFmpeg's own, so that every build has it."""
_BITS_PER_PIXEL: Final = 0.6
"""A picture's share: enough for edges and the floor's fine lines."""


def encoder() -> str:
    """The first of `ENCODERS` that the installed PyAV has.

    Raises:
        WorldError: PyAV is not installed.
    """
    return next(name for name in ENCODERS if _has(name))


def write_video(path: Path, pictures: Iterator[Image.Image], size: tuple[int, int], per_second: int) -> None:
    """Write pictures of one size (pixels; even ones) as a film without sound.

    Raises:
        WorldError: PyAV is not installed, or the file cannot be written.
    """
    av = _library()
    try:
        with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as film:
            stream = film.add_stream(encoder(), rate=per_second)
            stream.width, stream.height = size
            stream.pix_fmt = "yuv420p"
            stream.bit_rate = round(_BITS_PER_PIXEL * size[0] * size[1] * per_second)
            for picture in pictures:
                film.mux(stream.encode(av.VideoFrame.from_image(picture)))
            film.mux(stream.encode())
    except (OSError, av.FFmpegError) as failure:
        raise WorldError(f"cannot be written: {failure.strerror}", where=str(path)) from None


def _has(name: str) -> bool:
    av = _library()
    try:
        av.codec.Codec(name, "w")
    except ValueError:
        return False
    return True


def _library() -> Any:  # noqa: ANN401 - an optional library
    try:
        import av
    except ImportError:
        mend = "pip install 'nxt-twin[film]', or end its name in .gif or .webp"
        raise WorldError("a film as .mp4 needs PyAV, which is not installed", mend=mend) from None
    return av
