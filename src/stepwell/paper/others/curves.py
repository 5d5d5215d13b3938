"""Elements by the corners of their curves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stepwell.mechanism import Element

# Points on a straight piece: a curve that folds back is smooth through its points.
_DENSE = 8


def straight(corners: Sequence[tuple[float, float]], scale: float = 1.0) -> Element:
    """An element whose curve is straight between corners by arc, and may fold back.

    Args:
        corners: travel [mm] and force [N].
        scale: of the forces.
    """
    if all(a[0] < b[0] for a, b in pairwise(corners)):
        return Element.from_points([1e-3 * s for s, _ in corners], [scale * f for _, f in corners])
    given = np.array(corners)
    places = np.linspace(0.0, len(given) - 1.0, _DENSE * (len(given) - 1) + 1)
    travel, force = (np.interp(places, np.arange(len(given)), column) for column in given.T)
    return Element.from_curve((1e-3 * travel).tolist(), (scale * force).tolist())
