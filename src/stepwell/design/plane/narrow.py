"""Bisection between places that differ."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Floats

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
