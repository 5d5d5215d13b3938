"""The smooth curve through noisy points: its rising and falling stretches, and its error band."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, Ints, Measure, amount, display_unit
from stepwell.mechanism.scatter import EXACT, Scatter, scatter_of, without_outliers

# Points are averaged over at most this many intervals of equal travel.
_BINS = 2048
# Spans of the spline, and points of the fine grid in each.
_MOST_SPANS, _LEAST_SPANS, _FINE = 160, 8, 8
# Standard deviations beyond the largest of many windows of noise, for a stretch that is proven to
# rise or fall, and for a window in which the curve is too smooth.
_PROVEN, _MISFIT = 3.0, 1.0
# The penalty is on these differences of coefficients: slopes decide snaps, so that slopes are
# smooth. It begins with this weight over that of all points, and is weakened in rounds.
_DIFFERENCE = (1.0, -4.0, 6.0, -4.0, 1.0)
_WIDE, _START = len(_DIFFERENCE), 1e9
_MOST_ROUNDS, _WEAKER = 40, 0.2
# Largest deviation of the curve in units of its largest standard error, in 95 % of made-up curves
# (tests/lab/known_curves.py).
_BAND = 6.5
# A force within this many standard errors of the first one is that before contact, if it lasts for
# more than this fraction of the travel.
_SAME, _APPROACH = 3.0, 0.03
# Standard deviations of a point by which the curve may leave it and its neighbour.
_SWING = 4.0
# Correlated noise makes drops up to this many of its standard deviations.
_SLOW_DROP = 30.0
# Least standard deviation over the range of the forces.
_EXACT = 1e-6


class Bins(NamedTuple):
    """Means of points over intervals of travel, rising.

    Args:
        travel, force: (n,) means [m], [N].
        variance: (n,) of each mean [N²].
    """

    travel: Floats
    force: Floats
    variance: Floats


class Smooth(NamedTuple):
    """A smooth curve, monotone between its turns.

    Args:
        travel, force: (n,) points of the curve [m], [N], turns among them.
        turns: indices of the points at which it turns.
        error: (n,) standard error of the force [N].
        rises: whether its first stretch rises.
    """

    travel: Floats
    force: Floats
    turns: tuple[int, ...]
    error: Floats
    rises: bool


class Fit(NamedTuple):
    """A smooth curve with what was found out about its points.

    Args:
        travel, force: (n,) points of the curve from contact on [m], [N].
        turns: indices of the points at which it turns.
        rises: whether its first stretch rises.
        scatter: of the points.
        outliers: number of replaced forces.
        band: largest error of the curve [N], in 95 % of curves of known shape.
        offset: force before contact [N]; None if the recording begins in contact.
    """

    travel: Floats
    force: Floats
    turns: tuple[int, ...]
    rises: bool
    scatter: Scatter
    outliers: int
    band: float
    offset: float | None

    @property
    def is_exact(self) -> bool:
        """Whether the points show no noise: they are computed, or were filtered."""
        return self.scatter.sd <= EXACT * float(np.ptp(self.force))

    @property
    def changes(self) -> Floats:
        """Size of the change of force on each stretch between turns and ends [N]."""
        return changes(self.force, self.turns)


def changes(force: Floats, turns: Sequence[int]) -> Floats:
    """Size of the change of (n,) forces on each stretch between turns and ends [N]."""
    return np.abs(np.diff(force[[0, *turns, len(force) - 1]]))


def fitted(
    travel: Floats,
    force: Floats,
    noise: float = 0.0,
    least_drop: float = 0.0,
    trim: bool = True,
    measure: Measure = Measure.TRAVEL,
) -> Fit:
    """The smooth curve through (n,) points in the order of measurement.

    Args:
        travel: (n,) [m]; may repeat and step back.
        force: (n,) [N].
        noise: least standard deviation of the forces [N].
        least_drop: turns between which the force changes by less are noise [N].
        trim: whether to leave out a stretch of constant force before the first rise.
        measure: quantities of travel and force, for messages.

    Raises:
        ValueError: no rise is larger than the noise; or the noise is correlated and could make a
            turn, and `least_drop` is 0.
    """
    unit, named = measure.force_unit, measure.force
    if not np.ptp(force):
        level = amount(float(force[0]), unit)
        raise InputError(f"the {named} is {level} everywhere: must rise and fall.")
    new = np.append(True, (np.diff(travel) != 0.0) | (np.diff(force) != 0.0))
    travel, force = travel[new], force[new]
    steps = np.diff(travel)
    one_way = np.all(steps > 0.0) or np.all(steps < 0.0)
    spaced = travel if len(travel) <= 500 and one_way else None
    scatter = scatter_of(force, spaced)
    cleaned, outliers = without_outliers(force, max(scatter.sd, noise))
    if outliers:
        scatter = scatter_of(cleaned, spaced)
    least = max(noise, _EXACT * float(np.ptp(force)))
    bins = binned(travel, cleaned, scatter.ratio * np.maximum(scatter.local, least))
    curve = smooth(bins, least_drop)
    if not proven(bins):
        raise InputError(
            f"no rise of the {named} is distinguishable from its noise of about "
            f"{amount(max(scatter.sd, noise), unit, 3)}: must rise and fall by more; check that "
            f"{measure.travel} and {named} are in the right columns, or measure with less noise."
        )
    _refuse_slow(curve, scatter, least_drop, unit)
    band = _BAND * float(np.max(curve.error)) + scatter.step / 2.0
    x, y, turns, offset = curve.travel, curve.force, curve.turns, None
    first = turns[0] if turns else len(x) - 1
    contact = _contact(x[: first + 1], y[: first + 1], curve) if trim and curve.rises else None
    if contact is not None:
        start, joins, offset = contact
        keep = int(np.searchsorted(x, joins, side="right"))
        x, y = np.append(start, x[keep:]), np.append(offset, y[keep:])
        turns = tuple(turn - keep + 1 for turn in turns)
    x, y, turns = _with_rising_ends(x, y, turns)
    return Fit(x, y, turns, curve.rises, scatter, outliers, band, offset)


def _with_rising_ends(
    x: Floats, y: Floats, turns: tuple[int, ...]
) -> tuple[Floats, Floats, tuple[int, ...]]:
    """Without the points next to an end because of which monotone cubics are flat there."""
    while len(x) > 3 and 1 not in turns and _flat(np.diff(y[:3]) / np.diff(x[:3])):
        x, y, turns = np.delete(x, 1), np.delete(y, 1), tuple(turn - 1 for turn in turns)
    while (
        len(x) > 3 and len(x) - 2 not in turns and _flat((np.diff(y[-3:]) / np.diff(x[-3:]))[::-1])
    ):
        x, y = np.delete(x, -2), np.delete(y, -2)
    return x, y, turns


def _flat(slopes: Floats) -> bool:
    """Whether the slope of a stretch at an end is far less than that of the next."""
    return bool(2.5 * abs(slopes[0]) < abs(slopes[1]))


def _contact(x: Floats, y: Floats, curve: Smooth) -> tuple[float, float, float] | None:
    """Travel where a constant force ends, travel where the curve joins, and that force.

    None if the force does not begin constant.
    """
    near = max(_SAME * float(np.max(curve.error)), _EXACT * float(np.ptp(curve.force)))
    lead = x <= curve.travel[0] + _APPROACH * float(np.ptp(curve.travel))
    offset = float(np.median(y[lead]))
    last = int(np.argmax(np.append(np.abs(y - offset) > near, True)))
    if last >= len(x) - 1 or np.sum(lead) > last or np.max(y) <= offset + 8.0 * near:
        return None
    # The line through two forces beyond, back to where it meets the constant one.
    begin = max(last - 1, 0)
    levels = [offset + 4.0 * near, offset + 8.0 * near]
    first, second = np.interp(levels, y[begin:], x[begin:])
    start = max(2.0 * float(first) - float(second), float(x[begin]))
    # On a line that only begins slowly the curve would rise by little more than its error.
    if 4.0 * near * (start - x[0]) < 6.0 * near * float(second - first):
        return None
    return start, float(first), offset


def _refuse_slow(curve: Smooth, scatter: Scatter, least_drop: float, unit: str) -> None:
    """Raise ValueError where correlated noise may have made a turn."""
    most = _SLOW_DROP * scatter.slow
    least = float(np.min(changes(curve.force, curve.turns)))
    if least_drop or not curve.turns or least >= most:
        return
    size = "drops of any size"
    if np.isfinite(most):
        size = f"drops up to about {amount(most, unit, 3)}"
    raise InputError(
        f"the noise is correlated over {scatter.rows} rows or more (drift, vibration or a filter): "
        f"{size} may be noise, and the smallest change between turns is "
        f"{amount(least, unit, 3)}. Give the smallest drop that counts as a snap, as least_drop= "
        f"in {unit} (--least-drop in {display_unit(unit)[0]})."
    )


def binned(travel: Floats, force: Floats, sd: Floats) -> Bins:
    """Means of (n,) points in any order, each with its standard deviation [N]."""
    low, high = float(np.min(travel)), float(np.max(travel))
    if len(travel) <= _BINS:
        _, place = np.unique(travel, return_inverse=True)
    else:
        place = np.minimum((travel - low) * (_BINS / (high - low)), _BINS - 1).astype(int)
    count = np.bincount(place).astype(float)
    full = count > 0
    count = count[full]
    x, y, v = (np.bincount(place, one)[full] / count for one in (travel, force, sd**2))
    return Bins(x, y, v / count)


def proven(bins: Bins) -> list[tuple[int, int, int]]:
    """The longest alternating chain of stretches that are proven to rise or fall.

    Means of neighbouring windows of all sizes are compared; on a monotone curve no difference
    against its direction is larger than noise makes it.

    Returns:
        Direction, first bin and the bin after the last of each stretch, in order.

    Source: tests on all scales as in Dümbgen & Spokoiny 2001; taut strings (Davies & Kovac 2001)
        count extrema in the same way.
    """
    n = len(bins.force)
    end_of = {1: np.full(n + 1, n + 1), -1: np.full(n + 1, n + 1)}
    weight = np.concatenate([[0.0], np.cumsum(1.0 / bins.variance)])
    total = np.concatenate([[0.0], np.cumsum(bins.force / bins.variance)])
    for m in _sizes(n // 2):
        w, t = weight[m:] - weight[:-m], total[m:] - total[:-m]
        mean, var = t / w, 1.0 / w
        score = (mean[m:] - mean[:-m]) / np.sqrt(var[m:] + var[:-m])
        for way, ends in end_of.items():
            at = np.flatnonzero(way * score > _bound(n, m) + _PROVEN)
            ends[at] = np.minimum(ends[at], at + 2 * m)
    for ends in end_of.values():
        # The earliest end of the stretches that begin there or later.
        ends[:] = np.minimum.accumulate(ends[::-1])[::-1]
    return max((_chain(end_of, way, n) for way in (1, -1)), key=len)


def _chain(end_of: dict[int, Ints], way: int, n: int) -> list[tuple[int, int, int]]:
    chain: list[tuple[int, int, int]] = []
    at = 0
    while (end := int(end_of[way][at])) <= n:
        # The last begin of a stretch with this end.
        begin = int(np.flatnonzero(end_of[way] <= end)[-1])
        chain.append((way, begin, end))
        at, way = end, -way
    return chain


def _sizes(most: int) -> list[int]:
    sizes = [1]
    while (larger := max(sizes[-1] + 1, int(1.25 * sizes[-1]))) <= most:
        sizes.append(larger)
    return sizes if most else []


def _bound(n: int, m: int) -> float:
    return float(np.sqrt(2.0 * np.log(np.e * n / m)))


def smooth(bins: Bins, least_drop: float = 0.0) -> Smooth:
    """The smooth curve through points, with the turns that are proven and no others.

    A cubic spline with a penalty on fourth differences, which is weakened wherever the points
    contradict it; then monotone between the proven turns. Turns between which the force changes by
    less than `least_drop` [N] are taken out.

    Source: P-splines (Eilers & Marx 1996); local weights as in Davies & Kovac 2001; isotonic
        regression between turns.
    """
    x, y, error = _spline(bins)
    y, most = _within(bins, x, y)
    stretches = proven(bins)
    turns = _turns(bins, x, y, stretches)
    rises = not stretches or stretches[0][0] > 0
    # What a window shows and the curve does not is no turn of the curve.
    least = max(least_drop, float(np.max(np.minimum(error, most))))
    turns, rises = _without_small(y, turns, rises, least)
    error = np.where(_near_turns(bins, x, turns), error, np.minimum(error, most))
    y = _monotone(x, y, error, turns, rises)
    keep = np.union1d(np.arange(0, len(x), _FINE), turns).astype(int)
    at = np.searchsorted(keep, turns)
    return Smooth(x[keep], y[keep], tuple(at.tolist()), error[keep], rises)


def _within(bins: Bins, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The spline within the noise of the points beside each travel, and its largest standard error.

    A spline swings where the points are far apart, and beside a jump; the curve is monotone there.
    """
    after = np.clip(np.searchsorted(bins.travel, x), 1, len(bins.travel) - 1)
    sides = np.stack([bins.force[after - 1], bins.force[after]])
    noise = _SWING * np.sqrt(np.maximum(bins.variance[after - 1], bins.variance[after]))
    low, high = np.min(sides, axis=0), np.max(sides, axis=0)
    return np.clip(y, low - noise, high + noise), (high - low + 2.0 * noise) / _BAND


def _near_turns(bins: Bins, x: Floats, turns: list[int]) -> np.ndarray:
    """Mask of the travels from whose neighbouring points a turn is at most one point away."""
    after = np.searchsorted(bins.travel, x)
    return np.isin(after, [after[turn] + k for turn in turns for k in (-1, 0, 1)])


def _spline(bins: Bins) -> tuple[Floats, Floats, Floats]:
    """Fine grid of travels, the spline there, and its standard error."""
    from scipy import interpolate, linalg, sparse  # pyright: ignore[reportMissingTypeStubs]

    splines: Any = interpolate.BSpline
    solver: Any = linalg
    matrices: Any = sparse
    low, high = float(bins.travel[0]), float(bins.travel[-1])
    spans = int(np.clip(len(bins.travel), _LEAST_SPANS, _MOST_SPANS))
    step = (high - low) / spans
    knots = low + step * np.arange(-3, spans + 4)
    design = splines.design_matrix(bins.travel, knots, 3, extrapolate=True)
    fine = np.linspace(low, high, spans * _FINE + 1)
    on_fine = splines.design_matrix(fine, knots, 3, extrapolate=True)
    weight = matrices.diags_array(1.0 / bins.variance)
    normal = (design.T @ weight @ design).tocsr()
    right = design.T @ (bins.force / bins.variance)
    bands = np.zeros((_WIDE, size := spans + 3))
    for k in range(4):
        bands[_WIDE - 1 - k, k:] = normal.diagonal(k)
    scale = float(np.sum(bands[-1]))
    local = np.full(size - _WIDE + 1, _START * scale)
    span = np.clip(((bins.travel - low) / step).astype(int), 0, spans - 1)

    def solved(factor: float, wanted: Floats) -> Floats:
        return solver.solveh_banded(bands + _penalty(factor * local, 1e-9 * scale), wanted)

    for _ in range(_MOST_ROUNDS):
        bad = _misfit(bins, bins.force - design @ solved(1.0, right))
        # Differences in the middle of the four coefficients of a span.
        near = np.zeros(len(local), bool)
        near[np.clip(np.unique(span[bad])[:, None] - np.arange(4), 0, len(local) - 1)] = True
        near &= local > 1e-9 * scale
        if not near.any():
            break
        local[near] *= _WEAKER
    # How strong all of it should be: Mallows' C_p.
    dense, costs = normal.toarray(), list[float]()
    factors = 0.35 ** np.arange(10)
    for factor in factors:
        rest = bins.force - design @ solved(factor, right)
        effective = float(np.trace(solved(factor, dense)))
        costs.append(float(np.sum(rest**2 / bins.variance)) + 2.0 * effective)
    inverse: Floats = on_fine @ solved(factors[int(np.argmin(costs))], np.eye(size))
    error = np.sqrt(np.maximum(np.sum((normal @ inverse.T).T * inverse, axis=1), 0.0))
    return fine, inverse @ right, error


def _penalty(local: Floats, least: float) -> Floats:
    """Bands of the penalty on differences of coefficients, the diagonal last."""
    bands = np.zeros((_WIDE, len(local) + _WIDE - 1))
    bands[-1] = least
    for i, a in enumerate(_DIFFERENCE):
        for j, b in enumerate(_DIFFERENCE[i:]):
            bands[_WIDE - 1 - j, i + j : i + j + len(local)] += a * b * local
    return bands


def _misfit(bins: Bins, rest: Floats) -> np.ndarray:
    """Bins in windows whose mean residual is larger than noise makes it."""
    n = len(rest)
    weight = np.concatenate([[0.0], np.cumsum(1.0 / bins.variance)])
    total = np.concatenate([[0.0], np.cumsum(rest / bins.variance)])
    marks = np.zeros(n + 1)
    for m in _sizes(n):
        score = (total[m:] - total[:-m]) / np.sqrt(weight[m:] - weight[:-m])
        at = np.flatnonzero(np.abs(score) > _bound(n, m) + _MISFIT)
        marks[at] += 1.0
        marks[at + m] -= 1.0
    return np.cumsum(marks)[:-1] > 0.5


def _turns(bins: Bins, x: Floats, y: Floats, stretches: list[tuple[int, int, int]]) -> list[int]:
    """Indices of the grid at which the spline turns between proven stretches."""
    turns: list[int] = []
    last = 0
    for (way, begin, _), (_, _, end) in pairwise(stretches):
        first, final = float(bins.travel[begin]), float(bins.travel[end - 1])
        low = max(int(np.searchsorted(x, first)), last + 1)
        high = max(int(np.searchsorted(x, final, side="right")), low + 1)
        last = low + int(np.argmax(way * y[low:high]))
        turns.append(last)
    return [turn for turn in turns if 0 < turn < len(x) - 1]


def _without_small(
    y: Floats, turns: list[int], rises: bool, least: float
) -> tuple[list[int], bool]:
    """Without the pairs of turns between which the force changes by less than `least`."""
    while True:
        sizes = changes(y, turns)
        if not turns or np.min(sizes) >= least:
            return turns, rises
        small = int(np.argmin(sizes))
        if small == 0:
            turns, rises = turns[1:], not rises
        elif small == len(sizes) - 1:
            turns = turns[:-1]
        else:
            turns = turns[: small - 1] + turns[small + 1 :]


def _monotone(x: Floats, y: Floats, error: Floats, turns: list[int], rises: bool) -> Floats:
    """The curve made monotone from turn to turn, and nowhere constant."""
    from scipy.optimize import isotonic_regression  # pyright: ignore[reportMissingTypeStubs]

    out = y.copy()
    tiny = max(0.1 * float(np.max(error)), 1e-5 * float(np.ptp(y))) / (x[-1] - x[0])
    places = [0, *turns, len(x) - 1]
    way = 1.0 if rises else -1.0
    for k, (a, b) in enumerate(pairwise(places)):
        part = slice(a, b + 1)
        ramp = tiny * (x[part] - x[a])
        weights = np.ones(b - a + 1)
        # Turns stay where they are, so that neighbouring stretches meet.
        weights[0] = 1e6 if k else 1.0
        weights[-1] = 1e6 if b < len(x) - 1 else 1.0
        level: Any = isotonic_regression(way * y[part] - ramp, weights=weights)
        out[part] = way * (level.x + ramp)
        way = -way
    return out
