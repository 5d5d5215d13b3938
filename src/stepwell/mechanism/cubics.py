"""Piecewise cubic curves, of which every law of a cell is made: through points, along laws, cut."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from stepwell.base import Floats, InputError
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
    if len(rows) == 1:
        start, *piece = rows[0]
        return x - start, piece
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


Force = Callable[[Floats], Floats]

# Two cuts nearer than this fraction of the whole travel are one.
_NEAR = 1e-9
# A force that changes by less than this fraction of the largest one is constant but for rounding.
_FLAT = 1e-12
# Rows in a smooth stretch of a sampled law; one that needs more has a kink that was not given.
_MOST_ROWS = 4096


def straight(x: Floats, y: Floats) -> Floats:
    """(n - 1, 6) rows of the lines through n points."""
    rows = np.zeros((len(x) - 1, COLUMNS))
    rows[:, 0], rows[:, 1] = x[:-1], y[:-1]
    rows[:, 2] = np.diff(y) / np.diff(x)
    return with_integrals(rows)


def through(x: Floats, y: Floats) -> Floats:
    """(n - 1, 6) rows of the monotone cubics through n points (Fritsch & Butland 1984)."""
    from scipy.interpolate import PchipInterpolator  # pyright: ignore[reportMissingTypeStubs]

    rows = np.zeros((len(x) - 1, COLUMNS))
    rows[:, 0], rows[:, 1:5] = x[:-1], PchipInterpolator(x, y).c[::-1].T
    return with_integrals(rows)


def along(force: Force, low: float, high: float, accuracy: float, kinks: Sequence[float]) -> Floats:
    """Rows of a law, cubic between points that are added until it is met within `accuracy`.

    That is a share of the largest force; `kinks` are travels where the slope jumps [m].
    """
    # At no travel the curve is the law itself, so that what rests there rests there.
    ends = np.unique([low, *(k for k in (0.0, *kinks) if low < k < high), high])
    scale = float(np.max(np.abs(_asked(force, np.linspace(low, high, 257)))))
    parts = [_smooth(force, a, b, accuracy * scale) for a, b in pairwise(ends.tolist())]
    return with_integrals(np.concatenate(parts))


def end_of(rows: Floats, end: float) -> tuple[float, float, float]:
    """Force, slope and energy of the last row at the end of the curve."""
    x = end - rows[-1, 0]
    force, slope, _ = cubic(x, *rows[-1, 1:5])
    area = rows[-1, 5] + sum(rows[-1, j + 1] * x ** (j + 1) / (j + 1) for j in range(4))
    return float(force), float(slope), float(area)


def monotone(rows: Floats, end: float) -> Floats:
    """The same curve cut wherever force or stiffness turns: the engine needs both monotone."""
    least = _NEAR * (end - rows[0, 0])
    ends = np.append(rows[1:, 0], end)
    out: list[Floats] = []
    for row, width in zip(rows, ends - rows[:, 0], strict=True):
        _, c1, c2, c3 = row[1:5]
        # Curvature this small relative to the slope is rounding, without an extremum.
        size = abs(c1) + abs(c2) * width + abs(c3) * width * width
        quadratic = [3.0 * c3, 2.0 * c2, c1]
        terms = (abs(3.0 * c3) * width**2, abs(2.0 * c2) * width, abs(c1))
        turns = [q if t > 1e-10 * size else 0.0 for q, t in zip(quadratic, terms, strict=True)]
        with np.errstate(all="ignore"):
            roots = np.roots(np.trim_zeros(turns, "f")) if any(turns[:2]) else np.empty(0)
        places = [float(r.real) for r in roots if abs(r.imag) <= 1e-9 * width]
        if turns[0]:
            places.append(-c2 / (3.0 * c3))
        begin = 0.0
        for place in sorted(p for p in places if least < p < width - least):
            if place - begin > least:
                out.append(_moved(row, begin))
                begin = place
        out.append(_moved(row, begin))
    return with_integrals(np.array(out), float(rows[0, 5]))


def signs(rows: Floats, end: float) -> tuple[Floats, np.ndarray]:
    """(n + 1,) forces at the joints of monotone rows, and (n,) whether each rises, 1, 0 or -1."""
    forces = np.append(rows[:, 1], end_of(rows, end)[0])
    steps = np.diff(forces)
    flat = np.abs(steps) <= _FLAT * np.max(np.abs(forces), initial=0.0)
    return forces, np.where(flat, 0, np.sign(steps)).astype(int)


def _asked(force: Force, x: Floats) -> Floats:
    with np.errstate(all="ignore"):
        values = np.asarray(force(x), float)
    if values.shape != x.shape or not np.all(np.isfinite(values)):
        bad = x[~np.isfinite(values)] if values.shape == x.shape else x
        raise InputError(
            f"force: at travels such as {float(bad[0])!r} it gives no finite number, or not as "
            f"many numbers as travels: must be a function of an array, finite from end to end."
        )
    return values


def _smooth(force: Force, low: float, high: float, error: float) -> Floats:
    x = np.linspace(low, high, 17)
    while True:
        y = _asked(force, x)
        rows = _of_slopes(x, y, _slopes(force, x, low, high))
        thirds = x[:-1, None] + np.diff(x)[:, None] * np.array([0.25, 0.5, 0.75])
        curve = cubic(thirds - x[:-1, None], *(rows[:, j, None] for j in range(1, 5)))[0]
        off = np.abs(curve - _asked(force, thirds.ravel()).reshape(thirds.shape))
        rough = np.max(off, axis=1) > error
        if not rough.any():
            return rows
        steepest = float(np.min(np.diff(x)[rough]))
        if len(x) > _MOST_ROWS or steepest < _NEAR * (high - low):
            worst = float(x[:-1][rough][np.argmin(np.diff(x)[rough])])
            raise InputError(
                f"force: near travel {worst!r} it jumps, or bends too sharply for cubics: name "
                f"the travel in kinks= if its slope jumps there, or allow a larger accuracy=."
            )
        x = np.sort(np.concatenate([x, thirds[rough, 1]]))


def _slopes(force: Force, x: Floats, low: float, high: float) -> Floats:
    """dF/ds, to fourth order, without leaving the travel."""
    h = 1e-3 * np.append(np.diff(x), x[-1] - x[-2])
    middle = np.clip(x, low + 2 * h, high - 2 * h)
    points = middle[:, None] + h[:, None] * np.arange(-2, 3)
    values = _asked(force, points.ravel()).reshape(points.shape)
    # The quartic through five points, derived where x lies among them.
    t = (x - middle) / h
    coefficients = np.linalg.solve(np.vander(np.arange(-2.0, 3.0)), values.T)
    powers = np.stack([4 * t**3, 3 * t**2, 2 * t, np.ones_like(t)])
    return np.sum(coefficients[:4] * powers, axis=0) / h


def _of_slopes(x: Floats, y: Floats, slope: Floats) -> Floats:
    width, secant = np.diff(x), np.diff(y) / np.diff(x)
    rows = np.zeros((len(x) - 1, COLUMNS))
    rows[:, 0], rows[:, 1], rows[:, 2] = x[:-1], y[:-1], slope[:-1]
    rows[:, 3] = (3 * secant - 2 * slope[:-1] - slope[1:]) / width
    rows[:, 4] = (slope[:-1] + slope[1:] - 2 * secant) / width**2
    return rows


def _moved(row: Floats, by: float) -> Floats:
    """The same cubic, counted from further on."""
    c0, c1, c2, c3 = row[1:5]
    value, slope, bend = cubic(by, c0, c1, c2, c3)
    return np.array([row[0] + by, value, slope, bend / 2.0, c3, 0.0])
