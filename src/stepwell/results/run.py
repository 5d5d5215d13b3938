"""Cycles and stroke programs as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stepwell.base import (
    Quantity,
    Schema,
    in_measure,
    record,
)
from stepwell.mechanism import Cell, Chain, Element

if TYPE_CHECKING:
    pass


def force_scale(cell: Cell) -> float:
    """k r [N] of a cell, with k of its stiffest band: what its forces are compared with."""
    return max(band.stiffness for band in cell.bands) * cell.lever


CELL: Schema = (
    Quantity("name", head="cell"),
    Quantity("F0", "N", "F0", "force_0"),
    Quantity("F1", "N", "F1", "force_1"),
    Quantity("F0", "over_kr", "F0/(kr)", lambda cell: cell.force_0 / force_scale(cell)),
    Quantity("F1", "over_kr", "F1/(kr)", lambda cell: cell.force_1 / force_scale(cell)),
    Quantity("full_travel", "mm", "travel"),
    Quantity("peak_angle", "deg", "peak"),
    Quantity("barrier", "mJ"),
    Quantity(
        "bistable", "", "stable", "is_bistable", lambda both: "both states" if both else "one state"
    ),
)
_ENDS = {
    (True, True): "both",
    (True, False): "at the low end",
    (False, True): "at the high end",
    (False, False): "none",
}


def cell_schema(chain: Chain) -> Schema:
    """What is told of the cells of a chain: all that holds of an element, where it has any."""
    unlike = len({cell.mobility for cell in chain.cells}) > 1
    mobility = Quantity("mobility", head="mobility" if unlike else "", left=False)
    if not chain.elements:
        return *CELL, mobility
    band = "±" if any(element.error_band for element in chain.elements) else ""
    sheets = "sheets" if _folds(chain) else ""
    schema = (
        Quantity("name", head="cell"),
        Quantity("phases", head="phases", read=lambda cell: len(cell.phases), left=False),
        Quantity("sheets", head=sheets, read=_sheets, left=False),
        Quantity("force_up", "N", "up at", lambda cell: [p.force_high for p in cell.phases[:-1]]),
        Quantity("force_down", "N", "down at", lambda cell: [p.force_low for p in cell.phases[1:]]),
        Quantity("travel_low", "mm", "from", "low"),
        Quantity("travel_high", "mm", "to", "high"),
        Quantity("full_travel", "mm"),
        Quantity("stopped", head="stops", form=lambda ends: _ENDS[*ends]),
        mobility,
        Quantity("error_band", "N", band, lambda cell: getattr(cell, "error_band", 0.0)),
        Quantity("bistable", read="is_bistable"),
        Quantity("stable", head="stable in", read=_stable, left=True),
    )
    return in_measure(schema, chain.measure)


def _folds(chain: Chain) -> bool:
    return any(len(element.laws) > 1 for element in chain.elements)


def _sheets(cell: Cell | Element) -> int:
    return len(cell.laws) if isinstance(cell, Element) else 1


def _stable(cell: Cell | Element) -> list[int]:
    """The phases in which a cell can stand without any force."""
    return [k for k, one in enumerate(cell.phases) if one.force_low < 0.0 < one.force_high]


def actuator_record(chain: Chain) -> dict[str, Any]:
    """What the actuator of a chain prescribes, and its stiffness."""
    stiffness = chain.actuator_stiffness
    control = "stroke" if math.isinf(stiffness) else "spring" if stiffness else "force"
    (told,) = in_measure([Quantity("stiffness", "N/m", read="actuator_stiffness")], chain.measure)
    return {"control": control, **record([told], chain)}
