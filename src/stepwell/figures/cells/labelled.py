"""A unit cell and a chain with the symbols of the theory and the design files."""

import math
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.transforms import Bbox

from stepwell.base import Floats, InputError
from stepwell.figures.cells.linkage import Drawing
from stepwell.figures.cells.mechanism import refuse_long
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.legends import Label
from stepwell.figures.common.marks import along_x, along_y, arrow, limits, mm, mm_pair, plain
from stepwell.figures.common.words import literal
from stepwell.mechanism import Band, Cell, Chain, Element, layout

# More cells have no room for their symbols in a column.
_MOST_CELLS = 4
# Drawn travel of the cell, and of each cell in a chain, as fractions of the full travel.
_SHOWN, _SHARES = 0.72, (1.0, 0.5, 0.75, 0.5)
_EDGE, _GAP, _FOOT = 2.0, 4.0, 10.0  # round, between and below the drawings [mm of the page]
_WIDE = style.COLUMN - 2 * _EDGE
_BIG = 9.0
_LEFT, _RIGHT = 12.0, 26.0  # margins of the cell for text and dimensions
_DASHES = (0, (3.0, 2.0))
_Look = dict[str, Any]
_GHOST: _Look = {"edgecolor": style.FAINT, "linewidth": 0.6, "linestyle": _DASHES}


@style.styled
def labelled_cell(cell: Cell | None = None) -> Figure:
    """A unit cell with its symbols, and below it the triangle of the band's length.

    The inner block is held and the outer block is pulled along y; its positions at the stops are
    dashed. The triangle has the lever r, then d = q - p from its end; the third side is the length
    of the band. Both are true to scale, with lengths in mm and angles in degrees. One column wide.

    Args:
        cell: a cell with a single band; by default that of the paper with q = (10, -15) mm.

    Raises:
        ValueError: an element, or a cell with several bands.

    Source: Kamp et al. 2024, Fig. 1.
    """
    if cell is None:
        cell = Cell(Band((-0.010, 0.0), (0.010, -0.015)))
    if isinstance(cell, Element):
        raise InputError("cell is an Element, which has no levers: draw it with element_curve.")
    if len(cell.bands) != 1:
        raise InputError(
            f"cell has {len(cell.bands)} bands: the figure shows one band. Give a cell of one "
            f"band, such as Cell(cell.bands[0], cell.lever, cell.limit)."
        )
    shown = _Shown(cell)
    high = [box[3] - box[2] for box in (shown.box, shown.triangle_box)]
    figure = sheet.blank(style.COLUMN, sum(high) + _GAP + _FOOT + _EDGE)
    shown.draw(sheet.place(figure, _EDGE, _FOOT + high[1] + _GAP, _WIDE, high[0]))
    shown.draw_triangle(sheet.place(figure, _EDGE, _FOOT, _WIDE, high[1]))
    law = r"travel $s = r\,(\sin\theta + \sin\theta_c)$, from 0 to $S = 2\,r\,\sin\theta_c$"
    sheet.text_at(figure, style.COLUMN / 2, 2.5, law, ha="center", fontsize=8.0)
    return figure


@style.styled
def labelled_chain(chain: Chain) -> Figure:
    """A chain with the names of its parts, and the travels of its cells that sum to the stroke.

    In the upper drawing every cell is at 0; in the lower one the actuator has pulled. One column
    wide, lengths in mm.

    Args:
        chain: up to four cells of levers and bands.

    Raises:
        ValueError: elements, or more than four cells.
    """
    if chain.elements:
        raise InputError("the chain has elements, which have no levers: draw it with mechanism.")
    refuse_long(chain, _MOST_CELLS, "have room for their symbols")
    linkage = layout.ChainLayout(chain)
    pulled = [part * s for part, s in zip(_SHARES, chain.full_travels, strict=False)]
    states = [[0.0] * len(chain), pulled]
    boxes = np.array([linkage.bounds([travels]) for travels in states])
    left, right = min(boxes[:, 0].min(), -1.8 * linkage.reach), boxes[:, 2].max()
    # From metres to the page's mm, with room for the arrow at the right.
    scale = (_WIDE - 22.0) / (right - left)
    room = np.array([(5.0, 9.0), (17.0, 3.0)])
    high = np.ptp(boxes[:, [1, 3]], axis=1) * scale + room.sum(axis=1)
    figure = sheet.blank(style.COLUMN, sum(high) + 2 * _EDGE)
    for k, (travels, low, under) in enumerate(zip(states, boxes[:, 1], room[:, 0], strict=True)):
        ax = sheet.place(figure, _EDGE, _EDGE + high[1] * (k == 0), _WIDE, high[k])
        origin = 1.0 - left * scale, under - low * scale
        plain(ax, (0.0, _WIDE, 0.0, high[k]))
        pose = Drawing(ax, linkage, origin, scale, 1.15).move(travels)
        _name_blocks(ax, pose.blocks * scale + np.tile(origin, 2), first=k == 0)
        if k == 0:
            _name_cells(ax, chain, 1.0, high[k] - 4.0)
            _name_anchors(ax, pose.bands * scale + origin)
        else:
            rest = float(linkage.pose(states[0]).blocks[-1, 2]) * scale + origin[0]
            feet = float(pose.blocks[-1, 1]) * scale + origin[1]
            _add_up(ax, rest, [s * scale for s in pulled], under - 5.0, feet)
    return figure


class _Shown:
    """A partly opened cell on the page; all lengths are the page's mm."""

    def __init__(self, cell: Cell):
        self.cell, self.band = cell, cell.bands[0]
        self.theta = float(cell.angle(_SHOWN * cell.full_travel))
        linkage = layout.ChainLayout(Chain((cell,)))
        half = np.array([linkage.half_block, linkage.reach])
        p, q = np.array(self.band.p), self._joint(self.theta, cell.lever) + self.band.q
        left, right = min(p[0], -half[0]), max(q[0], cell.lever + half[0])
        self.scale = (_WIDE - _LEFT - _RIGHT) / (right - left)
        self.half, self.pair = half * self.scale, linkage.half_pair * self.scale
        self.lever, self.right = cell.lever * self.scale, right * self.scale
        self.outer = self._joint(self.theta, self.lever)
        self.p, self.q = p * self.scale, q * self.scale
        self.colour = style.cell_colours(1)[0]
        self.stops = [self._joint(sign * cell.limit, self.lever) for sign in (-1, 1)]

    @staticmethod
    def _joint(theta: float, lever: float) -> Floats:
        # Joint midpoint of the outer block, relative to that of the inner block.
        return lever * np.array([math.cos(theta), math.sin(theta)])

    @property
    def box(self) -> sheet.Box:
        """left, right, bottom, top of the drawing."""
        points = [self.p, self.q, self.stops[0] - self.half, self.stops[1] + self.half]
        low, high = np.min(points, axis=0)[1], np.max(points, axis=0)[1]
        low = min(float(low), float(-self.half[1]) - 9.0)
        left = float(self.right) + _RIGHT - _WIDE
        return left, left + _WIDE, low - 4.0, float(high) + 11.0

    @property
    def triangle_box(self) -> sheet.Box:
        """left, right, bottom, top of the triangle, as wide as the drawing above it."""
        corners = np.array([(0.0, 0.0), *self.stops, self._third])
        left, right, bottom, top = limits(corners, (0.0, 0.0, 6.0, 6.0))
        spare = _WIDE - (right - left)
        return left - 0.3 * spare, right + 0.7 * spare, bottom, top

    @property
    def _third(self) -> Floats:
        return self.outer + np.array(self.band.d) * self.scale

    def draw(self, ax: Axes) -> None:
        plain(ax, self.box)
        for joint, name in zip(self.stops, ("state 0", "state 1"), strict=True):
            ax.add_patch(Polygon(self._block(joint), facecolor="none", **_GHOST, zorder=1.5))
            ax.text(self.right + 13.5, joint[1] + self.half[1], name, va="center", zorder=9)
        for joint, colour in ((np.zeros(2), style.FIXED_BLOCK), (self.outer, style.BLOCK)):
            look: _Look = {"facecolor": colour, "edgecolor": style.INK, "linewidth": 0.7}
            ax.add_patch(Polygon(self._block(joint), **look, zorder=2))
        # What holds the inner block.
        half, y = 1.5 * self.half[0], -self.half[1]
        ax.plot([-half, half], [y, y], color=style.INK, linewidth=1.1, zorder=3)
        for x in np.linspace(-half, half, 7)[1:]:
            ax.plot([x - 1.6, x], [y - 1.6, y], color=style.INK, linewidth=0.5, zorder=1)
        for along in (-self.pair, self.pair):
            x, y = np.array([(0.0, along), self.outer + np.array([0.0, along])]).T
            pins: _Look = style.hollow(3.4, markeredgewidth=0.7, marker="o", gid="lever")
            ax.plot(x, y, color=style.INK, linewidth=1.8, zorder=3, **pins)
        ends = np.array([self.p, self.q])
        look = {"color": self.colour, "linewidth": 2.2, "marker": "o", "markersize": 4.0}
        ax.plot(*ends.T, **look, zorder=4, gid="band")
        for name, start, end in (("p", np.zeros(2), self.p), ("q", self.outer, self.q)):
            ax.plot(*np.array([start, end]).T, color=style.BLUE, linewidth=1.2, zorder=7, gid=name)
            if np.any(start != end):
                arrow(ax, start, end, style.BLUE, 1.2)
            ax.plot(*start, "+", color=style.BLUE, markersize=5.0, markeredgewidth=1.2, zorder=8)
        (_, low), (_, high) = (stop + self.half for stop in self.stops)
        edge, top = (self.outer + self.half).tolist()
        along_y(ax, (low, top), (edge, self.right + 5.0), "$s$", gid="s")
        full = f"$S$ = {mm(self.cell.full_travel)} mm"
        along_y(ax, (low, high), (edge, self.right + 12.0), full, gid="S")
        self._turn(ax, -self.pair, 0.56)
        self._name(ax)

    def _block(self, joint: Floats) -> Floats:
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        return joint + corners * self.half

    def _turn(self, ax: Axes, foot: float, share: float) -> None:
        """θ, from the x axis to a lever that starts at height `foot`."""
        look: _Look = {"color": style.VERMILLION, "linewidth": 0.9, "zorder": 7}
        ax.plot([0.0, 0.9 * self.lever], [foot, foot], linestyle=_DASHES, **look)
        angle = np.linspace(0.0, self.theta, 31)
        arc = share * self.lever * np.column_stack([np.cos(angle), np.sin(angle)])
        arc[:, 1] += foot
        ax.plot(*arc.T, **look, gid="theta")
        arrow(ax, arc[-4], arc[-1], style.VERMILLION, 0.0)
        words: _Look = {"ha": "right", "va": "center", "fontsize": _BIG, "color": style.VERMILLION}
        at = share * self.lever - 0.8, foot + 0.42 * (arc[-1, 1] - foot)
        ax.text(*at, r"$\theta$", **words, zorder=9)

    def _name(self, ax: Axes) -> None:
        """Label all parts with their symbols or names."""
        ax.text(0.0, -self.half[1] - 2.5, "inner block,\nheld", ha="center", va="top")
        top = float(self.stops[1][1] + self.half[1])
        x, y = float(self.outer[0]), float(self.outer[1] + self.half[1])
        arrow(ax, (x, y), (x, top + 8.5), style.INK, 1.4)
        ax.text(x - 2.0, top + 6.5, "outer block,\npulled", ha="right", va="center")
        ax.text(x / 2 - 1.0, self.outer[1] / 2 + self.pair + 1.0, "$r$", va="bottom", fontsize=_BIG)
        # The axes x and y.
        corner = np.array([self.box[0] + 1.0, self.box[2] + 1.0])
        for way, name in (((8.0, 0.0), "$x$"), ((0.0, 8.0), "$y$")):
            arrow(ax, corner, corner + way, style.FAINT, 0.8)
            x, y = corner + 1.25 * np.array(way)
            ax.text(x, y, name, ha="center", va="center")
        sheet.root(ax).draw_without_rendering()
        clear = [text.get_window_extent() for text in ax.texts]
        for joint in (np.zeros(2), self.outer):
            corners = ax.transData.transform(self._block(joint))
            clear.append(Bbox([corners.min(axis=0), corners.max(axis=0)]))
        labels = [
            Label(self.p, f"$p$ = {mm_pair(self.band.p)} mm", style.BLUE),
            Label(self.q, f"$q$ = {mm_pair(self.band.q)} mm", style.BLUE),
            Label(0.85 * self.p + 0.15 * self.q, "band", self.colour),
        ]
        legends.place_labels(ax, labels, keep_clear=clear)

    def draw_triangle(self, ax: Axes) -> None:
        plain(ax, self.triangle_box)
        limit, end, zero = self.cell.limit, self._third, np.zeros(2)
        sweep = np.linspace(-limit, limit, 61)
        arc = self.lever * np.column_stack([np.cos(sweep), np.sin(sweep)])
        faint: _Look = {"color": style.FAINT, "linewidth": 0.6, "linestyle": _DASHES, "zorder": 1}
        ax.plot(*arc.T, **faint)
        for stop in self.stops:
            ax.plot(*np.array([zero, stop]).T, **faint, gid="stop")
        self._turn(ax, 0.0, 0.72)
        ends = (zero, self.outer), (self.outer, end), (zero, end)
        colours = style.INK, style.BLUE, self.colour
        for name, (start, stop), colour in zip("rdl", ends, colours, strict=True):
            ax.plot(*np.array([start, stop]).T, color=colour, linewidth=1.8, zorder=4, gid=name)
            if name != "l" and np.any(start != stop):
                arrow(ax, start, stop, colour, 1.8)
        clear = [text.get_window_extent() for text in ax.texts]
        low, high = self.stops
        labels = [
            Label(high, rf"state 1: $\theta = \theta_c$ = {math.degrees(limit):.4g}°"),
            Label(low, r"state 0: $\theta = -\theta_c$"),
            Label((self.outer + end) / 2, f"$d = q - p$\n= {mm_pair(self.band.d)} mm", style.BLUE),
            Label(end * 0.75, "band $\\ell$", self.colour),
            Label(self.outer / 2, f"$r$ = {mm(self.cell.lever)} mm"),
        ]
        legends.place_labels(ax, labels, keep_clear=clear)


def _name_blocks(ax: Axes, blocks: Floats, *, first: bool) -> None:
    """Label the held block and the pulled block."""
    left, low = blocks[0, :2]
    ax.text(left + 1.5, low - 1.0, "held", ha="right", va="top", zorder=9)
    _, low, right, high = blocks[-1]
    y = (low + high) / 2
    arrow(ax, (right, y), (right + 10.0, y), style.INK, 1.6)
    words = "pulled by\nthe actuator" if first else "pulled"
    ax.text(right + 3.0, y - 1.5, words, ha="left", va="top", zorder=9)
    if len(blocks) == 3 and first:
        left, low, right, high = blocks[1]
        ax.text((left + right) / 2, (low + high) / 2, "middle block", ha="center", va="center")


def _name_cells(ax: Axes, chain: Chain, x: float, y: float) -> None:
    """Write the state, and the names of the cells in their colours, side by side."""
    words = [("state " + "0" * len(chain), style.INK)]
    names = [name if name.startswith("cell") else f"{name} cell" for name in chain.names]
    words += zip(names, style.cell_colours(len(chain)), strict=True)
    for word, colour in words:
        look: _Look = {"color": colour, "fontweight": "bold", "va": "bottom"}
        box = ax.text(x, y, literal(word), **look).get_window_extent()
        x = float(ax.transData.inverted().transform((box.x1, box.y0))[0]) + 3.0


def _name_anchors(ax: Axes, bands: Floats) -> None:
    """Write p and q at the ends of every band."""
    for ends in bands:
        for name, (x, y), other in zip("pq", ends, ends[::-1], strict=True):
            up = y > other[1]
            look: _Look = {"ha": "center", "va": "bottom" if up else "top", "color": style.BLUE}
            ax.text(x, y + (0.8 if up else -0.8), f"${name}$", **look, fontsize=_BIG, zorder=9)


def _add_up(ax: Axes, rest: float, pulled: list[float], y: float, feet: float) -> None:
    """Draw the travels end to end from the rest of the last block, and the stroke below."""
    marks = list(accumulate(pulled, initial=rest))
    colours = style.cell_colours(len(pulled))
    for i, (a, b) in enumerate(pairwise(marks)):
        along_x(ax, (a, b), (feet, y), f"$s_{i + 1}$", colours[i], gid=f"s{i + 1}")
    total = " + ".join(f"$s_{i + 1}$" for i in range(len(pulled)))
    along_x(ax, (rest, marks[-1]), (feet, y - 7.0), f"stroke $u$ = {total}", gid="u")
