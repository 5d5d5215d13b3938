"""Whether the real one will do what the drawing does, and how many built with tolerances do."""

from __future__ import annotations

from typing import Any

from stepwell.accounts import account
from stepwell.design import USUAL, Tolerances, Yield, judged, yields
from stepwell.sequences import cycle
from stepwell.studio.wire import Ask, Design, View

LONG = True
_MOST = 1_000_000
# So many are made first, and no more where the engine has to follow each of them.
_FIRST = 1000


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell yield --json` prints, and the verdict that `stepwell check` gives.

    Of few mechanisms first, where it takes long.

    Without `samples` as many as by default, or fewer where each has to be followed.
    """
    tolerances = Tolerances(
        anchor=ask.number("anchor_mm", 0.0, 1e3, USUAL.anchor * 1e3) / 1e3,
        stiffness=ask.number("stiffness_percent", 0.0, 24.9, USUAL.stiffness * 100) / 100,
    )
    n = ask.whole("samples", 1, _MOST) if ask.has("samples") else None
    seed = ask.whole("seed", 0, 2**32 - 1, 0)
    ask.close()
    chain = design.chain
    tied = bool(cycle(chain).path.degenerate)
    if n is None:
        first = yields(chain, tolerances, n=_FIRST, seed=seed, progress=ask.tell)
        if first.by_engine > _FIRST // 10:
            return View(_told(first, tied))
        ask.show(View(_told(first, tied)))
    return View(_told(yields(chain, tolerances, n=n, seed=seed, progress=ask.tell), tied))


def _told(found: Yield, tied: bool) -> dict[str, Any]:
    verdict = judged(does_it=True, tied=tied, interval=found.interval)
    return {**account(found).record, "verdict": verdict}
