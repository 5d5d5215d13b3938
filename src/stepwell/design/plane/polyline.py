"""Polylines on a curve: made smooth, and cut where the curve leaves a region."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def smoothed(points: Floats, project: Callable[[Floats], Floats], sagitta: float) -> Floats:
    """The polyline with points added on the curve until no chord is off by more than `sagitta`.

    Args:
        points: (m, 2) on the curve [m].
        project: moves (n, 2) points onto the curve.
        sagitta: [m].
    """
    for _ in range(12):
        if len(points) < 2:
            break
        chord = (points[:-1] + points[1:]) / 2
        middle = project(chord)
        off = np.linalg.norm(middle - chord, axis=1)
        # A projection that runs away has met another strand; the chord is the better answer.
        bent = (off > sagitta) & (off < np.linalg.norm(points[1:] - points[:-1], axis=1))
        if not np.any(bent):
            break
        points = np.insert(points, np.flatnonzero(bent) + 1, middle[bent], axis=0)
    return points


def kept(
    points: Floats, inside: Callable[[Floats], Bools], project: Callable[[Floats], Floats]
) -> list[Floats]:
    """The stretches of a polyline that lie inside, cut where it passes out.

    Args:
        points: (m, 2) on the curve [m].
        inside: says it of (n, 2) points.
        project: moves (n, 2) points onto the curve.
    """
    flags = inside(points)
    stretches: list[Floats] = []
    current: list[Floats] = []

    def close() -> None:
        if len(current) > 1:
            stretches.append(np.array(current))
        current.clear()

    for i, point in enumerate(points):
        if i > 0 and flags[i] != flags[i - 1]:
            within, without = (point, points[i - 1]) if flags[i] else (points[i - 1], point)
            end = _crossing(within, without, inside, project)
            current.append(end)
            if not flags[i]:
                close()
        if flags[i]:
            current.append(point)
    close()
    return stretches


def _crossing(
    within: Floats,
    without: Floats,
    inside: Callable[[Floats], Bools],
    project: Callable[[Floats], Floats],
) -> Floats:
    last = within
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = (low + high) / 2
        point = project((within + middle * (without - within))[None])
        if inside(point)[0]:
            low, last = middle, point[0]
        else:
            high = middle
    return last
