"""Piecewise cubic curves as rows of numbers: their values, slopes and integrals."""

from typing import Any

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import kernel

# Columns of a piece: where it starts x0, then c0..c3 of c0 + c1 x + c2 x² + c3 x³ with
# x measured from x0, then the integral from the curve's origin to x0.
COLUMNS = 6


@kernel
def cubic(x: Any, c0: Any, c1: Any, c2: Any, c3: Any) -> tuple[Any, Any, Any]:
    """c0 + c1 x + c2 x² + c3 x³ with its first two slopes, of numbers or arrays."""
    return (
        c0 + x * (c1 + x * (c2 + x * c3)),
        c1 + x * (2.0 * c2 + x * 3.0 * c3),
        2.0 * c2 + 6.0 * c3 * x,
    )


@kernel
def cubic_area(x: Any, c0: Any, c1: Any, c2: Any, c3: Any, area: Any) -> Any:
    """Its integral from 0 to x, and `area` on top."""
    return area + x * (c0 + x * (c1 / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0)))


def with_integrals(rows: Floats, origin: float = 0.0) -> Floats:
    """The rows with their integrals written in, the first of which is `origin`."""
    rows[0, 5] = origin
    width = np.diff(rows[:, 0])
    area = sum(rows[:-1, j + 1] * width ** (j + 1) / (j + 1) for j in range(4))
    rows[1:, 5] = origin + np.cumsum(area)
    return rows


def _locate(rows: Floats, x: Floats) -> tuple[Floats, list[Floats]]:
    index = np.clip(np.searchsorted(rows[:, 0], x, side="right") - 1, 0, len(rows) - 1)
    start, *piece = np.moveaxis(rows[index], -1, 0)
    return x - start, piece


def value(rows: Floats, x: Floats) -> Floats:
    """The curve with pieces `rows` at every x of any shape."""
    x, piece = _locate(rows, x)
    return cubic(x, *piece[:4])[0]


def integral(rows: Floats, x: Floats) -> Floats:
    """The curve's integral from its origin to every x of any shape."""
    x, piece = _locate(rows, x)
    return cubic_area(x, *piece)
