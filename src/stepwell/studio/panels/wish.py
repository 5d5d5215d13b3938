"""A design for a wanted cycle, with its yield."""

from __future__ import annotations

from dataclasses import replace

from stepwell import files
from stepwell.base import InputError
from stepwell.design import USUAL, design as designed
from stepwell.results import design_record
from stepwell.studio.wire import Ask, Design, View

LONG = True
_LONGEST = 600
_MOST_CELLS = 8


def answer(_design: Design, ask: Ask) -> View:
    """The record that `stepwell design --json` prints, and the design to be shown."""
    sequence = ask.text("sequence", _LONGEST)
    anchor = ask.number("anchor_mm", 0.0, 1e3, USUAL.anchor * 1e3) / 1e3
    holes = ask.number("holes_mm", 0.1, 1e3) / 1e3 if ask.has("holes_mm") else None
    ask.close()
    if len(sequence.partition(">")[0].strip()) > _MOST_CELLS:
        raise InputError(
            f"ask.sequence = {sequence[:60]!r}: has too many cells: at most {_MOST_CELLS} are "
            f"placed here; `stepwell design` takes more."
        )
    tolerances = replace(USUAL, anchor=anchor)
    found = designed(sequence, holes=holes, tolerances=tolerances, progress=ask.tell)
    tables = files.tables_in(files.dumps(found.chain))
    return View({**design_record(found), "design": tables})
