"""Figures written at once, with their size and their words but without their lines.

Drawing takes most of the time of a command that writes figures, and other tests look at what is
drawn. Here only the size in pixels and the words count; of a film the size and number of frames.
"""

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from html import escape
from typing import IO, Any
from unittest.mock import patch
from weakref import WeakKeyDictionary

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from PIL import Image

from stepwell.simulation import videos
from stepwell.simulation.drawing import Camera, Frame
from stepwell.simulation.hoppers import video as hopper_video


class _Words(RendererBase):
    """Draws nothing and remembers every word."""

    def __init__(self, figure: Figure):
        super().__init__()
        self.width, self.height = figure.bbox.size
        self.words: list[str] = []

    def get_canvas_width_height(self):
        return self.width, self.height

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):
        self.words.append(s)

    def _nothing(self, *_, **__):
        pass

    draw_path = draw_markers = draw_path_collection = draw_quad_mesh = _nothing
    draw_gouraud_triangles = draw_image = _nothing


@contextmanager
def sketched(*, words: bool) -> Iterator[None]:
    """Figures are saved as PNG without a drawing, and as SVG that holds only their words.

    In other formats they are drawn.

    Args:
        words: look for them, which takes half as long as drawing.
    """
    # A figure is saved two or three times as it is.
    seen: WeakKeyDictionary[Figure, list[str]] = WeakKeyDictionary()
    draw = Figure.savefig

    def words_of(figure: Figure) -> list[str]:
        if words and (figure.stale or figure not in seen):
            renderer = _Words(figure)
            figure.draw(renderer)
            seen[figure] = renderer.words
        return seen.get(figure, [])

    def save(figure: Figure, file: IO[Any], *, format: str, dpi: float, metadata: object) -> None:
        width, height = figure.get_size_inches()
        if format == "png":
            size = int(width * dpi), int(height * dpi)
            Image.new("1", size).save(file, "png")
            return
        if format != "svg":
            draw(figure, file, format=format, dpi=dpi, metadata=metadata)
            return
        found = "".join(f"<text>{escape(word)}</text>" for word in words_of(figure))
        size = f'width="{width * 72:g}pt" height="{height * 72:g}pt"'
        text = f"<svg {size}>{found}</svg>"
        file.write(text.encode() if isinstance(file, io.BytesIO) else text)

    with patch.object(Figure, "savefig", save):
        yield


class _Blank:
    """In place of a process that draws: frames of one grey, each another than the one before.

    Of frames that are alike a GIF keeps one.
    """

    def __init__(self, _model: object, cameras: Sequence[Camera], _goal: object = None):
        self._sizes = [camera.size for camera in cameras]
        self._count = 0

    def frames(self, _position: object, _path: object = ()) -> list[Frame]:
        self._count += 1
        grey = 40 * (self._count % 6)
        return [np.full((height, width, 3), grey, np.uint8) for width, height in self._sizes]

    def __enter__(self) -> "_Blank":
        return self

    def __exit__(self, *_: object) -> None:
        pass


@contextmanager
def filmed_blank() -> Iterator[None]:
    """Videos and pictures of simulations have their size and their frames, in which nothing is.

    tests/simulation/test_videos.py and test_jumps.py look at what is drawn, and
    tests/cli/test_walk.py has commands write it.
    """
    of_walks = patch.object(videos, "DrawingProcess", _Blank)
    with of_walks, patch.object(hopper_video, "DrawingProcess", _Blank):
        yield
