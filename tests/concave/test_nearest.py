"""The nearest anchor with a given end force: its direction is as exact as its distance."""

import math

import numpy as np

import stepwell as sw
from stepwell.concave import Simple, SortedChain, nearest_of


def gradient(s: Simple, side: int, x: float, y: float) -> tuple[float, float]:
    """∂F/∂d, written out."""
    t = side * s.sin_limit
    c = math.sqrt(1 - t * t)
    x, y = s.lever * c + x, s.lever * t + y
    length, g = math.hypot(x, y), (y - s.lever * t) - (x - s.lever * c) * t / c
    pull, stretch = s.rest * g / length**3, 1 - s.rest / length
    return pull * x - stretch * t / c, pull * y + stretch


def test_the_nearest_place_lies_squarely_on_its_curve():
    for name in ("three-wave", "countdown"):
        chain = sw.preset(name)
        assert isinstance(chain, sw.Chain)
        forces = SortedChain.of(chain)
        assert forces is not None
        for i, cell in enumerate(forces.cells):
            out, turned = np.empty(3), []
            near = forces.neighbours(i)
            side, up = (np.array([getattr(n, key) for n in near]) for key in ("side", "up"))
            nearest_of(cell, side, np.array([n.other for n in near]), up, 0.02, out)
            away, x, y = out.tolist()
            for one in set(side.tolist()):
                fx, fy = gradient(cell, one, cell.dx + away * x, cell.dy + away * y)
                turned.append(abs(fy * x - fx * y) / math.hypot(fx, fy))
            # As long as any ray beside it, but for rounding: only the slope tells it apart.
            assert min(turned) < 1e-12
