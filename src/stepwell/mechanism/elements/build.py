"""Curves of elements from what people have: tables, points, laws."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from stepwell.base import Floats, InputError, Measure, check, require, told_in
from stepwell.mechanism.cubics import (
    Force,
    along,
    monotone,
    signs,
    straight,
    through,
    value,
    with_integrals,
)

_LEAST_POINTS = 3


def points(
    travel: Iterable[float], force: Iterable[float], measure: Measure
) -> tuple[Floats, float]:
    """Rows and end of straight lines between points."""
    x, y = checked(travel, force, measure, 2)
    return straight(x, y), float(x[-1])


def table(
    travel: Iterable[float], force: Iterable[float], noise: float | None, measure: Measure
) -> tuple[Floats, float, float]:
    """Rows and end of a smooth curve through points, and how far they lie from it at most."""
    x, y = checked(travel, force, measure, _LEAST_POINTS)
    if noise is None:
        return through(x, y), float(x[-1]), 0.0
    deviation = check.positive("noise", noise, measure.force_unit)
    rows = _smoothed(x, y, deviation)
    band = float(np.max(np.abs(y - value(rows, x))))
    _refuse_noise(rows, float(x[-1]), deviation, measure)
    return rows, float(x[-1]), band


def law(
    force: Force, low: float, high: float, kinks: Sequence[float], accuracy: float, measure: Measure
) -> tuple[Floats, float]:
    """Rows and end of a law between two travels."""
    unit = measure.travel_unit
    low, high = check.finite("low", low, unit), check.finite("high", high, unit)
    if high <= low:
        raise InputError(f"high = {high!r} {unit}: must be above low = {low!r} {unit}.")
    if not 1e-13 <= accuracy <= 1e-2:
        raise InputError(f"accuracy = {accuracy!r}: must be from 1e-13 to 0.01.")
    return along(force, low, high, accuracy, kinks), high


def checked(
    travel: Iterable[float], force: Iterable[float], measure: Measure, least: int
) -> tuple[Floats, Floats]:
    """Points of a function, as arrays; raises ValueError where they are none."""
    x, y = pairs(travel, force, measure, least)
    steps = np.diff(x)
    if np.any(steps <= 0.0):
        unit, factor = told_in(measure.travel_unit)
        at = int(np.argmax(steps <= 0.0))
        back = "falls back" if steps[at] < 0 else "stays"
        raise InputError(
            f"travel[{at + 1}] = {x[at + 1] * factor:.6g} {unit} after {x[at] * factor:.6g} "
            f"{unit}: {back}, so that force is no function of {measure.travel}. Sort the table "
            f"and drop repeated rows; give loading or unloading alone, not both; or, if the curve "
            f"truly folds back, use Element.from_curve."
        )
    return x, y


def pairs(
    travel: Iterable[float], force: Iterable[float], measure: Measure, least: int
) -> tuple[Floats, Floats]:
    """Points in any order, as arrays; raises ValueError where they are none or too few."""
    x = np.array(
        [check.finite(f"travel[{i}]", v, measure.travel_unit) for i, v in enumerate(travel)]
    )
    y = np.array(check.as_many("force", force, measure.force_unit, "travel", len(x)), float)
    if len(x) < least:
        raise InputError(
            f"the table has {len(x)} points: must have {least} or more; a snap needs some on every "
            f"side of it."
        )
    require("rows", len(x), "the table has")
    if not np.any(y):
        raise InputError("force is 0 everywhere: an element has a force that resists travel.")
    return x, y


def _smoothed(x: Floats, y: Floats, noise: float) -> Floats:
    """The smoothest cubic spline that leaves as much scatter as the noise explains."""
    from scipy.interpolate import PPoly, UnivariateSpline  # pyright: ignore[reportMissingTypeStubs]

    if len(x) < 5:
        raise InputError(
            f"noise: the table has {len(x)} points: must have 5 or more to be smoothed; leave "
            f"noise out to go through every point."
        )
    spline = UnivariateSpline(x, y, w=np.full(len(x), 1.0 / noise), k=3, s=len(x))
    pieces = PPoly.from_spline(spline._eval_args)  # pyright: ignore[reportPrivateUsage, reportUnknownMemberType]
    keep = np.diff(pieces.x) > 0.0
    rows = np.zeros((int(np.sum(keep)), 6))
    rows[:, 0], rows[:, 1:5] = pieces.x[:-1][keep], pieces.c[::-1].T[keep]
    return with_integrals(rows)


def _refuse_noise(rows: Floats, end: float, noise: float, measure: Measure) -> None:
    """Raise ValueError where a snap of the curve is no larger than its noise."""
    forces, rises = signs(monotone(rows, end), end)
    # Forces where it turns, ends included; a fall between two of them is a snap.
    turns = [0, *(k for k in range(1, len(rises)) if rises[k] != rises[k - 1]), len(rises)]
    drops = [forces[a] - forces[b] for a, b in pairwise(turns)]
    falls = [drop for drop in drops if drop > 0.0]
    if falls and min(falls) < 2.0 * noise:
        unit, factor = told_in(measure.force_unit)
        raise InputError(
            f"noise = {noise * factor:.4g} {unit}: a snap of the smoothed curve drops by "
            f"{min(falls) * factor:.4g} {unit} only, less than twice that, so nothing tells it "
            f"from noise. Average several recordings, or measure with less noise."
        )
