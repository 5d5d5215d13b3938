"""Pictures one after the other as one file that moves."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import write_atomic

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

_COLOURS = 96


def write_gif(
    file: str | os.PathLike[str],
    pictures: Iterator[Picture],
    seen: Sequence[Picture],
    hundredths: int | Sequence[int],
) -> Path:
    """Write a GIF that repeats for ever, whole or not at all.

    Args:
        file: where to.
        pictures: all frames in RGB, one or more, of one size.
        seen: pictures of that size with the colours that matter: all frames share them.
        hundredths: how long a frame lasts [0.01 s], or how long each does.

    Returns:
        The file.
    """
    from PIL import Image

    shared = _palette(seen)
    frames = (one.quantize(palette=shared, dither=Image.Dither.NONE) for one in pictures)
    each = 10 * hundredths if isinstance(hundredths, int) else [10 * one for one in hundredths]
    movie = io.BytesIO()
    next(frames).save(
        movie,
        format="GIF",
        save_all=True,
        append_images=frames,
        duration=each,
        loop=0,
        # Stores only the pixels that changed.
        optimize=True,
    )
    write_atomic(Path(file), movie.getvalue())
    return Path(file)


def _palette(pictures: Sequence[Picture]) -> Picture:
    """A picture in the colours that all frames share."""
    from PIL import Image

    width, height = pictures[0].size
    sheet = Image.new("RGB", (width, height * len(pictures)))
    for k, picture in enumerate(pictures):
        sheet.paste(picture, (0, k * height))
    shared = sheet.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT)
    # Averaging greys the paper, and Pillow tells very light colours apart only roughly.
    colours = np.array(shared.getpalette()).reshape(-1, 3)
    colours[colours.min(axis=1) >= 248] = 255
    shared.putpalette(colours.ravel().tolist())
    return shared
