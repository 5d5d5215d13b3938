"""A chain as artists on a page, made once and moved as often as wanted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from stepwell.base import Floats
from stepwell.figures.cells.linkage import LinkageDrawing, Pose
from stepwell.figures.common import BLOCK, FAINT, FIXED_BLOCK, INK, cell_colours, hollow

THINNEST, THICKEST = 0.7, 3.0
SLACK_DASHES = (0, (2.0, 1.6))


class Drawing:
    """The artists of one chain in one place.

    Args:
        ax: axes in page units.
        linkage: the chain and where its parts go.
        origin: page position of the fixed block's joint midpoint.
        scale: page units per metre.
        weight: factor on all line widths.
    """

    def __init__(
        self,
        ax: Axes,
        linkage: LinkageDrawing,
        origin: tuple[float, float],
        scale: float,
        weight: float = 1.0,
    ):
        self.linkage, self.scale = linkage, scale
        self.origin = np.array(origin)
        self.weight = weight
        self.strongest = linkage.greatest_tension()
        cells = len(linkage.chain)
        colours = np.array(cell_colours(cells))[linkage.owner]
        self.posts = LineCollection([], colors=FIXED_BLOCK, linewidths=2.2 * weight, zorder=1)
        self.blocks = PolyCollection(
            [],
            facecolors=[FIXED_BLOCK] + [BLOCK] * cells,
            edgecolors=INK,
            linewidths=0.6 * weight,
            zorder=2,
        )
        self.levers = LineCollection([], colors=INK, linewidths=1.5 * weight, zorder=3)
        self.bands = LineCollection([], colors=colours, zorder=5, capstyle="round")
        joints = hollow(2.6 * weight, markeredgewidth=0.6 * weight, zorder=4)
        (self.joints,) = ax.plot([], [], "o", **joints)
        self.anchors = ax.scatter(
            *np.zeros((2, len(colours) * 2)),
            s=(2.6 * weight) ** 2,
            c=np.repeat(colours, 2),
            linewidths=0,
            zorder=6,
        )
        for artist in (self.posts, self.blocks, self.levers, self.bands):
            ax.add_collection(artist, autolim=False)
        self._symbols = self._draw_symbols(ax) if linkage.symbols else ()

    def _draw_symbols(self, ax: Axes) -> Sequence[Artist]:
        """Rods, boxes, curves and marks of the elements."""
        symbols, weight = self.linkage.symbols, self.weight
        colours = cell_colours(len(self.linkage.chain))
        curves = [colours[i] for i, symbol in symbols.items() for _ in symbol.curves]
        self.rods = LineCollection([], colors=INK, linewidths=1.5 * weight, zorder=1.5)
        look = {"facecolors": "white", "edgecolors": INK, "linewidths": 0.8 * weight}
        self.boxes = PolyCollection([], **look, zorder=3, gid="elements")
        self.zeros = LineCollection([], colors=FAINT, linewidths=0.4 * weight, zorder=3.5)
        self.curves = LineCollection(
            [], colors=curves, linewidths=1.6 * weight, capstyle="round", zorder=4
        )
        dots = {"markersize": 4.2 * weight, "markeredgecolor": "white", "color": INK}
        (self.dots,) = ax.plot([], [], "o", **dots, markeredgewidth=0.6 * weight, zorder=7)
        drawn = (self.rods, self.boxes, self.zeros, self.curves)
        for artist in drawn:
            ax.add_collection(artist, autolim=False)
        return (*drawn, self.dots)

    @property
    def artists(self) -> Sequence[Artist]:
        """From the lowest to the topmost."""
        own = (self.posts, self.blocks, self.levers, self.joints, self.bands, self.anchors)
        return (*own, *self._symbols)

    def move(
        self, travels: Sequence[float] | Floats, sheets: Sequence[int | None] | None = None
    ) -> Pose:
        """Put every part where it is at these travels (N,) [m]; sheets as for `pose`."""
        pose = self.linkage.pose(travels, sheets)
        self.blocks.set_verts(list(self._page(_corners(pose.blocks))))
        if self._symbols:
            self._move_symbols(pose)
        self.posts.set_segments(list(self._page(pose.posts)))
        levers = self._page(pose.levers)
        self.levers.set_segments(list(levers))
        self.joints.set_data(*levers.reshape(-1, 2).T)
        bands = self._page(pose.bands)
        self.bands.set_segments(list(bands))
        share = np.abs(pose.tension) / self.strongest if self.strongest else pose.tension
        self.bands.set_linewidth(list(self.weight * (THINNEST + (THICKEST - THINNEST) * share)))
        self.bands.set_linestyle([SLACK_DASHES if s else "solid" for s in pose.slack])
        self.anchors.set_offsets(bands.reshape(-1, 2))
        return pose

    def _move_symbols(self, pose: Pose) -> None:
        self.rods.set_segments(list(self._page(pose.rods)))
        self.boxes.set_verts(list(self._page(_corners(pose.boxes))))
        curves: list[Floats] = []
        zeros: list[Floats] = []
        for symbol, (left, bottom, right, _) in zip(
            self.linkage.symbols.values(), pose.boxes, strict=True
        ):
            corner, side = np.array([left, bottom]), right - left
            curves += [self._page(corner + side * curve) for curve in symbol.curves]
            line = np.array([(0.0, symbol.zero), (1.0, symbol.zero)])
            zeros.append(self._page(corner + side * line))
        self.curves.set_segments(curves)
        self.zeros.set_segments(zeros)
        self.dots.set_data(*self._page(pose.dots).T)

    def _page(self, xy: Floats) -> Floats:
        return self.origin + self.scale * xy


def _corners(boxes: Floats) -> Floats:
    """(n, 4, 2) of (n, 4) left, bottom, right, top."""
    left, bottom, right, top = boxes.T
    corners = np.stack([left, bottom, right, bottom, right, top, left, top], axis=1)
    return corners.reshape(-1, 4, 2)
