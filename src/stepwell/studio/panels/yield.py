"""How many mechanisms built with tolerances do what the drawing does."""

from __future__ import annotations

from stepwell.design import USUAL, Tolerances, yields
from stepwell.results import yield_record
from stepwell.studio.wire import Ask, Design, View

LONG = True
_MOST = 1_000_000


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell yield --json` prints."""
    tolerances = Tolerances(
        anchor=ask.number("anchor_mm", 0.0, 1e3, USUAL.anchor * 1e3) / 1e3,
        stiffness=ask.number("stiffness_percent", 0.0, 24.9, USUAL.stiffness * 100) / 100,
    )
    n = ask.whole("samples", 1, _MOST) if ask.has("samples") else None
    seed = ask.whole("seed", 0, 2**32 - 1, 0)
    ask.close()
    return View(yield_record(yields(design.chain, tolerances, n=n, seed=seed, progress=ask.tell)))
