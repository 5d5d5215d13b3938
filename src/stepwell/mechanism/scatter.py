"""Scatter of measured forces about a smooth curve: size, resolution, correlation, spikes."""

from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats

# Orders of the differences in which a smooth curve vanishes and scatter does not.
_ORDERS = (4, 6)
# Fewer points show no scatter; differences of few points include the shape of the curve.
FEWEST = 12
# Forces that scatter by less than this fraction of their range are computed, or were filtered.
EXACT = 1e-5
# Means of blocks are compared with points as long as there are this many blocks.
_BLOCKS = 64
# Long-run over short-run deviation from which the noise counts as correlated.
_CORRELATED = 1.5
# Recordings of up to this many rows are compared with every other of their rows too, if they have
# this many; white noise changes the ratio by less than this over the square root of their number.
_SHORT, _FEWEST_ROWS, _BY_CHANCE = 2048, 100, 8.0
# Largest fraction of differences that kinks and jumps of the curve may change.
_TRIMMED = 0.02
# Standard deviation over that of normal deviates up to 3, and over the median deviation.
_CLIPPED, _MAD = 0.98658, 1.4826


class Scatter(NamedTuple):
    """Scatter of (n,) forces in the order of measurement.

    Args:
        sd: standard deviation of a force about a smooth curve [N]; 0 for fewer than 12 points.
        local: (n,) the same where the force was measured [N], at least `sd`.
        step: resolution of the forces [N]; 0 if none is recognised.
        ratio: long-run over short-run standard deviation; 1 for white noise.
        slow: standard deviation of the correlated part [N]; 0 for white noise, infinite if the
            correlation lasts longer than can be resolved, as in drift.
        rows: number of rows over which the noise is correlated; 0 for white noise.
    """

    sd: float
    local: Floats
    step: float
    ratio: float = 1.0
    slow: float = 0.0
    rows: int = 0


def scatter_of(force: Floats, travel: Floats | None = None) -> Scatter:
    """Scatter of (n,) forces [N] in the order of measurement.

    It is taken from differences of 4th and 6th order, which a resolved smooth curve leaves at
    zero. Median deviations and trimmed means leave out kinks and jumps of the curve.

    Args:
        force: (n,) [N].
        travel: (n,) [m] for rows that are not equally spaced; None for equal spacing.

    Source: differences as in Hall, Kay & Titterington 1990; long-run deviation of block means.
    """
    n = len(force)
    if n < FEWEST:
        return Scatter(0.0, np.zeros(n), 0.0)
    step = _resolution(force)
    contrasts = [_differences(force, order, travel) for order in _ORDERS]
    if travel is not None:
        contrasts += [_differences(force, order, None) for order in _ORDERS]
    sizes = [_size(one, step > 0.0) for one in contrasts]
    best = int(np.argmin(sizes))
    floor = step / 12**0.5
    sd = max(sizes[best], floor)
    local = np.maximum(_local(contrasts[best], n), sd)
    # Without noise, means of blocks show the shape of the curve only.
    exact = sd <= EXACT * float(np.ptp(force))
    ratio, slow, rows = (1.0, 0.0, 0) if exact else _long_run(force, sd, travel)
    return Scatter(sd, local, step, ratio, slow, rows)


def without_outliers(force: Floats, sd: float) -> tuple[Floats, int]:
    """The (n,) forces with single outliers replaced by a median of five, and their number.

    An outlier is more than 6 `sd` [N] from that median, and far more than its neighbours.
    """
    from scipy import ndimage  # pyright: ignore[reportMissingTypeStubs]

    images: Any = ndimage

    if len(force) < 50:
        return force, 0
    middle: Floats = images.median_filter(force, 5, mode="nearest")
    off = np.abs(force - middle)
    # Percentiles of a window are slow: they are taken where they decide.
    candidates = np.flatnonzero(off > 6.0 * sd)
    if not len(candidates) or len(candidates) > 0.1 * len(force):
        return force, 0
    steps = np.abs(np.diff(force, append=force[-1:]))
    near = np.clip(candidates[:, None] + np.arange(-10, 11), 0, len(force) - 1)
    usual = np.maximum(
        4.0 * np.percentile(off[near], 75, axis=1), 3.0 * np.median(steps[near], axis=1)
    )
    spikes = candidates[off[candidates] > usual]
    cleaned = force.copy()
    cleaned[spikes] = middle[spikes]
    return cleaned, len(spikes)


def _differences(force: Floats, order: int, travel: Floats | None) -> Floats:
    """(n - order,) combinations of neighbours that vanish for cubics or quintics, of unit norm."""
    n = len(force) - order
    if travel is None:
        values = np.diff(force, order)
        weights = np.poly(np.ones(order))
        return values / np.sqrt(np.sum(weights**2))
    x = np.stack([travel[k : k + n] for k in range(order + 1)])
    y = np.stack([force[k : k + n] for k in range(order + 1)])
    apart = x[:, None] - x[None]
    apart[np.arange(order + 1), np.arange(order + 1)] = 1.0
    # Divided differences; rows at one travel compare with each other alone.
    scale: Floats = np.abs(x[-1] - x[0]) / order
    small = 1e-6 * scale
    apart = np.where(np.abs(apart) < small, np.where(apart < 0, -small, small), apart) / scale
    weights = 1.0 / np.prod(apart, axis=1)
    return np.sum(weights * y, axis=0) / np.sqrt(np.sum(weights**2, axis=0))


def _size(contrast: Floats, coarse: bool) -> float:
    """Standard deviation of differences without the largest, which are kinks and jumps."""
    size = np.abs(contrast)
    median = _MAD * float(np.median(size))
    if coarse:  # On a grid most differences may be 0.
        keep = max(1, int(np.ceil((1.0 - _TRIMMED) * len(size))))
        trimmed = np.partition(size, keep - 1)[:keep]
        return max(median, float(np.sqrt(np.mean(trimmed**2))))
    inner = size[size <= 3.0 * median]
    clipped = float(np.sqrt(np.mean(inner**2))) / _CLIPPED if len(inner) else 0.0
    return clipped if len(size) > 200 else max(median, clipped)


def _local(contrast: Floats, n: int) -> Floats:
    """(n,) standard deviation of the neighbourhood, by the largest of three blocks."""
    blocks = min(24, len(contrast) // 60)
    if blocks < 3:
        return np.zeros(n)
    parts = np.array_split(np.abs(contrast), blocks)
    sizes = _MAD * np.array([np.median(part) for part in parts])
    # Kinks change few differences of a block. The ends of a noisy stretch are inside blocks.
    padded = np.pad(np.where(sizes > 2.0 * np.median(sizes), sizes, 0.0), 1)
    middle = np.max(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0)
    return np.repeat(middle, [len(part) for part in np.array_split(np.arange(n), blocks)])


def _long_run(force: Floats, sd: float, travel: Floats | None) -> tuple[float, float, int]:
    """Long-run ratio, standard deviation of the slow part, and the rows of its correlation."""
    sizes = [2**k for k in range(1, 21) if len(force) >= _BLOCKS * 2**k]
    deviations: list[float] = []
    for size in sizes:
        count = len(force) // size
        means = force[: count * size].reshape(count, size).mean(axis=1)
        contrasts = [np.abs(_differences(means, order, None)) for order in _ORDERS]
        deviations.append(_MAD * min(float(np.median(one)) for one in contrasts))
    ratios = np.array(deviations) * np.sqrt(sizes) / sd
    # Means of white noise scatter by chance, and the largest blocks see the shape of the curve.
    few = len(ratios) < 3
    if (
        np.sum(ratios > 0.8 * _CORRELATED) < 3 - few
        or np.max(ratios) < (1.3 if few else 1.0) * _CORRELATED
    ):
        return _of_every_other(force, sd, travel)
    most = int(np.argmax(ratios))
    grows = most == len(ratios) - 1 and ratios[-1] > 1.15 * ratios[-2]
    return float(ratios[most]), np.inf if grows else max(deviations), sizes[most]


def _of_every_other(force: Floats, sd: float, travel: Floats | None) -> tuple[float, float, int]:
    """The same from every 2nd, 3rd and 4th row: the means of short recordings are too few."""
    if not _FEWEST_ROWS <= len(force) <= _SHORT:
        return 1.0, 0.0, 0

    def deviation(apart: int, order: int, at: Floats | None) -> float:
        rows = (slice(k, None, apart) for k in range(apart))
        each = [_differences(force[k], order, None if at is None else at[k]) for k in rows]
        return _MAD * float(np.median(np.abs(np.concatenate(each))))

    spacings = (None,) if travel is None else (None, travel)
    deviations = [
        min(deviation(apart, order, at) for order in _ORDERS for at in spacings)
        for apart in (2, 3, 4)
    ]
    most = int(np.argmax(deviations))
    ratio = deviations[most] / sd
    if ratio < _CORRELATED * 0.8 or (ratio - 1.0) * len(force) ** 0.5 < _BY_CHANCE:
        return 1.0, 0.0, 0
    return float(ratio), deviations[most], most + 2


def _resolution(force: Floats) -> float:
    """Step of the grid on which all forces lie [N]; 0 if there is none, or a fine one."""
    values = np.unique(force)
    if len(values) < 2 or len(values) > 0.5 * len(force):
        return 0.0
    steps = np.diff(values)
    # Rounding errors of one value are no step.
    steps = steps[steps > 1e-9 * (values[-1] - values[0])]
    least = float(np.min(steps))
    whole = steps / least
    return least if np.all(np.abs(whole - np.round(whole)) < 0.02 * np.maximum(whole, 1)) else 0.0


# Scatter matters from this fraction of the usual change of force between two points.
_MATTERS = 0.1
# Fewer points are chosen, not recorded.
_RECORDED = 20


def scatter_of_curve(rows: Floats, end: float) -> float:
    """Scatter of the points through which cubic rows pass [N]; 0 if it changes no slope much.

    Args:
        rows: (n, 6) of a curve, see `mechanism/cubics`.
        end: travel where the last one ends [m].
    """
    width = np.diff(rows[:, 0], append=end)
    _, c1, c2, c3 = rows[:, 1:5].T
    # A cut within one cubic is no point. Slope, curvature and its change are compared by what they
    # add to the slope.
    ahead = np.stack([c1 + width * (2 * c2 + 3 * c3 * width), 2 * c2 + 6 * c3 * width, 3 * c3])
    own = np.stack([c1, 2 * c2, 3 * c3])
    by = width ** np.arange(3)[:, None]
    size = np.sum(np.abs(own) * by, axis=0)
    off = np.abs(own[:, 1:] - ahead[:, :-1]) * by[:, :-1]
    given = np.append(True, np.any(off > 1e-6 * (size[1:] + size[:-1]), axis=0))
    travel, force = rows[given, 0], rows[given, 1]
    if len(travel) < _RECORDED:
        return 0.0
    sd = scatter_of(force, travel).sd
    return sd if sd * 2**0.5 > _MATTERS * float(np.median(np.abs(np.diff(force)))) else 0.0
