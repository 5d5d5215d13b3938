"""The nearest displacement that does something, found by asking, where no closed form holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from stepwell.design.margins.displacements import Ways

Floats = NDArray[np.float64]

# Steps from here to the reach, along a line and in the plane; then halves of the first step.
_STEPS = {1: 200, 2: 20}
_HALVES = 10
_DIRECTIONS = 16
_FINE = 1e-6  # [m], where bisection stops


def resolution(ways: Ways) -> str:
    """What `hunt` can miss, in words."""
    pitch = ways.reach / _STEPS[ways.dimensions]
    where = "places on a grid" if ways.dimensions == 2 else "places on the line"
    return (
        f"asked at {where} every {pitch * 1e3:.3g} mm, closer around the start; a region that "
        f"lies between them is not seen; then bisection to {_FINE * 1e3:g} mm"
    )


def hunt(
    does: Callable[[Floats], bool],
    ways: Ways,
    within: float,
    progress: Callable[[int, int], None] | None = None,
) -> Floats | None:
    """The nearest u (n,) found at which `does(u)`; None where none nearer than `within` is.

    Places are asked nearest first. From each that does it, bisection goes back towards the
    start; in the plane the best ray is then turned to either side as long as that shortens it.
    `progress` is called with (done, total) places, the farthest of which may not be asked.
    """
    pitch = ways.reach / _STEPS[ways.dimensions]
    spread = math.sqrt(ways.dimensions) * pitch
    hits: list[Floats] = []
    nearest = within
    places = list(_places(ways, pitch))
    for done, u in enumerate(places):
        if progress is not None:
            progress(done, len(places))
        away = float(np.linalg.norm(u))
        # A hit a little farther out may lead back to a nearer place than the nearest hit.
        if away > (min(nearest + spread, within) if hits else within):
            break
        if does(u):
            hits.append(u)
            nearest = min(nearest, away)
    if not hits:
        return None
    best = min((_back(does, u, 0.0) for u in hits), key=lambda u: float(np.linalg.norm(u)))
    return best if ways.dimensions == 1 else _turned(does, best, pitch)


def _places(ways: Ways, pitch: float) -> Iterator[Floats]:
    close = [pitch * 0.5**k for k in range(_HALVES, 0, -1)]
    if ways.dimensions == 1:
        steps = [k * pitch for k in range(1, _STEPS[1] + 1)]
        for away in (*close, *steps):
            yield np.array([away])
            if not ways.one_way:
                yield np.array([-away])
        return
    angle = np.linspace(0, 2 * math.pi, _DIRECTIONS, endpoint=False)
    for away in close:
        yield from away * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    line = np.arange(-_STEPS[2], _STEPS[2] + 1) * pitch
    grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    away = np.linalg.norm(grid, axis=1)
    order = np.argsort(away, kind="stable")
    yield from grid[order][(away[order] > 0) & (away[order] <= ways.reach)]


def _back(does: Callable[[Floats], bool], u: Floats, low: float) -> Floats:
    """The place on the ray to u, beyond `low` [m], from which on it does; it does at u."""
    away = float(np.linalg.norm(u))
    along, high = u / away, away
    while high - low > _FINE:
        middle = (low + high) / 2
        if does(middle * along):
            high = middle
        else:
            low = middle
    return high * along


def _turned(does: Callable[[Floats], bool], best: Floats, pitch: float) -> Floats:
    away = float(np.linalg.norm(best))
    step = min(pitch / away, math.pi / 2)
    while step * away > _FINE:
        heading = math.atan2(best[1], best[0])
        for angle in (heading - step, heading + step):
            u = (away - _FINE) * np.array([math.cos(angle), math.sin(angle)])
            if away > _FINE and does(u):
                best = _back(does, u, max(0.0, away - 2 * pitch))
                away = float(np.linalg.norm(best))
                break
        else:
            step /= 2
    return best
