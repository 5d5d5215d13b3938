"""The plates of a chain with their anchors: what to mark and drill."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import Floats, InputError, Vec2, from_unit
from stepwell.figures.cells.mechanism import refuse_long
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.common.marks import along_x, along_y, arrow, mm, mm_pair
from stepwell.mechanism import Cell, Chain, layout

MOST_CELLS = 12
# Least width of a cell; above and below its plates, and for the key below all [mm].
_WIDE, _ABOVE, _BELOW, _KEY = 58.0, 14.5, 8.5, 4.5
# At the left of the plates for the pitch, and at the right for the stroke [mm].
_LEFT, _RIGHT = 7.0, 8.0
# Least widths left and right of the middle, where the coordinates are written [mm].
_WORDS = 20.0, 25.0
_LINE, _LETTER = 3.2, 1.3  # height of a line, and mean width of a letter [mm]
_NEAREST = 1.2  # least distance of two drawn holes [mm]
_FREE = "the distance of the two joints of a block, and the length of a block between two cells"


@style.styled
def holes(chain: Chain, pitch: float | None = None, origin: Vec2 = (0.0, 0.0)) -> Figure:
    """The inner and the outer plate of each cell, with p and q and the holes of the grid.

    A cell is drawn from the front, at half travel: the levers are level, and the stroke is upwards.
    Each plate has its origin in the middle of its lever joints; x points across the stroke from the
    inner to the outer block, y along the stroke. In a chain every second cell is mirrored: its
    plates are marked on the back. At the natural width of a column, usual sizes are drawn 1:1.

    Args:
        chain: up to 12 cells of levers and bands.
        pitch: distance of the holes [m]. None draws the anchors alone.
        origin: a point of their grid [m], in the frame of each plate; by default its origin.

    Raises:
        ValueError: elements, too many cells, or a pitch that is not positive.
    """
    if chain.elements:
        raise InputError("the chain has elements, which have no anchors: draw it with mechanism.")
    refuse_long(chain, MOST_CELLS, "are legible")
    if pitch is not None and not 0 < pitch < math.inf:
        raise InputError(f"pitch = {pitch} m: must be > 0, the distance of the holes.")
    width = sheet.page_width(style.COLUMN if len(chain) <= 3 else style.PAGE)
    columns = max(1, min(len(chain), int(width / _WIDE)))
    plates = _Plates(chain, pitch, origin, width / columns)
    high = plates.high + _ABOVE + _BELOW
    notes = words.wrapped(plates.notes(width), int((width - 4.0) / _LETTER))
    foot = _LINE * len(notes) + 2.0
    rows = -(-len(chain) // columns)
    figure = sheet.blank(width, rows * high + foot + _KEY)
    places = sheet.grid(len(chain), columns, (width / columns, high), (0.0, foot + _KEY))
    for i, (left, bottom) in enumerate(places):
        plates.draw(sheet.place(figure, left, bottom, width / columns, high), i)
    look = style.hollow(5.0, style.INK, markeredgewidth=1.0)
    key = legends.applicable(
        (True, legends.mark("origin: middle of the joints", "+", color=style.BLUE)),
        (True, legends.mark("joint", **look)),
        (pitch is not None, legends.mark("hole", **style.hollow(3.0, style.FAINT))),
    )
    legends.below(figure, key, len(key), left=2.0, handlelength=1.0)
    for k, line in enumerate(notes):
        sheet.text_at(figure, 2.0, _KEY + foot - _LINE * (k + 1) - 1.0, line)
    return figure


class _Plates:
    """Sizes that all plates of a chain share, in mm of the mechanism; `scale` makes them mm of the
    page.
    """

    def __init__(self, chain: Chain, pitch: float | None, through: Vec2, width: float):
        self.chain, self.width = chain, width
        self.linkage = layout.ChainLayout(chain)
        self.colours = style.cell_colours(len(chain))
        self.pitch = None if pitch is None else pitch * style.MM
        self.through = np.array(through) * style.MM
        lever = max(cell.lever for cell in self._cells) * style.MM
        pair = self.pair = self._off_holes(self.linkage.half_pair * style.MM)
        ends = [
            np.array([getattr(band, name) for cell in self._cells for band in cell.bands])
            for name in "pq"
        ]
        p, q = (np.vstack([one * style.MM, np.zeros(2)]) for one in ends)
        edge = self.edge = min(self.pitch or lever, 0.25 * lever)
        tall = max(pair, self.pitch or 0.0)
        both = np.concatenate([p[:, 1], q[:, 1], [-tall, tall]])
        self.y = float(both.min() - edge), float(both.max() + edge)
        self.inner = float(p[:, 0].min() - edge), float(p[:, 0].max() + edge)
        self.outer = float(q[:, 0].min() - edge), float(q[:, 0].max() + edge)
        # Plates that would cover each other are drawn further apart.
        self.apart = self.inner[1] - self.outer[0] + 0.3 * edge
        span = max(self.apart, lever)
        self.facing = (self.inner[1] + span + self.outer[0]) / 2
        sides = self.facing - self.inner[0], span + self.outer[1] - self.facing
        room = width - _LEFT - _RIGHT
        fit = room / sum(sides)
        for side, other, least in zip(sides, sides[::-1], _WORDS, strict=True):
            if side * fit < least:
                fit = min(fit, (room - least) / other)
        self.scale = 1.0 if 1.0 <= fit < 2.0 else fit
        least = [max(side * self.scale, own) for side, own in zip(sides, _WORDS, strict=True)]
        self.middle = _LEFT + least[0] + (room - sum(least)) / 2
        self.high = (self.y[1] - self.y[0]) * self.scale

    def _off_holes(self, pair: float) -> float:
        """Half the distance of two joints near that: free in the model, but off drilled holes."""
        if self.pitch is None or self.pitch >= 4.0 * pair:
            return pair
        off = abs(math.remainder(self.through[1], self.pitch))
        half = 0.5 if off <= self.pitch / 4 else 1.0
        return self.pitch * (max(round(pair / self.pitch - half), 0) + half)

    @property
    def _cells(self) -> list[Cell]:
        return [cell for cell in self.chain.cells if isinstance(cell, Cell)]

    def notes(self, width: float) -> str:
        """Origin, axes, what is free, and the scale, in sentences."""
        back = [
            words.literal(name)
            for name, side in zip(self.chain.names, self.linkage.sides, strict=True)
            if side < 0
        ]
        turned = (
            f"On the plates of {words.shortened(', '.join(back), 40)}, marked on the back, +x "
            f"is to the left when seen from the front. " * bool(back)
        )
        size = f"1:{1 / self.scale:.3g}" if self.scale <= 1 else f"{self.scale:.3g}:1"
        grid = f"Grid through {mm_pair((self.through / style.MM).tolist())} mm of each plate. "
        grid *= self.pitch is not None and bool(self.through.any())
        return (
            f"Seen from the front at half travel. +x: across the stroke, from the inner to the "
            f"outer block; +y: along the stroke. {grid}{turned}The outer block of a cell is the "
            f"inner block of the next. Free: {_FREE}. Scale {size} on a print {width:.4g} mm wide."
        )

    def draw(self, ax: Axes, i: int) -> None:
        """One cell on the page [mm]."""
        cell, colour, scale = self._cells[i], self.colours[i], self.scale
        high = self.high + _ABOVE + _BELOW
        marks.plain(ax, (0.0, self.width, 0.0, high))
        lever = cell.lever * style.MM
        span = max(self.apart, lever)
        # Equal on all plates: the middle between them, and the height of the origin.
        middle = self.inner[1] + span + self.outer[0]
        origin = np.array([self.middle - middle / 2 * scale, _BELOW - self.y[0] * scale])
        joints = origin, origin + np.array([span * scale, 0.0])
        for at, (left, right) in zip(joints, (self.inner, self.outer), strict=True):
            x, y = at[0] + np.array([left, right]) * scale, at[1] + np.array(self.y) * scale
            face = {"facecolor": style.pale(style.BLOCK, 0.4), "edgecolor": style.INK}
            ax.fill(x[[0, 1, 1, 0]], y[[0, 0, 1, 1]], **face, linewidth=0.7, zorder=1)
            self._drill(ax, at, (left, right))
        for up in (-self.pair, self.pair):
            ends = np.array(joints) + np.array([0.0, up * scale])
            pins: dict[str, Any] = style.hollow(5.0, marker="o", markeredgewidth=1.0, gid="lever")
            ax.plot(*ends.T, color=style.INK, linewidth=1.2, zorder=3, **pins)
        top = _BELOW + self.high
        far = f"$r$ = {mm(cell.lever)} mm" + " (drawn longer)" * (span > lever)
        along_x(ax, (joints[0][0], joints[1][0]), (top, top + 2.0), far, gid="r")
        for at in joints:
            self._axes(ax, at)
        letters: list[legends.Label] = []
        names = zip("pq", joints, ("inner", "outer"), (-1.0, 1.0), ("right", "left"), strict=True)
        for name, at, block, way, side in names:
            places = [getattr(band, name) for band in cell.bands]
            for x, y in at + np.array(places) * style.MM * scale:
                ax.plot(x, y, "o", color=colour, markersize=6.0, zorder=6, gid=name)
                letters.append(legends.Label((x, y), name, colour))
            placed = "\n".join(f"{name} {mm_pair(place)} mm" for place in places[:2])
            look = {"ha": side, "va": "top", "linespacing": 1.15}
            ax.text(self.middle + way, _BELOW - 1.0, f"{block} block", **look)
            ax.text(
                self.middle + way, _BELOW - 4.2, placed, color=colour, **look, fontweight="bold"
            )
        self._head(ax, i, high)
        if self.pitch is not None:
            step = self._step
            by = f"{_mm_of(self.pitch)} mm" if step == 1 else f"{step} × {_mm_of(self.pitch)} mm"
            x = origin[0] + self.inner[0] * scale
            low = -(-self.through[1] % (step * self.pitch))  # the highest hole at or below y = 0
            far = origin[1] + low * scale, origin[1] + (low + step * self.pitch) * scale
            along_y(ax, far, (x, x - 2.0), by, gid="pitch")
        x = self.width - 3.0
        y = _BELOW + self.high / 2
        arrow(ax, (x, y - 6.0), (x, y + 6.0), style.INK, 1.2)
        ax.text(x - 1.2, y, "stroke", rotation=90, ha="right", va="center")
        sheet.root(ax).draw_without_rendering()
        legends.place_labels(ax, letters, keep_clear=[t.get_window_extent() for t in ax.texts])

    def _head(self, ax: Axes, i: int, high: float) -> None:
        """Name of the cell, the side of its marks, and its limit angle and travel."""
        cell = self._cells[i]
        back = bool(self.linkage.sides[i] < 0)
        look: dict[str, Any] = {"va": "top", "fontsize": 7.0}
        name = words.literal(words.shortened(self.chain.names[i], 14))
        bold: dict[str, Any] = {"fontweight": "bold", "color": self.colours[i]}
        start = 2.0 + sheet.current().indent
        ax.text(start, high - 1.5, name + ", on the back" * back, **(look | bold))
        stops = rf"$\theta_c$ = {math.degrees(cell.limit):.4g}°, travel {mm(cell.full_travel)} mm"
        ax.text(start, high - 1.5 - _LINE, stops, **look)

    def _axes(self, ax: Axes, at: Floats) -> None:
        """The origin, and the axes x and y."""
        ax.plot(*at, "+", color=style.BLUE, markersize=7.0, markeredgewidth=1.4, zorder=7)
        length = max(4.0, min(7.0, 0.9 * self.y[1] * self.scale))
        for way, name, off in (((1, 0), "x", (0.0, 1.3)), ((0, 1), "y", (1.3, -0.6))):
            tip = at + length * np.array(way)
            arrow(ax, at, tip, style.BLUE, 0.8)
            look = {"ha": "center", "va": "center", "color": style.BLUE, "zorder": 9}
            ax.text(tip[0] + off[0], tip[1] + off[1], f"${name}$", **look)

    @property
    def _step(self) -> int:
        """Every which hole is drawn, so that no two run together."""
        return math.ceil(_NEAREST / ((self.pitch or math.inf) * self.scale))

    def _drill(self, ax: Axes, at: Floats, sides: tuple[float, float]) -> None:
        if self.pitch is None:
            return
        pitch, inset = self.pitch * self._step, 0.3 * min(self.edge, self.pitch)
        every = [
            at_0
            + pitch
            * np.arange(
                math.ceil((low - at_0 + inset) / pitch),
                math.floor((high - at_0 - inset) / pitch) + 1,
            )
            for (low, high), at_0 in zip((sides, self.y), self.through, strict=True)
        ]
        x, y = (one.ravel() * self.scale for one in np.meshgrid(*every))
        size = min(3.0, 1.2 * pitch * self.scale)
        look = style.hollow(size, style.FAINT, markeredgewidth=0.6)
        ax.plot(at[0] + x, at[1] + y, "o", **look, zorder=2, gid="hole")


def _mm_of(number: float) -> str:
    """A number of millimetres with four digits."""
    return mm(from_unit(number, "mm"))
