"""Curves of elements: from tables, points and laws, folded back in travel, side by side."""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, Measure, check, display_unit, require
from stepwell.mechanism import cubics
from stepwell.mechanism.phase import Sheet

if TYPE_CHECKING:
    from stepwell.mechanism.element import Element


class _Stretch(NamedTuple):
    """A part of a curve between two folds, whether it is stable, and whether its arc goes up."""

    stable: bool
    up: bool
    rows: Floats
    end: float


def checked(
    travel: Iterable[float], force: Iterable[float], measure: Measure, least: int
) -> tuple[Floats, Floats]:
    """Points of a function, as arrays; raises ValueError where they are none."""
    x, y = pairs(travel, force, measure, least)
    steps = np.diff(x)
    if np.any(steps <= 0.0):
        unit, factor = display_unit(measure.travel_unit)
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
    unit = measure.travel_unit
    x = np.array([check.finite(f"travel[{i}]", v, unit) for i, v in enumerate(travel)])
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


def folded(travel: Iterable[float], force: Iterable[float], measure: Measure) -> tuple[Sheet, ...]:
    """The stable sheets of a curve that is given by points along its arc."""
    x, y = pairs(travel, force, measure, 3)
    _refuse_standing(x, measure)
    heading = np.sign(np.diff(x)).astype(int)
    folds = [0, *(np.flatnonzero(np.diff(heading)) + 1).tolist(), len(x) - 1]
    unstable, energy = 0, 0.0
    stretches: list[_Stretch] = []
    for number, (a, b) in enumerate(pairwise(folds)):
        if number:
            unstable += _turn(x, y, a)
            if unstable < 0:
                unit, factor = display_unit(measure.travel_unit)
                raise InputError(
                    f"at travel {x[a] * factor:.6g} {unit} the curve folds counterclockwise (force "
                    f"over {measure.travel}), so it was unstable before: it must begin at a stable "
                    f"end. Give the points from a stable end on, along the arc."
                )
        way, up = slice(a, b + 1), heading[a] > 0
        s, f = (x[way], y[way]) if up else (x[way][::-1], y[way][::-1])
        rows = cubics.through(s, f)
        work = cubics.end_of(rows, float(s[-1]))[2]
        # The energy is continuous along the arc, unstable stretches included.
        begin = energy if up else energy - work
        energy += work if up else -work
        rows = cubics.with_integrals(rows, begin)
        stretches.append(_Stretch(unstable == 0, bool(up), rows, float(s[-1])))
    return _linked(stretches, measure)


def _turn(x: Floats, y: Floats, at: int) -> int:
    """+1 where the curve turns clockwise at a point, -1 where counterclockwise."""
    (dx1, dx2), (dy1, dy2) = (np.diff(of[at - 1 : at + 2]).tolist() for of in (x, y))
    return 1 if dx1 * dy2 - dy1 * dx2 < 0.0 else -1


def _linked(stretches: list[_Stretch], measure: Measure) -> tuple[Sheet, ...]:
    sheets: list[Sheet] = []
    for k, (stable, up, rows, end) in enumerate(stretches):
        if stable:
            way = 1 if up else -1
            ends = ((-way, float(rows[0, 0])), (way, end))
            leads = (_landing(stretches, k, step, at, measure) for step, at in ends)
            sheets.append(Sheet.of(rows, end, *leads))
    return tuple(sheets)


def _landing(
    stretches: list[_Stretch], k: int, step: int, at: float, measure: Measure
) -> int | None:
    """The next stable sheet along the arc that holds this travel; None at the curve's end."""
    if not 0 <= k + step < len(stretches):
        return None
    here = float(cubics.integral(stretches[k].rows, np.array(at)))
    for j in range(k + step, len(stretches) if step > 0 else -1, step):
        stable, _, rows, end = stretches[j]
        if stable and rows[0, 0] <= at <= end and float(cubics.integral(rows, np.array(at))) < here:
            return sum(one.stable for one in stretches[:j])
    unit, factor = display_unit(measure.travel_unit)
    raise InputError(
        f"at travel {at * factor:.6g} {unit} a stable stretch of the curve ends, and no stable one "
        f"of less energy that follows along the arc holds that travel: there is nowhere to land. "
        f"Give the curve further, and its unstable stretches too."
    )


def _refuse_standing(x: Floats, measure: Measure) -> None:
    still = np.flatnonzero(np.diff(x) == 0.0)
    if len(still):
        unit, factor = display_unit(measure.travel_unit)
        at = int(still[0])
        raise InputError(
            f"travel[{at + 1}] = {x[at + 1] * factor:.6g} {unit}, as the point before: "
            f"neighbouring points of a curve must differ in travel; where it is upright "
            f"leave one out."
        )


Place = tuple[int, ...]


def in_parallel(
    elements: "Sequence[Element]",
) -> tuple[tuple[Sheet, ...], tuple[bool, bool], float]:
    """Sheets, stops and friction of elements in parallel."""
    _refuse_unlike(elements)
    reach = 2.0 * max(element.largest_force for element in elements)
    curves = [_curves(element, reach) for element in elements]
    start: Place = (0,) * len(elements)
    sheet_at: dict[Place, tuple[Floats, float, Place | None, Place | None]] = {}
    waiting, stops = [start], [False, False]
    while waiting:
        place = waiting.pop()
        if place in sheet_at:
            continue
        require("branches", len(sheet_at), "side by side the elements have")
        parts = [curve[sheet] for curve, sheet in zip(curves, place, strict=True)]
        low, below = _end(place, parts, 0, stops)
        high, above = _end(place, parts, 1, stops)
        if not low < high:
            unit, factor = display_unit(elements[0].measure.travel_unit)
            raise InputError(
                f"elements in parallel have no common travel: one begins at {low * factor:.6g} "
                f"{unit}, another ends at {high * factor:.6g} {unit}."
            )
        sheet_at[place] = _sum([part[0] for part in parts], low, high), high, below, above
        waiting += [other for other in (below, above) if other is not None]
    number: dict[Place | None, int] = {place: k for k, place in enumerate(sorted(sheet_at))}
    sheets = [
        Sheet.of(rows, end, number.get(below), number.get(above))
        for _, (rows, end, below, above) in sorted(sheet_at.items())
    ]
    return tuple(sheets), (stops[0], stops[1]), sum(element.friction for element in elements)


# Rows, the ends, whether the curve is open there, and the sheets that it leads to.
_Part = tuple[Floats, tuple[float, float], tuple[bool, bool], tuple[int | None, int | None]]


def _curves(element: "Element", reach: float) -> list[_Part]:
    stopped = element.stopped
    parts: list[_Part] = []
    for sheet in element.laws:
        rows = sheet.extended(element.goes_on(sheet), -reach)
        goes_on = (sheet.below is None and not stopped[0], sheet.above is None and not stopped[1])
        parts.append((rows, (sheet.begin, sheet.end), goes_on, (sheet.below, sheet.above)))
    return parts


def _end(
    place: Place, parts: list[_Part], side: int, stops: list[bool]
) -> tuple[float, Place | None]:
    """Where a common stretch ends on one side, and where it leads from there."""
    inwards, outwards = (max, min) if side == 0 else (min, max)
    bound = [k for k, part in enumerate(parts) if not part[2][side]]
    if not bound:
        return outwards(part[1][side] for part in parts), None
    at = inwards(parts[k][1][side] for k in bound)
    ends = [k for k in bound if parts[k][1][side] == at]
    folds = [k for k in ends if parts[k][3][side] is not None]
    if len(folds) < len(ends):
        stops[side] = True
        return at, None
    if len(folds) > 1:
        raise InputError(
            f"elements {folds[0] + 1} and {folds[1] + 1} fold back at the same travel, so it is "
            f"undecided which jumps first: shift one of the curves a little."
        )
    leads = parts[folds[0]][3][side]
    assert leads is not None
    return at, (*place[: folds[0]], leads, *place[folds[0] + 1 :])


def _sum(curves: list[Floats], low: float, high: float) -> Floats:
    """Rows of the sum of curves between two travels."""
    joints = np.unique(np.concatenate([curve[:, 0] for curve in curves]))
    near = 1e-9 * (high - low)
    inside = joints[(joints > low + near) & (joints < high - near)]
    starts = [low]
    for joint in inside.tolist():
        if joint - starts[-1] > near:
            starts.append(joint)
    rows = np.zeros((len(starts), 6))
    rows[:, 0] = starts
    middles = 0.5 * (rows[:, 0] + np.append(rows[1:, 0], high))
    for curve in curves:
        at = np.clip(np.searchsorted(curve[:, 0], middles, side="right") - 1, 0, len(curve) - 1)
        x = rows[:, 0] - curve[at, 0]
        c0, c1, c2, c3 = (curve[at, j] for j in range(1, 5))
        value, slope, bend = cubics.cubic(x, c0, c1, c2, c3)
        area = cubics.cubic_area(x, c0, c1, c2, c3, curve[at, 5])
        rows[:, 1:] += np.column_stack([value, slope, bend / 2.0, c3, area])
    return rows


def _refuse_unlike(elements: "Sequence[Element]") -> None:
    if len(elements) < 2:
        raise InputError(f"elements: {len(elements)} given: must be two or more in parallel.")
    first = elements[0].measure
    for k, element in enumerate(elements):
        if element.measure is not first:
            raise InputError(
                f"elements[{k}] has {element.measure.travel} and {element.measure.force}, the "
                f"first has {first.travel} and {first.force}: elements in parallel need one kind."
            )
