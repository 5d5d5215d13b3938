"""The mechanism moving through its stroke, snaps included, as a GIF."""

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path as File
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from stepwell.base import Floats, InputError, notify, require
from stepwell.figures.cells.linkage import Drawing
from stepwell.figures.cells.mechanism import refuse_long
from stepwell.figures.common import marks, reading, style, words, write
from stepwell.figures.common.sheet import blank, place, text_at
from stepwell.figures.common.words import literal, minus
from stepwell.figures.motion import overview, stroke_program, strokes
from stepwell.mechanism import layout
from stepwell.sequences import Cycle, Program
from stepwell.statics import Path

_DPI = 110.0
# Height of the stroke plan [mm].
_PLAN = 38.0
# A cell is shown at a stop or in a phase within this fraction of its full travel.
_AT = 1e-3


@style.styled
def animation(
    result: Cycle | Path | Program,
    file: str | os.PathLike[str],
    *,
    seconds: float = 8.0,
    fps: float = 20.0,
    progress: Callable[[int, int], None] | None = None,
) -> File:
    """Write a GIF of the moving mechanism with its energy landscape or its force loop.

    The actuator moves at constant speed and rests at its turning points. A snap happens at fixed
    stroke; it is drawn as a marked, slow motion between its two ends, because the quasi-static
    model has no speed. A path or a program has its stroke plan below, a program with the tolerance
    intervals of its turning points.

    Args:
        result: a cycle, a path or a stroke program, of up to 12 cells.
        file: path of the file, returned; written completely or not at all.
        seconds: duration of one round.
        fps: frames per second, up to 50; rounded to 100 over a whole number, as GIF requires.
        progress: called with (done, total) frames.

    Raises:
        ValueError: a chain too long to draw, a duration or a frame rate out of range, or a file
            name that does not end in .gif.
    """
    path = reading.path_of(result)
    refuse_long(path.chain)
    if not 0 < seconds < float("inf"):
        raise InputError(f"seconds = {seconds}: must be > 0.")
    if not 0 < fps <= 50:
        raise InputError(f"fps = {fps}: must be > 0 and at most 50.")
    if File(file).suffix.lower() != ".gif":
        raise InputError(f"{file}: an animation's name must end in .gif.")
    require("frames", seconds * fps, f"{seconds:g} s are")
    hundredths = max(2, round(100 / fps))
    count = max(2, round(100 * seconds / hundredths))
    frames = stroke_program.instants(path, seconds, count)
    scene = _Scene(result, path)

    look = [frames[k] for k in sorted({0, count // 3, 2 * count // 3, count - 1})]
    look += [frame for frame in frames if frame.snap][:1]

    def pictures() -> Iterator[Image.Image]:
        for k, frame in enumerate(frames):
            yield scene.shoot(frame)
            notify(progress, k + 1, count)

    seen = [scene.swatches(), *map(scene.shoot, look)]
    return write.write_gif(file, pictures(), seen, hundredths)


class _Scene:
    """One figure of which only the moving parts are redrawn."""

    def __init__(self, result: Cycle | Path | Program, path: Path):
        self.chain = path.chain
        colours = style.cell_colours(len(self.chain))
        # Lever chains have usual sizes; others show three digits of the largest value.
        known = not self.chain.elements
        of = words.stroke(self.chain.measure), words.force(self.chain.measure)
        self.readouts = [
            (one, usual if known else _decimals(column * one.factor))
            for one, usual, column in zip(of, (1, 2), (path.stroke, path.force), strict=True)
        ]
        self.travel = words.travel(self.chain.measure)
        # A cycle loads and unloads once; paths and programs show their stroke plan.
        below = 0.0 if isinstance(result, Cycle) else _PLAN
        samples = path.travel[:: max(1, len(path.travel) // 120)]
        ends = [path.travel.min(axis=0), path.travel.max(axis=0)]
        self.linkage = layout.ChainLayout(self.chain, ends)
        left, bottom, right, top = self.linkage.bounds(samples, 0.002)
        left = min(left, -2.2 * self.linkage.reach)
        wide, high = (right - left) * style.MM, (top - bottom) * style.MM

        side_by_side = len(self.chain) <= 2
        if side_by_side:
            size, stage, plot = (170.0, 78.0), (2.0, 12.0, 84.0, 54.0), (104.0, 12.0, 58.0, 58.0)
        else:
            drawn = min(60.0, high * 156.0 / wide)
            size, stage = (160.0, 88.0 + drawn), (2.0, 71.0, 156.0, drawn)
            plot = (16.0, 12.0, 140.0, 48.0)
        tall = size[1] + below
        self.figure: Figure = blank(size[0], tall)
        self.figure.set_dpi(_DPI)
        self.two = len(self.chain) == 2
        self.plot = place(self.figure, plot[0], plot[1] + below, *plot[2:])
        (overview.landscape if self.two else strokes.force_stroke)(path, ax=self.plot)

        ax = place(self.figure, stage[0], stage[1] + below, *stage[2:])
        marks.plain(ax, (0.0, stage[2], 0.0, stage[3]))
        scale = min(stage[2] / wide, stage[3] / high)
        x, y = (stage[2] - wide * scale) / 2, (stage[3] - high * scale) / 2
        origin = x - left * style.MM * scale, y - bottom * style.MM * scale
        weight = float(np.clip(0.5 + 0.6 * scale, 0.6, 1.3))
        self.drawing = Drawing(ax, self.linkage, origin, scale * style.MM, weight)

        def write_text(x: float, y: float, text: str = "", size: float = 9.0, **look: Any) -> Text:
            return text_at(self.figure, x, y, text, fontsize=size, va="baseline", **look)

        top = tall - 7.0
        self.stroke, self.force = write_text(6.0, top), write_text(36.0, top)
        box = {"boxstyle": "round,pad=0.2", "facecolor": style.YELLOW, "linewidth": 0}
        look = {"fontweight": "bold", "color": style.BLACK, "bbox": box}
        self.word = write_text(72.0, top, "snap", 11.0, **look)
        self.state = write_text(6.0, top - 7.0) if side_by_side else write_text(98.0, top)
        x, y = 6.0, 5.0 + below if side_by_side else top - 6.0
        for name, colour in zip(self.chain.names, colours, strict=True):
            text = write_text(x, y, literal(name), 7.0, color=colour, fontweight="bold")
            x += text.get_window_extent().width / _DPI * 25.4 + 5.0
        now = {"color": style.INK, "markeredgecolor": "white", "zorder": 11, "markersize": 7.0}
        (self.halo,) = self.plot.plot([], [], "o", markersize=15.0, color=style.YELLOW, zorder=10)
        (self.dot,) = self.plot.plot([], [], "o", **now)
        # Position in the stroke plan, if that is shown.
        self.plan: Line2D | None = None
        dots = [self.halo, self.dot]
        if below:
            windows = stroke_program.windows_of(result) if isinstance(result, Program) else []
            ax = place(self.figure, 16.0, 10.0, plot[0] + plot[2] - 16.0, _PLAN - 12.0)
            plan = stroke_program.plan_of(path)
            ax.set_xlim(stroke_program.limits(plan.way, 0.03))
            stroke_program.draw_plan(ax, plan, windows, 0.1)
            ax.set(xlabel=f"{stroke_program.COVERED} [{plan.unit}]", ylabel=plan.name)
            (self.plan,) = ax.plot([], [], "o", gid="now", **now)
            dots.append(self.plan)
        texts = (self.stroke, self.force, self.state, self.word)
        self.moving = (*self.drawing.artists, *texts, *dots)
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas = FigureCanvasAgg(self.figure)
        self.canvas.draw()
        # All static parts, drawn once.
        self.still = self.canvas.copy_from_bbox(self.figure.bbox)

    def swatches(self) -> Image.Image:
        """A picture with the colours of thin lines, so that the palette contains them."""
        width, height = (int(side) for side in self.figure.bbox.size)
        colours = [*style.cell_colours(len(self.chain)), style.LOADING, style.UNLOADING]
        sheet = Image.new("RGB", (len(colours), 1))
        sheet.putdata([tuple(round(255 * part) for part in to_rgb(one)) for one in colours])
        return sheet.resize((width, height), Image.Resampling.NEAREST)

    def shoot(self, frame: stroke_program.Instant) -> Image.Image:
        self.drawing.move(frame.travels, frame.sheets)
        (stroke, some), (force, more) = self.readouts
        u, f = float(np.sum(frame.travels)) * stroke.factor, frame.force * force.factor
        self.stroke.set_text(minus(f"{stroke.symbol} = {u:.{some}f} {stroke.sign}"))
        self.force.set_text(minus(f"{force.symbol} = {f:+.{more}f} {force.sign}"))
        x, y = frame.travels * self.travel.factor if self.two else (u, f)
        for dot in (self.dot, self.halo):
            dot.set_data([x], [y])
        if self.plan is not None:
            self.plan.set_data([frame.way], [frame.drive])
            places = zip(self.chain.cells, frame.travels, frame.sheets, strict=True)
            digits = "".join(str(int(reading.phases(*place, _AT))) for place in places)
            self.state.set_text(f"state {digits.replace('-1', '-')}")
        self.halo.set_visible(frame.snap)
        self.word.set_visible(frame.snap)
        self.canvas.restore_region(self.still)
        for artist in self.moving:
            if artist.get_visible():
                self.figure.draw_artist(artist)
        return Image.fromarray(np.asarray(self.canvas.buffer_rgba())[..., :3].copy())


def _decimals(values: Floats) -> int:
    # Decimals that show three digits of the largest value.
    largest = float(np.max(np.abs(values))) or 1.0
    return max(0, 2 - math.floor(math.log10(largest)))
