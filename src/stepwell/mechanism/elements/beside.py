"""Elements side by side at one travel, as one element."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import Floats, InputError, require, told_in
from stepwell.mechanism.cubics import cubic, cubic_area
from stepwell.mechanism.elements.sheet import Sheet

if TYPE_CHECKING:
    from stepwell.mechanism.elements.element import Element

Place = tuple[int, ...]


def beside(elements: Sequence[Element]) -> tuple[tuple[Sheet, ...], tuple[bool, bool], float]:
    """Sheets, stops and friction of elements that share one travel."""
    _refuse_unlike(elements)
    reach = 2.0 * max(element.largest_force for element in elements)
    curves = [_curves(element, reach) for element in elements]
    start: Place = (0,) * len(elements)
    found: dict[Place, tuple[Floats, float, Place | None, Place | None]] = {}
    waiting, stops = [start], [False, False]
    while waiting:
        place = waiting.pop()
        if place in found:
            continue
        require("branches", len(found), "side by side the elements have")
        parts = [curve[sheet] for curve, sheet in zip(curves, place, strict=True)]
        low, below = _end(place, parts, 0, stops)
        high, above = _end(place, parts, 1, stops)
        if not low < high:
            unit, factor = told_in(elements[0].measure.travel_unit)
            raise InputError(
                f"elements share no travel where they should stand side by side: one begins at "
                f"{low * factor:.6g} {unit}, where another has ended at {high * factor:.6g} {unit}."
            )
        found[place] = _sum([part[0] for part in parts], low, high), high, below, above
        waiting += [other for other in (below, above) if other is not None]
    number = {place: k for k, place in enumerate(sorted(found))}
    sheets = [
        Sheet.of(
            rows,
            end,
            None if below is None else number[below],
            None if above is None else number[above],
        )
        for _, (rows, end, below, above) in sorted(found.items())
    ]
    return tuple(sheets), (stops[0], stops[1]), sum(element.friction for element in elements)


# Rows, the ends, whether the curve goes on there, whether it is stopped, and where it leads.
_Part = tuple[Floats, tuple[float, float], tuple[bool, bool], tuple[int | None, int | None]]


def _curves(element: Element, reach: float) -> list[_Part]:
    stopped = element.stopped
    parts: list[_Part] = []
    for sheet in element.laws:
        rows = sheet.extended(element.goes_on(sheet), -reach)
        goes_on = (
            sheet.below is None and not stopped[0],
            sheet.above is None and not stopped[1],
        )
        parts.append((rows, (sheet.begin, sheet.end), goes_on, (sheet.below, sheet.above)))
    return parts


def _end(
    place: Place, parts: list[_Part], side: int, stops: list[bool]
) -> tuple[float, Place | None]:
    """Where a common stretch ends on one side, and where it leads from there."""
    inwards = max if side == 0 else min
    bound = [k for k, part in enumerate(parts) if not part[2][side]]
    if not bound:
        outwards = min if side == 0 else max
        return outwards(part[1][side] for part in parts), None
    at = inwards(parts[k][1][side] for k in bound)
    ends = [k for k in bound if parts[k][1][side] == at]
    folds = [k for k in ends if parts[k][3][side] is not None]
    if len(folds) < len(ends):
        stops[side] = True
        return at, None
    if len(folds) > 1:
        raise InputError(
            f"elements {folds[0] + 1} and {folds[1] + 1} fold back at the same travel, so nothing "
            f"tells which jumps first: move one of them a little."
        )
    leads = parts[folds[0]][3][side]
    assert leads is not None
    return at, (*place[: folds[0]], leads, *place[folds[0] + 1 :])


def _sum(curves: list[Floats], low: float, high: float) -> Floats:
    """Rows of the sum of curves between two travels."""
    joints = np.unique(np.concatenate([curve[:, 0] for curve in curves]))
    near = 1e-9 * (high - low)
    inside = joints[(joints > low + near) & (joints < high - near)]
    kept = [low]
    for joint in inside.tolist():
        if joint - kept[-1] > near:
            kept.append(joint)
    rows = np.zeros((len(kept), 6))
    rows[:, 0] = kept
    middles = 0.5 * (rows[:, 0] + np.append(rows[1:, 0], high))
    for curve in curves:
        at = np.clip(np.searchsorted(curve[:, 0], middles, side="right") - 1, 0, len(curve) - 1)
        x = rows[:, 0] - curve[at, 0]
        c0, c1, c2, c3 = (curve[at, j] for j in range(1, 5))
        value, slope, bend = cubic(x, c0, c1, c2, c3)
        area = cubic_area(x, c0, c1, c2, c3, curve[at, 5])
        rows[:, 1:] += np.column_stack([value, slope, bend / 2.0, c3, area])
    return rows


def _refuse_unlike(elements: Sequence[Element]) -> None:
    if len(elements) < 2:
        raise InputError(f"elements: {len(elements)} given: side by side there are two or more.")
    first = elements[0].measure
    for k, element in enumerate(elements):
        if element.measure is not first:
            raise InputError(
                f"elements[{k}] has {element.measure.travel} and {element.measure.force}, the "
                f"first has {first.travel} and {first.force}: side by side all share one travel."
            )
