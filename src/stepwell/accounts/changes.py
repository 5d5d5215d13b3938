"""The smallest changes after which a chain does something else."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from stepwell.accounts.shape import Shape
from stepwell.base import Measure, Quantity, Schema, number, signed
from stepwell.design import LONGEST_FOLLOWED

if TYPE_CHECKING:
    from stepwell.design import Change

# A change of this many mm, or of a tenth of it in percent, is no change.
_NO_CHANGE = 1e-6


def change_schema(shape: Shape) -> Schema:
    """A change of an anchor in mm, or of a number in percent; the other unit has null."""
    anchors = (
        Quantity("distance", "mm", read=lambda one: one.distance if _of_anchor(one) else None),
        Quantity(
            "move",
            "mm",
            read=lambda one: one.move if _of_anchor(one) else None,
            holds=[float],
            missing=True,
        ),
    )
    return (
        Quantity("cell", holds=int),
        Quantity("parameter", head="what"),
        Quantity("method"),
        *(anchors if shape.levers else ()),
        Quantity("distance", "percent", read=lambda one: None if _of_anchor(one) else one.distance),
        Quantity("move", "percent", read=lambda one: None if _of_anchor(one) else one.move),
        Quantity("becomes", head="sequence past it", read=_becomes, missing=True),
    )


def _of_anchor(change: Change) -> bool:
    return change.parameter == "anchor"


def _becomes(change: Change) -> str | None:
    # It takes a cycle: of longer chains the distances alone are reported.
    return change.becomes or None if len(change.chain) <= LONGEST_FOLLOWED else None


def distance_words(change: Change) -> str:
    """How far a change is, in mm or percent."""
    if math.isinf(change.distance):
        return "none within reach" if _of_anchor(change) else "none"
    if _of_anchor(change):
        return f"{number(change.distance * 1e3)} mm"
    return f"{number(change.distance * 1e2)} %"


def part_words(parameter: str, measure: Measure) -> str:
    """What of a cell is changed, in a word or two."""
    return {
        "anchor": "anchor q",
        "stiffness": "stiffness",
        "force_scale": f"{measure.force}s",
        "travel_scale": f"{measure.travel}s",
        "friction": "friction",
    }[parameter]


def critical_words(change: Change) -> str:
    """The change that breaks a design first, and what the design does past it."""
    chain, part = change.chain, change.parameter
    name, what = chain.names[change.cell], part_words(part, chain.measure)
    if change.distance * (1e3 if _of_anchor(change) else 1e5) < _NO_CHANGE:
        return "any change at all decides what it does"
    if isinstance(change.move, tuple):
        far, way = number(change.distance * 1e3, 3), _sides(*change.move)
        told = f"{what} of {name} {far} mm {way}"
    else:
        of = f" of its largest {chain.measure.force}" * (part == "friction")
        told = f"{name}'s {what}: {signed(float(f'{change.move * 1e2:.3g}'))} %{of}"
    becomes = _becomes(change)
    return f"{told} breaks it" + (f": then {becomes}" if becomes else "")


def _sides(x: float, y: float) -> str:
    """Where an anchor goes, (x, y) [m], as it is seen on a drawing."""
    size = max(abs(x), abs(y))
    ways = [(x, "to the right" if x > 0 else "to the left"), (y, "up" if y > 0 else "down")]
    kept = [(abs(v) * 1e3, way) for v, way in ways if abs(v) > 0.02 * size]
    if len(kept) == 1:
        return kept[0][1]
    return "(" + " and ".join(f"{number(v, 3)} {way}" for v, way in kept) + ")"
