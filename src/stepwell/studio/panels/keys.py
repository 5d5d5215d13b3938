"""Which numbers a chain and its cells may hold, for the page's fields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from stepwell.files.known import columns_of, known_keys, new_cells
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """The keys of the shown chain and of every cell, where points stand, and what can be added.

    It is asked of designs that are refused too, so that what was typed can be typed otherwise.
    """
    ask.close()
    tables = _tables(design)
    chain, cells = known_keys(*tables)
    listed = tables[0].get("cell") if cells else []
    return View(
        {
            "chain": [asdict(one) for one in chain],
            "cells": [[asdict(one) for one in cell] for cell in cells],
            "columns": [columns_of(cell) for cell in listed or ()],
            "new": new_cells(),
        }
    )


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
