"""The exact boundaries on the plane of two parameters, and how far the design is from them."""

from __future__ import annotations

from stepwell.studio.panels.inverse._plane import Plane, Unproved
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """Curves in units of the bench, the design's place, and the nearest other sequence.

    `aside` says that no closed form tells them all, and that panel `map_followed` looks for them.
    """
    plane = Plane.asked(design.chain, ask)
    ask.close()
    try:
        curves, aside = plane.proved_curves(), False
    except Unproved:
        curves, aside = (), True
    header, blocks = plane.told(curves)
    return View({"aside": aside, **header}, blocks)
