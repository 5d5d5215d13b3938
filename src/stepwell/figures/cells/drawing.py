"""A chain as artists on a page, made once and moved as often as wanted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from stepwell.base import Floats
from stepwell.figures.cells.linkage import LinkageDrawing, Pose
from stepwell.figures.common import BLOCK, FIXED_BLOCK, INK, cell_colours, hollow

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

    @property
    def artists(self) -> Sequence[Artist]:
        """From the lowest to the topmost."""
        return (self.posts, self.blocks, self.levers, self.joints, self.bands, self.anchors)

    def move(self, travels: Sequence[float] | Floats) -> Pose:
        """Put every part where it is at these travels (N,) [m]."""
        pose = self.linkage.pose(travels)
        left, bottom, right, top = pose.blocks.T
        corners = np.stack([left, bottom, right, bottom, right, top, left, top], axis=1)
        self.blocks.set_verts(list(self._page(corners.reshape(-1, 4, 2))))
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

    def _page(self, xy: Floats) -> Floats:
        return self.origin + self.scale * xy
