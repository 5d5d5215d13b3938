"""The numbers of a robot that a study can vary, and between which values that is worth looking."""

from __future__ import annotations

from stepwell import files
from stepwell.studio.wire import Ask, Design, View

_SHARES = 0.8, 1.2


def answer(design: Design, ask: Ask) -> View:
    """Every number that is not 0, by its key, with its unit and a fifth to either side of it."""
    ask.close()
    found = [
        {
            "key": one.path,
            "label": one.path,
            "unit": one.unit,
            "value": one.values[0],
            "range": sorted(float(f"{one.values[0] * share:.3g}") for share in _SHARES),
        }
        for one in files.parameters(design.robot)
        if one.values[0]
    ]
    return View({"parameters": found})
