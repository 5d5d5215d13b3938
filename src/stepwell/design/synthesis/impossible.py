"""What to say when nothing that is allowed does what is wanted."""

import math
from collections.abc import Sequence

import numpy as np

from stepwell.base import Floats, Measure, Shown, StepwellError
from stepwell.concave import TIED
from stepwell.design.orders import Target, short
from stepwell.design.synthesis.attempt import Attempt


class Impossible(Shown, StepwellError, ValueError):
    """What is wanted cannot be had within what is allowed; `str` of it says why.

    Attributes:
        wanted: as text.
        proved: True for a proof, which then covers all that is allowed, as it is drawn: no choice
            does it without a tie. False where something was not tried, and the text says what.
        region: the pairs (F0, F1) [N] that a cell can have: closed curves round them, or all of
            them where there are holes; empty where there are none, or none was looked at.
        largest_gap: the largest smallest gap between neighbours in the wanted orders of F0 and
            F1 that can be had, or was found where nothing is proved [N]: zero where two cells
            tie, less where they change places; NaN where there are no cells to compare.
        gap_needed: it would have to be more than this, or the engine finds a tie [N].
        measure: what the forces are.
    """

    def __init__(
        self,
        wanted: str,
        why: str,
        *,
        proved: bool,
        allowed: str = "",
        region: Sequence[Floats] = (),
        largest_gap: float = math.nan,
        gap_needed: float = math.nan,
        measure: Measure = Measure.TRAVEL,
    ):
        self.wanted, self.proved, self.measure = wanted, proved, measure
        self.region = tuple(region)
        self.largest_gap, self.gap_needed = largest_gap, gap_needed
        verdict = ("impossible" if proved else "not found") + (allowed and f" with {allowed}")
        super().__init__(f"{short(wanted)}: {verdict}: {why}.")


def nothing_works(
    target: Target, attempts: list[Attempt], missed: str, rest: str, allowed: str, *, proved: bool
) -> Impossible:
    """Why nothing does what is wanted.

    Args:
        target: what is wanted.
        attempts: to have the end forces in its orders.
        missed: what the engine finds of those that have them.
        rest: what else the engine has tried.
        allowed: where anchors may be, in words.
        proved: whether nothing was left out.
    """
    if not attempts:
        return Impossible(target.text, _with(target.wish.why, rest, proved), proved=proved)
    nearest = max(attempts, key=lambda attempt: attempt.quality[1])
    kind = "lattice places" if nearest.holes is None else "holes"
    region: Sequence[Floats] = ()
    largest = needed = math.nan
    if any(not len(table.q) for table in nearest.tables):
        # Elsewhere than on holes there may be a place between those looked at.
        why = (
            f"at none of the {kind} of some cell is the band proved taut with falling force and "
            f"weak enough for the actuator"
        )
        advice = "allow other places or another band, tighter tolerances or a stronger actuator"
    else:
        region = nearest.region()
        needed = TIED * max(float(np.max(np.abs(table.force))) for table in nearest.tables)
        if missed:
            largest = nearest.smallest_gap()
            does = missed if target.states is not None else f"does {missed}"
            why = (
                f"with F0 and F1 in the wanted orders the engine finds that it {does}, as can be "
                f"with unequal levers, or where a cell overtakes another in a snap"
            )
            advice = "allow equal_levers=True, other places or other levers"
        else:
            if nearest.holes is not None and all(attempt.complete for attempt in attempts):
                largest = nearest.largest_gap()
                nodes = sum(attempt.nodes for attempt in attempts)
                holes = f"{nearest.candidates} hole{'s' * (nearest.candidates != 1)}"
                how = f"none of all choices among {holes} and bands proved concave puts"
                found = f"complete search, {nodes} partial choices; the largest smallest gap is"
            else:
                largest = max(attempt.smallest_gap() for attempt in attempts)
                how = f"a search from {nearest.candidates} {kind} and bands has not put"
                found = "not a proof; the largest smallest gap found is"
            first, second = (
                " < ".join(str(cell + 1) for cell in order) for order in nearest.orders.rising
            )
            why = (
                f"{how} F0 in the order {first} and F1 in the order {second} of cells ({found} "
                f"{largest * 1e3:.4g} mN, and more than {needed * 1e3:.2g} mN is needed)"
            )
            advice = "allow more places or other bands"
    return Impossible(
        target.text,
        f"{_with(why, rest, proved)}: {advice}",
        proved=proved,
        allowed=allowed,
        region=region,
        largest_gap=largest,
        gap_needed=needed,
    )


def _with(why: str, rest: str, proved: bool) -> str:
    if rest:
        return f"{why}; {rest}, and none does it"
    return why if proved else f"{why}; other cells than these were not tried"
