"""The parameters of a chain, and over which values it is worth looking at each."""

from __future__ import annotations

import math
from typing import Any

from stepwell.design import Parameter, parameters
from stepwell.mechanism import Cell, Chain
from stepwell.studio.panels.inverse._plane import key_of, unit_of
from stepwell.studio.wire import Ask, Design, View

# Of a lever: as far as an anchor is mapped to either side, which is the paper's box.
_REACH = 1.06
_WORDS = {
    "p.x": "x of p",
    "p.y": "y of p",
    "q.x": "x of q",
    "q.y": "y of q",
    "rest_length": "rest length",
    "limit": "largest angle",
    "force_scale": "force scale",
    "travel_scale": "travel scale",
}


def answer(design: Design, ask: Ask) -> View:
    """Every parameter that is a number, with its value and a range in the unit that is told."""
    ask.close()
    chain = design.chain
    return View({"parameters": [_told(chain, p) for p in parameters(chain) if not p.is_anchor]})


def _told(chain: Chain, parameter: Parameter) -> dict[str, Any]:
    unit, factor = unit_of(parameter)
    value = float(parameter.value(chain))  # type: ignore[arg-type]
    low, high = (end * factor for end in _range(chain, parameter, value))
    if parameter.cell is not None and "." in parameter.part:
        low, high = math.floor(low), math.ceil(high)
    else:
        low, high = _short(low), _short(high)
    of = "" if parameter.cell is None else chain.names[parameter.cell]
    word = _WORDS.get(parameter.part, parameter.part.replace("_", " "))
    return {
        "key": key_of(parameter),
        "cell": parameter.cell,
        "part": parameter.part,
        "label": f"{word} of {of}" if of else word,
        "unit": unit,
        "value": value * factor if math.isfinite(value) else None,
        "range": [low, high],
    }


def _range(chain: Chain, parameter: Parameter, value: float) -> tuple[float, float]:
    if parameter.cell is None:
        travel = max(cell.full_travel for cell in chain.cells)
        usual = max(map(_force, chain.cells)) / travel
        if 0 < value < math.inf:
            return value / 5, value * 5
        return 0.0 if value == 0 else usual / 10, usual * 10  # a given force, or a given stroke
    cell, part = chain.cells[parameter.cell], parameter.part
    if isinstance(cell, Cell) and "." in part:
        return value - _REACH * cell.lever, value + _REACH * cell.lever
    if part == "friction":
        return 0.0, max(2 * value, _force(cell) / 2)
    if part == "limit":
        return 0.6 * value, min(1.4 * value, math.radians(85))
    if part in ("force_scale", "travel_scale"):
        return value / 2, value * 2
    if not value and isinstance(cell, Cell):  # a band without a rest length
        return 0.0, cell.lever
    return value / 2, value * 1.5


def _force(cell: Any) -> float:
    """About what a cell needs."""
    if isinstance(cell, Cell):
        return max(abs(cell.force_0), abs(cell.force_1))
    return cell.largest_force


def _short(value: float) -> float:
    return float(f"{value:.3g}")
