"""Polylines on a curve: their points narrowed down, made smooth, parted by what is beside them."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Floats, Ints

Labels = NDArray[Any]


def narrowed(
    ask: Callable[[Floats], Labels], a: Floats, b: Floats, at_a: Labels, at_b: Labels, steps: int
) -> tuple[Floats, Floats, Labels]:
    """Both ends of m ways, after each has been halved again and again between unlike places.

    Args:
        ask: labels (m,) of (m, k) places: numbers, or whether they are inside something.
        a, b: (m, k) the ends.
        at_a, at_b: (m,) their labels.
        steps: how often; each halves what is between the ends.

    Returns:
        The places nearest to each other, (m, k) each, the first with the label of a, the second
        with another, and that other label, (m,).
    """
    for _ in range(steps if len(a) else 0):
        middle = (a + b) / 2
        label = ask(middle)
        stays = label == at_a
        a, b = np.where(stays[:, None], middle, a), np.where(stays[:, None], b, middle)
        at_b = np.where(stays, at_b, label)
    return a, b, at_b


def smoothed(points: Floats, project: Callable[[Floats], Floats], sagitta: float) -> Floats:
    """The polyline with points added on the curve until no chord is off by more than `sagitta`.

    Args:
        points: (m, 2) on the curve.
        project: moves (n, 2) points onto the curve.
        sagitta: in the units of the points.
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


def parted(
    points: Floats, ask: Callable[[Floats], Ints], project: Callable[[Floats], Floats], steps: int
) -> list[tuple[int, Floats]]:
    """The stretches of a polyline with one label each, cut where the label changes.

    Args:
        points: (m, 2) on the curve.
        ask: labels of the curve's points beside (n, 2) points.
        project: moves (n, 2) points onto the curve.
        steps: how often the way to each cut is halved.

    Returns:
        The label of each stretch, and its points.
    """
    label = ask(points)
    turns = np.flatnonzero(label[1:] != label[:-1])
    # From both sides: a third label may lie between.
    near, far = np.append(turns, turns + 1), np.append(turns + 1, turns)
    ends, _, _ = narrowed(ask, points[near], points[far], label[near], label[far], steps)
    before, after = np.split(project(ends), 2)
    bounds = [0, *(turns + 1).tolist(), len(points)]
    found: list[tuple[int, Floats]] = []
    for k in range(len(bounds) - 1):
        first, last = after[k - 1 : k] if k else after[:0], before[k : k + 1]
        piece = np.concatenate([first, points[bounds[k] : bounds[k + 1]], last])
        found.append((int(label[bounds[k]]), piece))
    return found
