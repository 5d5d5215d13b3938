"""How far a design is from another sequence, where that has to be searched."""

from __future__ import annotations

from stepwell.design import margin
from stepwell.studio.panels.motions._drawn import margins_of
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The margins as panel `evaluate` tells them, by whatever it takes."""
    ask.close()
    return View(margins_of(margin(design.chain, progress=ask.tell)))
