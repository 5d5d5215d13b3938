"""The nearest anchor with a given end force: its direction is as exact as its distance."""

import math

import pytest

import stepwell as sw
from stepwell.concave import Simple, simple


def gradient(s: Simple, side: int, x: float, y: float) -> tuple[float, float]:
    """∂F/∂d, written out."""
    t = side * s.sin_limit
    c = math.sqrt(1 - t * t)
    x, y = s.lever * c + x, s.lever * t + y
    length, g = math.hypot(x, y), (y - s.lever * t) - (x - s.lever * c) * t / c
    pull, stretch = s.rest * g / length**3, 1 - s.rest / length
    return pull * x - stretch * t / c, pull * y + stretch


@pytest.mark.parametrize("name", ["three-wave", "countdown"])
def test_the_nearest_place_lies_squarely_on_its_curve(name):
    chain = sw.preset(name)
    assert isinstance(chain, sw.Chain)
    for change in chain.margin().changes:
        if change.parameter == "anchor" and math.isfinite(change.distance):
            assert isinstance(change.move, tuple)
            cell = simple(chain.cells[change.cell])
            assert cell is not None
            x, y = change.move
            turned = []
            for side in (-1, 1):
                fx, fy = gradient(cell, side, cell.dx + x, cell.dy + y)
                turned.append(abs(fy * x - fx * y) / math.hypot(fx, fy) / change.distance)
            # As long as any ray beside it, but for rounding: only the slope tells it apart.
            assert min(turned) < 1e-12
