"""What a chain does in a full cycle: its samples, events, sequence, and margins."""

from __future__ import annotations

from stepwell.base import told_in
from stepwell.design import proved_margin
from stepwell.studio.panels.motions._drawn import (
    MJ,
    arrays_of,
    cells_of,
    drawn,
    events_of,
    landscape,
    margins_of,
    units_of,
)
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """The cycle, and how far the design is from another where that is known in closed form.

    Numbers of a chain of volumes or of angles stand under the same names; `units` has theirs.
    """
    ask.close()
    chain = design.chain
    cycle = chain.cycle()
    # A search takes a hundred times as long as all else here: panel `margin` does it aside.
    limits = proved_margin(chain)
    path = drawn(cycle.path)
    header = {
        "title": chain.title,
        "units": units_of(chain),
        "names": list(chain.names),
        "sequence": str(cycle.sequence),
        "pathway": "" if cycle.pathway is None else cycle.pathway.label,
        "cells": cells_of(chain),
        "events": events_of(cycle.events, path),
        **margins_of(limits),
        "peak_force_N": cycle.peak_force * told_in(chain.measure.force_unit)[1],
        "dissipated_mJ": cycle.dissipated * MJ,
        "full_stroke_mm": chain.full_stroke * told_in(chain.measure.travel_unit)[1],
        "ties": [tie.advice for tie in cycle.degenerate],
    }
    return View(header, arrays_of(path) | landscape(chain))
