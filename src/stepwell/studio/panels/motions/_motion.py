"""A motion with all that is to be seen of it, as one view."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stepwell.accounts import assumptions
from stepwell.base import Ints, __version__, told_in
from stepwell.design import Margin, margin
from stepwell.mechanism import Chain, phase_at
from stepwell.sequences import Cycle, Program
from stepwell.statics import Path
from stepwell.studio.panels.motions._drawn import (
    MJ,
    arrays_of,
    cells_of,
    drawn,
    events_of,
    landscape,
    margins_of,
    program_told,
    units_of,
)
from stepwell.studio.wire import View


def motion_of(
    result: Chain | Cycle | Program,
    known: Margin | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> View:
    """The full cycle of a chain with its margins, or a program with its windows.

    Args:
        result: what moves; a cycle is not computed again.
        known: the margins of a chain, where they have been found already.
        progress: called with (done, total) while margins are searched.
    """
    if isinstance(result, Program):
        return _view(
            result.chain, result.path, {**margins_of(None), "program": program_told(result)}
        )
    cycle = result.cycle() if isinstance(result, Chain) else result
    found = {
        "program": None,
        "sequence": str(cycle.sequence),
        "pathway": "" if cycle.pathway is None else cycle.pathway.label,
        "ties": [tie.advice for tie in cycle.degenerate],
        **margins_of(margin(cycle.chain, progress=progress) if known is None else known),
    }
    return _view(cycle.chain, cycle.path, found)


def _view(chain: Chain, path: Path, found: dict[str, Any]) -> View:
    few = drawn(path)
    header = {
        "title": chain.title,
        "version": __version__,
        "units": units_of(chain),
        "cells": cells_of(chain),
        "events": events_of(path.events, few),
        "peak_force_N": path.peak_force * told_in(chain.measure.force_unit)[1],
        "dissipated_mJ": path.dissipated * MJ,
        "assumptions": assumptions(chain),
        **found,
    }
    return View(header, arrays_of(few) | landscape(chain) | {"phase": _phases(few)})


def _phases(path: Path) -> Ints:
    """(n, N) the phase of every cell at every sample; -1 in transit."""
    columns = zip(path.chain.stretches, path.sheet.T, path.travel.T, strict=True)
    found = [
        [phase_at(own, on, s) for on, s in zip(sheet.tolist(), travel.tolist(), strict=True)]
        for own, sheet, travel in columns
    ]
    return np.array([[-1 if one == "-" else int(one) for one in cell] for cell in found]).T
