"""Curves that fold back in travel: which stretches are stable, and where the others lead."""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from stepwell.base import Floats, InputError, Measure, told_in
from stepwell.mechanism.cubics import end_of, integral, through, with_integrals
from stepwell.mechanism.elements.build import pairs
from stepwell.mechanism.elements.sheet import Sheet


def folded(travel: Iterable[float], force: Iterable[float], measure: Measure) -> tuple[Sheet, ...]:
    """The stable sheets of a curve that is given by points along its arc."""
    x, y = pairs(travel, force, measure, 3)
    _refuse_standing(x, measure)
    heading = np.sign(np.diff(x)).astype(int)
    folds = [0, *(np.flatnonzero(np.diff(heading)) + 1).tolist(), len(x) - 1]
    stretches = list(pairwise(folds))
    unstable, energy = 0, 0.0
    found: list[tuple[bool, bool, Floats, float]] = []
    for number, (a, b) in enumerate(stretches):
        if number:
            unstable += _turn(x, y, a)
            if unstable < 0:
                unit, factor = told_in(measure.travel_unit)
                raise InputError(
                    f"at travel {x[a] * factor:.6g} {unit} the curve folds counterclockwise (force "
                    f"over {measure.travel}), which ends an instability that it never had: it "
                    f"must begin at a stable end. Give the points from there on, along the arc."
                )
        way = slice(a, b + 1)
        up = heading[a] > 0
        s, f = (x[way], y[way]) if up else (x[way][::-1], y[way][::-1])
        rows = through(s, f)
        work = end_of(rows, float(s[-1]))[2]
        # The energy goes on continuously along the arc, unstable stretches included.
        begin = energy if up else energy - work
        energy += work if up else -work
        found.append((unstable == 0, up, with_integrals(rows, begin), float(s[-1])))
    return _linked(found, measure)


def _turn(x: Floats, y: Floats, at: int) -> int:
    """+1 where the curve turns clockwise at a point, -1 where counterclockwise."""
    (dx1, dy1), (dx2, dy2) = (
        (x[at] - x[at - 1], y[at] - y[at - 1]),
        (
            x[at + 1] - x[at],
            y[at + 1] - y[at],
        ),
    )
    return 1 if dx1 * dy2 - dy1 * dx2 < 0.0 else -1


def _linked(
    stretches: list[tuple[bool, bool, Floats, float]], measure: Measure
) -> tuple[Sheet, ...]:
    numbers = np.cumsum([stable for stable, *_ in stretches]) - 1
    sheets: list[Sheet] = []
    for k, (stable, up, rows, end) in enumerate(stretches):
        if not stable:
            continue
        begin = float(rows[0, 0])
        after = _landing(stretches, k, +1, end if up else begin, measure)
        before = _landing(stretches, k, -1, begin if up else end, measure)
        above, below = (after, before) if up else (before, after)
        sheets.append(
            Sheet.of(
                rows,
                end,
                None if below is None else int(numbers[below]),
                None if above is None else int(numbers[above]),
            )
        )
    return tuple(sheets)


def _landing(
    stretches: list[tuple[bool, bool, Floats, float]],
    k: int,
    step: int,
    at: float,
    measure: Measure,
) -> int | None:
    """The next stable stretch along the arc that holds this travel; None at the curve's end."""
    if not 0 <= k + step < len(stretches):
        return None
    here = float(integral(stretches[k][2], np.array(at)))
    j = k + step
    while 0 <= j < len(stretches):
        stable, _, rows, end = stretches[j]
        if stable and rows[0, 0] <= at <= end and float(integral(rows, np.array(at))) < here:
            return j
        j += step
    unit, factor = told_in(measure.travel_unit)
    raise InputError(
        f"at travel {at * factor:.6g} {unit} a stable stretch of the curve ends, and no stable one "
        f"of less energy that follows along the arc holds that travel: there is nowhere to land. "
        f"Give the curve further, and its unstable stretches too."
    )


def _refuse_standing(x: Floats, measure: Measure) -> None:
    still = np.flatnonzero(np.diff(x) == 0.0)
    if len(still):
        unit, factor = told_in(measure.travel_unit)
        at = int(still[0])
        raise InputError(
            f"travel[{at + 1}] = {x[at + 1] * factor:.6g} {unit}, as the point before: "
            f"neighbouring points of a curve must differ in travel; where it is upright "
            f"leave one out."
        )
