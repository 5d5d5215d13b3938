"""Movable artists that draw a chain."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from stepwell.base import Floats
from stepwell.figures.common import style
from stepwell.figures.common.sheet import Point
from stepwell.mechanism import layout

THINNEST, THICKEST = 0.7, 3.0
SLACK_DASHES = (0, (2.0, 1.6))


class Drawing:
    """The artists of one chain, with the fixed block's joint midpoint at the origin. `scale` is
    page units per metre; `weight` is a factor on all line widths.
    """

    def __init__(
        self,
        ax: Axes,
        linkage: layout.ChainLayout,
        origin: Point,
        scale: float,
        weight: float = 1.0,
    ):
        self.linkage, self.scale, self.weight = linkage, scale, weight
        self.origin = np.array(origin)
        self.strongest = linkage.greatest_tension()
        cells = len(linkage.chain)
        all_colours = style.cell_colours(cells)
        colours = np.array(all_colours)[linkage.owner]
        self.posts = LineCollection([], colors=style.FIXED_BLOCK, linewidths=2.2 * weight, zorder=1)
        faces = [style.FIXED_BLOCK] + [style.BLOCK] * cells
        edges = {"edgecolors": style.INK, "linewidths": 0.6 * weight}
        self.blocks = PolyCollection([], facecolors=faces, **edges, zorder=2)
        self.levers = LineCollection([], colors=style.INK, linewidths=1.5 * weight, zorder=3)
        self.bands = LineCollection([], colors=colours, zorder=5, capstyle="round")
        joints = style.hollow(2.6 * weight, markeredgewidth=0.6 * weight, zorder=4)
        (self.joints,) = ax.plot([], [], "o", **joints)
        look = {"s": (2.6 * weight) ** 2, "c": np.repeat(colours, 2), "linewidths": 0}
        self.anchors = ax.scatter(*np.zeros((2, len(colours) * 2)), **look, zorder=6)
        curves = [all_colours[i] for i, one in linkage.symbols.items() for _ in one.curves]
        self.rods = LineCollection([], colors=style.INK, linewidths=1.5 * weight, zorder=1.5)
        look = {"facecolors": "white", "edgecolors": style.INK, "linewidths": 0.8 * weight}
        self.boxes = PolyCollection([], **look, zorder=3, gid="elements")
        self.zeros = LineCollection([], colors=style.FAINT, linewidths=0.4 * weight, zorder=3.5)
        thick = {"linewidths": 1.6 * weight, "capstyle": "round"}
        self.curves = LineCollection([], colors=curves, **thick, zorder=4)
        dots = {"ms": 4.2 * weight, "mec": "white", "color": style.INK, "mew": 0.6 * weight}
        (self.dots,) = ax.plot([], [], "o", **dots, zorder=7, visible=bool(linkage.symbols))
        look = {"colors": style.INK, "linewidths": [0.9] + [0.5] * (len(linkage.wall) - 1)}
        self.wall = LineCollection(list(self._page(linkage.wall)), **look, gid="wall")
        lever_parts = (self.wall, self.posts, self.blocks, self.levers, self.bands)
        symbols = (self.rods, self.boxes, self.zeros, self.curves) if linkage.symbols else ()
        for artist in (*lever_parts, *symbols):
            ax.add_collection(artist, autolim=False)
        # From the lowest to the topmost.
        self.artists: Sequence[Artist] = (
            *(
                self.wall,
                self.posts,
                self.blocks,
                self.levers,
                self.joints,
                self.bands,
                self.anchors,
            ),
            *(*symbols, self.dots),
        )

    def move(
        self, travels: Sequence[float] | Floats, sheets: Sequence[int | None] | None = None
    ) -> layout.Pose:
        """Move all parts to these travels (N,) [m]; sheets as in `pose`."""
        pose = self.linkage.pose(travels, sheets)
        self.blocks.set_verts(list(self._page(layout.corners(pose.blocks))))
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
        self.rods.set_segments(list(self._page(pose.rods)))
        self.boxes.set_verts(list(self._page(layout.corners(pose.boxes))))
        feet, side = pose.boxes[:, :2], self.linkage.box
        shown = list(zip(self.linkage.symbols.values(), feet, strict=True))
        curves = [self._page(foot + side * curve) for one, foot in shown for curve in one.curves]
        self.curves.set_segments(curves)
        lines = [foot + side * np.array([(0.0, one.zero), (1.0, one.zero)]) for one, foot in shown]
        self.zeros.set_segments([*map(self._page, lines)])
        self.dots.set_data(*self._page(pose.dots).T)
        return pose

    def _page(self, xy: Floats) -> Floats:
        return self.origin + self.scale * xy
