"""The claim that the approach extends to more cells: how many, for what workshop."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from stepwell.design import Design, Tolerances, design
from stepwell.paper.claims import Finding, claim, judged
from stepwell.sequences import Sequence

ANCHORS = (0.0001, 0.0003, 0.001)  # tolerances [m]
SPREAD = 0.05  # of the bands' stiffness
WANTED = 0.99
# Of the paper's claim, more cells than it built.
BUILT = 2
_MOST = 32
_TRIED, _MADE = 20_000, 1_000_000


def sequenced(cells: int, tolerances: Tolerances, n: int) -> Design:
    """Anchors for the cycle that goes back the way it came: last in, first out."""
    cycle = Sequence.full_cycle(range(cells), reversed(range(cells)))
    return design(str(cycle), tolerances=tolerances, n=n)


def programmable(cells: int, tolerances: Tolerances, n: int) -> Design:
    """Anchors for a chain that its turning points bring to every state.

    Proved where of every two cells the one that loads first unloads first, which this cycle says;
    so what makes it counts (theory page, "Stroke programs").
    """
    cycle = Sequence.full_cycle(range(cells), range(cells))
    return design(str(cycle), tolerances=tolerances, n=n)


@cache
def most_cells(make: Callable[[int, Tolerances, int], Design], anchor: float) -> Design:
    """The longest chain of which 99 % work, surely: the lower end of the 95 % interval says so.

    Longer chains have smaller gaps, so the answer is bracketed by doubling and bisection.
    """
    tolerances = Tolerances(anchor=anchor, stiffness=SPREAD)

    def works(cells: int) -> Design | None:
        # A first look with few mechanisms; only a close call is worth a million.
        found = make(cells, tolerances, _TRIED)
        if abs(found.yield_.share - WANTED) < 0.005:
            found = make(cells, tolerances, _MADE)
        return found if found.yield_.interval[0] >= WANTED else None

    best = works(BUILT)
    assert best is not None
    low, high = BUILT, 2 * BUILT
    while high <= _MOST and (longer := works(high)) is not None:
        low, high, best = high, 2 * high, longer
    while high - low > 1:
        middle = (low + high) // 2
        if (found := works(middle)) is None:
            high = middle
        else:
            low, best = middle, found
    return best


def _extends(make: Callable[[int, Tolerances, int], Design]) -> Finding:
    found = [most_cells(make, anchor) for anchor in ANCHORS]
    counts = [len(one.chain) for one in found]
    each = ", ".join(
        f"{count} cells (anchors ±{anchor * 1e3:g} mm, {100 * one.yield_.share:.2f} %)"
        for count, anchor, one in zip(counts, ANCHORS, found, strict=True)
    )
    return judged(
        min(counts) > BUILT,
        each,
        note=f"The paper's cell and band, q in the paper's box, band stiffness spread "
        f"{100 * SPREAD:g} %; the longest chain that `design` found of which {100 * WANTED:g} % "
        f"work. A better design may exist, so these are floors; how surely other cycles are made "
        f"tells `docs/any-cycle.md`.",
        otherwise="No longer chain than the paper's was found.",
    )


@claim("Conclusion", "more than two, no number", "more than two")
def more_cells_sequenced() -> Finding:
    """The approach extends to more cells: as many can be sequenced, in one order and back."""
    return _extends(sequenced)


@claim("Conclusion", "more than two, no number", "more than two")
def more_cells_programmable() -> Finding:
    """The approach extends to more cells: as many can be brought to every state."""
    return _extends(programmable)


CLAIMS = (more_cells_sequenced, more_cells_programmable)
