"""Which numbers a chain and its cells may hold, and the curves of its elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from stepwell.base import StepwellError, told_in
from stepwell.files import columns_of, known_keys, new_cells
from stepwell.mechanism import Chain, Element
from stepwell.studio.panels.motions._drawn import units_of
from stepwell.studio.wire import Ask, Design, View

_POINTS = 121


def answer(design: Design, ask: Ask) -> View:
    """The keys of the shown chain and of every cell, what can be added, and samples of curves.

    It is asked of designs that are refused too, so that what was typed can be typed otherwise;
    those have no curves, and `units` is null.
    """
    ask.close()
    tables = _tables(design)
    chain, cells = known_keys(*tables)
    header = {
        "chain": [asdict(one) for one in chain],
        "cells": [[asdict(one) for one in cell] for cell in cells],
        "columns": [columns_of(cell) for cell in tables[0]["cell"]] if cells else [],
        "new": new_cells(),
    }
    try:
        made = design.chain
    except StepwellError:
        # Where there are no cells, there is nothing to be typed either.
        if not cells:
            raise
        return View({**header, "units": None})
    return View({**header, "units": units_of(made)}, _curves(made))


def _curves(chain: Chain) -> dict[str, np.ndarray[Any, Any]]:
    """Samples of every element's curve, sheet by sheet."""
    rows: list[np.ndarray[Any, Any]] = [np.empty((0, 4))]
    for i, cell in enumerate(chain.cells):
        if isinstance(cell, Element):
            for k, sheet in enumerate(cell.laws):
                travel = np.linspace(sheet.begin, sheet.end, _POINTS)
                force = cell.force_at(travel, k)
                rows.append(np.column_stack([np.full((_POINTS, 2), (i, k)), travel, force]))
    of, segment, travel, force = np.concatenate(rows).T
    return {
        "cell": of.astype(int),
        "segment": segment.astype(int),
        "travel": travel * told_in(chain.measure.travel_unit)[1],
        "force": force * told_in(chain.measure.force_unit)[1],
    }


def _tables(design: Design) -> tuple[Mapping[str, Any], Mapping[str, Any] | None]:
    """The table that holds the cells, and that which legs share."""
    tables = design.tables or {}
    common, legs = _table(tables.get("chain")), tables.get("leg")
    if not isinstance(legs, list):
        return common, None
    leg: Any = legs[design.leg] if design.leg < len(legs) else {}
    own = _table(_table(leg).get("chain"))
    return (own, common) if "cell" in own else (common, {})


def _table(found: Any) -> Mapping[str, Any]:
    return found if isinstance(found, Mapping) else {}
