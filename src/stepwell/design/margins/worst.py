"""The worst that displaced anchors can do to the end forces of a cell."""

from functools import partial

import numpy as np

from stepwell.base import Floats
from stepwell.concave import Simple, certified, end_force_field
from stepwell.design.plane import Box, narrowed

SIDES = (-1, 1)
# Steps towards the farthest point of a disc; each divides what is missing by ten or more.
_TURNS = 6
# Nodes over the length of a lever, where the proof of concave cells ends; and over a wide region.
_GRID = 64
_MOST_GRID = 1000
_HALVINGS = 12


def farthest(cell: Simple, side: int, d: Floats, radius: float | Floats, sign: int) -> Floats:
    """Where an end force is largest (sign +1) or smallest (-1) with the anchor near d.

    With n = (-tan θ, 1) and the unit vector u along the band, u·n = g/ℓ, so that
    ∇F·n = k ((1 - ℓ0/ℓ)/cos² θ + ℓ0 g²/ℓ³) > 0: a taut band has no extremum inside a disc, and
    the one sought lies on its rim, where the slope points outwards. That is found by going where
    the slope points, again and again; that there is no better one elsewhere on the rim is not
    proved.

    Args:
        cell: whose anchors are not looked at.
        side: -1 for F0, +1 for F1.
        d: (m, 2) differences q - p [m].
        radius: one, or (m,), within which the anchor may be [m].
        sign: which extremum.

    Returns:
        (m, 3) the force [N], and the displacement that makes it [m].
    """
    out = end_force_field(cell, side, d)
    reach = sign * np.broadcast_to(np.asarray(radius, float), len(d))[:, None]
    move = np.zeros_like(d)
    for _ in range(_TURNS):
        slope = out[:, 1:]
        move = reach * slope / np.linalg.norm(slope, axis=1, keepdims=True)
        out = end_force_field(cell, side, d + move)
    return np.column_stack([out[:, 0], move])


def extremes(
    cell: Simple, d: Floats, force: Floats, slope: Floats, radius: float
) -> tuple[Floats, Floats]:
    """How far F0 and F1 fall and rise within a radius of d, over that radius, (m, 2) each [N/m]."""
    if radius <= 0.0:
        steep = np.linalg.norm(slope, axis=2)
        return steep, steep

    def most(sign: int) -> Floats:
        ends = [farthest(cell, side, d, radius, sign)[:, 0] for side in SIDES]
        return np.abs(np.stack(ends, axis=1) - force) / radius

    return most(-1), most(+1)


class Proof:
    """How far an anchor may move with the cell still proved taut and concave.

    Measured to the edge of all proved anchors, which is found on a grid and bisected: good for
    choosing, and what is chosen is proved afterwards.
    """

    def __init__(self, cell: Simple, d: Box):
        """Of a band and a lever, for differences q - p within a rectangle [m]."""
        self.most = 2.0 * cell.lever
        pitch = max(cell.lever / _GRID, max(d.right - d.left, d.top - d.bottom) / _MOST_GRID)
        x = np.arange(d.left - self.most, d.right + self.most + pitch, pitch)
        y = np.arange(d.bottom - self.most, d.top + self.most + pitch, pitch)
        grid = np.stack(np.meshgrid(x, y), axis=-1)

        yes = certified(cell, grid.reshape(-1, 2)).reshape(grid.shape[:2])
        inside: list[Floats] = []
        outside: list[Floats] = []
        for a, b, p, q in (
            (yes[:, :-1], yes[:, 1:], grid[:, :-1], grid[:, 1:]),
            (yes[:-1], yes[1:], grid[:-1], grid[1:]),
        ):
            inside += [p[a & ~b], q[b & ~a]]
            outside += [q[a & ~b], p[b & ~a]]
        low, high = np.concatenate(inside), np.concatenate(outside)
        held = np.ones(len(low), bool)
        low, _, _ = narrowed(partial(certified, cell), low, high, held, ~held, _HALVINGS)
        from scipy.spatial import KDTree

        self._edge = KDTree(low) if len(low) else None

    def radius(self, d: Floats) -> Floats:
        """For (m, 2) proved differences [m], at most two levers."""
        if self._edge is None:
            return np.full(len(d), self.most)
        return self._edge.query(d, distance_upper_bound=self.most)[0].clip(max=self.most)
