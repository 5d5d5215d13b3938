"""Where the blocks, levers and bands of a chain are, drawn flat on the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.mechanism import Chain


@dataclass(frozen=True, slots=True)
class Pose:
    """The parts of a chain at given travels, in metres on the page.

    Args:
        blocks: (N + 1, 4) left, bottom, right, top of each block, fixed one first.
        levers: (2 N, 2, 2) ends of each lever.
        bands: (B, 2, 2) ends of each band, p then q, cell by cell.
        posts: (2 B, 2, 2) from a block's joint midpoint to an anchor on that block.
        tension: (B,) of each band [N].
        slack: (B,) whether the band is slack.
    """

    blocks: Floats
    levers: Floats
    bands: Floats
    posts: Floats
    tension: Floats
    slack: Bools

    @property
    def points(self) -> Floats:
        """(n, 2) corners of the blocks and ends of all else but the posts [m]."""
        parts = (self.blocks, self.bands, self.levers)
        return np.concatenate([part.reshape(-1, 2) for part in parts])


class LinkageDrawing:
    """Places a chain on the page: stroke to the right, fixed block at the left.

    A cell's own drawing has the travel upwards and the outer block beside the inner one. Here
    the travel is turned to the right, and every second cell is mirrored across the stroke, which
    changes no band length: the blocks then lie in two rows that the levers zig-zag between, and
    a chain of any length stays as slender as one cell. The length of the middle blocks is free in
    the model; here each is as long as it must be to clear its neighbours in every state.
    """

    def __init__(self, chain: Chain):
        self.chain = chain
        cells = chain.cells
        lever = max(cell.lever for cell in cells)
        # Half the distance between the two levers, and what a block has beyond its joint midpoint.
        self.half_pair = 0.30 * lever
        self.reach = 0.52 * lever
        self.half_block = 0.26 * min(lever, *(c.lever * math.cos(c.limit) * 1.4 for c in cells))
        room = 2 * self.reach + 0.25 * lever
        halves = [cell.full_travel / 2 for cell in cells]
        self.spans = [a + b + room for a, b in pairwise(halves)]
        self.owner = np.array([i for i, cell in enumerate(cells) for _ in cell.bands])

    def pose(self, travels: Sequence[float] | Floats) -> Pose:
        """Everything in its place at these travels (N,) [m]."""
        reach, half = self.reach, self.half_block
        inner = np.zeros(2)
        left = -reach
        blocks: list[list[float]] = []
        levers: list[Floats] = []
        bands: list[Floats] = []
        posts: list[Floats] = []
        tension: list[float] = []
        slack: list[bool] = []
        for i, cell in enumerate(self.chain.cells):
            side = 1.0 if i % 2 == 0 else -1.0
            theta = float(cell.angle(travels[i]))
            outer = inner + _xy(cell.lever * math.sin(theta), side * cell.lever * math.cos(theta))
            blocks.append([left, inner[1] - half, inner[0] + reach, inner[1] + half])
            for along in (-self.half_pair, self.half_pair):
                levers.append(np.array([inner, outer]) + _xy(along, 0.0))
            for band in cell.bands:
                ends = np.array(
                    [
                        inner + _xy(band.p[1], side * band.p[0]),
                        outer + _xy(band.q[1], side * band.q[0]),
                    ]
                )
                length = float(band.length(theta, cell.lever))
                bands.append(ends)
                posts += [np.array([inner, ends[0]]), np.array([outer, ends[1]])]
                tension.append(float(band.tension(length)))
                slack.append(length <= band.rest_length and not band.two_sided)
            left = outer[0] - reach
            span = self.spans[i] if i < len(self.spans) else 0.0
            inner = outer + _xy(span, 0.0)
        blocks.append([left, inner[1] - half, inner[0] + reach, inner[1] + half])
        return Pose(
            np.array(blocks),
            np.array(levers),
            np.array(bands),
            np.array(posts),
            np.array(tension),
            np.array(slack),
        )

    def bounds(
        self, states: Iterable[Sequence[float] | Floats], room: float = 0.0
    ) -> tuple[float, float, float, float]:
        """left, bottom, right, top [m] of the chain at all these travels (N,), with room around."""
        points = np.concatenate([self.pose(travels).points for travels in states])
        low, high = points.min(axis=0) - room, points.max(axis=0) + room
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def greatest_tension(self) -> float:
        """The largest tension or thrust [N] any band has between the stops."""
        found = 0.0
        for cell in self.chain.cells:
            theta = np.linspace(-cell.limit, cell.limit, 65)
            for band in cell.bands:
                tension = band.tension(band.length(theta, cell.lever))
                found = max(found, float(np.max(np.abs(tension))))
        return found


def _xy(x: float, y: float) -> Floats:
    return np.array([x, y])
