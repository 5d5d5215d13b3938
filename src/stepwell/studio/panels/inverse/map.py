"""What a chain does for all values of two of its parameters, where closed forms tell."""

from __future__ import annotations

from stepwell.studio.panels.inverse._plane import Plane, Unproved, pixels, unproved
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """An image of numbers into `sequences`, rows from low to high y.

    Where some places have to be followed one by one there is no image, and `aside` says that panel
    `map_followed` draws it.
    """
    plane = Plane.asked(design.chain, ask)
    wide, high = pixels(ask)
    ask.close()
    try:
        header, blocks = plane.painted(wide, high, unproved)
    except Unproved:
        return View({"aside": True})
    return View({"aside": False, **header}, blocks)
