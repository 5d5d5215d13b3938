"""Where a cell stops having two stable states, in the plane of its anchor q."""

import math

import numpy as np
from numpy.typing import NDArray

from stepwell.design.parameters import with_q
from stepwell.design.plane import RESOLVED, Boundary, BoundaryKind, Box, kept, searched, smoothed
from stepwell.mechanism import Cell, Linear, band_length

Floats = NDArray[np.float64]


def limits(cell: Cell, name: str, box: Box, nodes: int, sagitta: float) -> list[Boundary]:
    """The limits of bistability inside the box.

    Exact for one linear band that only pulls and no load; searched on a grid otherwise.
    """
    band = cell.bands[0]
    plain = len(cell.bands) == 1 and cell.load is None and isinstance(band.law, Linear)
    if not plain or (band.two_sided and not _taut(cell, box.grid(nodes))):
        return _searched(cell, name, box, nodes)
    # The energy of one band that only pulls has one peak, at θmax = atan2(d_y, d_x) where the
    # band is longest (Kamp et al. 2024, Eq. 3), unless it is slack even there, r + |d| <= ℓ0.
    p, slack = np.array(band.p), max(band.rest_length - cell.lever, 0.0)
    lines = [
        (
            f"state {state} of {name} stops being stable: F{state} = 0",
            box.ray(p, angle, slack),
        )
        for state, angle in ((0, -cell.limit), (1, cell.limit))
    ]
    if slack > 0 and not band.two_sided:

        def onto(q: Floats) -> Floats:
            out = q - p
            return p + slack * out / np.linalg.norm(out, axis=1)[:, None]

        angle = np.linspace(-cell.limit, cell.limit, nodes)
        arc = p + slack * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        words = f"{name} goes slack over its whole travel: r + |q - p| = ℓ0"
        lines += [(words, line) for line in kept(smoothed(arc, onto, sagitta), box.holds, onto)]
    rounding = 4 * np.finfo(float).eps * (box.diagonal + math.hypot(*band.d))
    return [
        Boundary(BoundaryKind.BISTABLE, points, words, "exact", float(rounding))
        for words, points in lines
        if len(points) > 1
    ]


def _taut(cell: Cell, grid: Floats) -> bool:
    # ℓ² is linear in (cos θ, sin θ): over the travel it is smallest at a stop, or at the turn
    # opposite to d, which for d_x > 0 lies outside.
    d = grid - np.array(cell.bands[0].p)
    sine, cosine = -math.sin(cell.limit), math.cos(cell.limit)
    shortest = band_length(sine, cosine, d[..., 0], np.abs(d[..., 1]), cell.lever)
    return bool(np.all(d[..., 0] > 0) and np.all(shortest >= cell.bands[0].rest_length))


def _searched(cell: Cell, name: str, box: Box, nodes: int) -> list[Boundary]:
    def ask(q: Floats) -> int:
        try:
            return int(with_q(cell, float(q[0]), float(q[1])).is_bistable)
        except ValueError:
            return -1

    grid = box.grid(nodes)
    label = np.array([[ask(q) for q in row] for row in grid], np.int64)
    words = f"{name} has two stable states on one side, one on the other"
    return [
        Boundary(BoundaryKind.BISTABLE, points, words, "search", RESOLVED)
        for _, points in searched(ask, grid, label, ignore=-1)
    ]
