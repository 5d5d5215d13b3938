"""What a chain does for all values of two parameters, where the engine follows place by place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from stepwell.design import Boundary
from stepwell.studio.panels.inverse._plane import Blocks, Plane, Unproved, pixels
from stepwell.studio.wire import Ask, Design, View

LONG = True
# Each is shown as soon as it is there; a place takes a millisecond or so.
_COARSE = 16, 8, 5, 2, 1
_MOST_FOLLOWED = 2000
# Nodes each way from which boundaries are bisected.
_SEARCH = 21

Known = tuple[dict[str, Any], Blocks, tuple[Boundary, ...]]
# Of the last plane: while the design moves on it, nothing has to be followed again.
_known: dict[Plane, Known] = {}


def answer(design: Design, ask: Ask) -> View:
    """As panels `map` and `border` together, coarser: `coarse` says how many pixels stand as one.

    The coarsest image comes first, and curves with the last.
    """
    plane = Plane.asked(design.chain, ask)
    wide, high = pixels(ask)
    ask.close()
    key = replace(plane, here=(0.0, 0.0))
    if key not in _known:
        found = _found(plane, wide, high, ask)
        _known.clear()
        _known[key] = found
    header, blocks, curves = _known[key]
    told, lines = plane.told(curves)
    return View({**header, **told}, blocks | lines)


def _found(plane: Plane, wide: int, high: int, ask: Ask) -> Known:
    def few(done: float, total: float) -> None:
        if total > _MOST_FOLLOWED:
            raise Unproved(f"{total:.0f} places have to be followed one by one.")
        ask.tell(done, max(total, 1))

    header: dict[str, Any] = {}
    blocks: Blocks = {}
    for coarse in _COARSE:
        size = max(2, -(-wide // coarse)), max(2, -(-high // coarse))
        try:
            found, blocks = plane.painted(*size, few)
        except Unproved:
            break
        header = {"coarse": coarse, **found}
        ask.show(View({**header, **plane.told(())[0]}, blocks))
    return header, blocks, plane.curves(_SEARCH, ask.tell)
