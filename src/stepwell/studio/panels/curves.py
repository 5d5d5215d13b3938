"""The curves of the elements of a chain, force against travel."""

from __future__ import annotations

import numpy as np

from stepwell.base import told_in
from stepwell.mechanism import Element
from stepwell.studio.panels.evaluate import units_of
from stepwell.studio.wire import Ask, Design, View

_POINTS = 121


def answer(design: Design, ask: Ask) -> View:
    """Samples of every element's curve in the units of `units`; `segment` counts its sheets."""
    ask.close()
    chain = design.chain
    rows: list[np.ndarray] = [np.empty((0, 4))]
    for i, cell in enumerate(chain.cells):
        if isinstance(cell, Element):
            for k, sheet in enumerate(cell.laws):
                travel = np.linspace(sheet.begin, sheet.end, _POINTS)
                force = cell.force_at(travel, k)
                rows.append(np.column_stack([np.full((_POINTS, 2), (i, k)), travel, force]))
    cell, segment, travel, force = np.concatenate(rows).T
    measure = chain.measure
    return View(
        {"units": units_of(chain)},
        {
            "cell": cell.astype(int),
            "segment": segment.astype(int),
            "travel": travel * told_in(measure.travel_unit)[1],
            "force": force * told_in(measure.force_unit)[1],
        },
    )
