"""What to say when nothing that is allowed does what is wanted."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stepwell.design._attempt import Attempt
from stepwell.design._candidates import TIE
from stepwell.design._full_cycle import short

Floats = NDArray[np.float64]


class Impossible(ValueError):
    """What is wanted cannot be had within what is allowed; `str` of it says why.

    Attributes:
        wanted: as text.
        proved: True for a proof; False where a search has only not found it.
        region: the pairs (F0, F1) [N] that a cell can have: closed curves round them, or all of
            them where there are holes; empty where there are none, or none was looked at.
        largest_gap: the largest smallest gap between neighbours in the wanted orders of F0 and
            F1 that can be had, or was found where nothing is proved [N]: zero where two cells
            tie, less where they change places; NaN where there are no cells to compare.
        gap_needed: it would have to be more than this, or the engine finds a tie [N].
    """

    def __init__(
        self,
        wanted: str,
        why: str,
        *,
        proved: bool,
        region: Sequence[Floats] = (),
        largest_gap: float = math.nan,
        gap_needed: float = math.nan,
    ):
        self.wanted, self.proved = wanted, proved
        self.region = tuple(region)
        self.largest_gap, self.gap_needed = largest_gap, gap_needed
        super().__init__(f"{short(wanted)}: {'impossible' if proved else 'not found'}: {why}.")


def nothing_works(wanted: str, attempts: list[Attempt], all_orders: bool) -> Impossible:
    """Why no attempt met its orders; `all_orders` if no others would do."""
    nearest = max(attempts, key=lambda attempt: attempt.quality[1])
    candidates = max(attempt.candidates for attempt in attempts)
    kind = "lattice places" if nearest.holes is None else "holes"
    if any(not len(table.q) for table in nearest.tables):
        # Elsewhere than on holes there may be a place between those looked at.
        return Impossible(
            wanted,
            f"at none of the {kind} of some cell is the band proved taut with falling force, for "
            f"all anchors within the tolerances, and weak enough for the actuator: allow other "
            f"places or another band, tighter tolerances or a stronger actuator",
            proved=nearest.holes is not None,
        )
    proved = nearest.holes is not None and all_orders and all(a.complete for a in attempts)
    force = np.concatenate([table.force for table in nearest.tables])
    needed = TIE * float(np.max(np.abs(force)))
    if proved:
        nodes = sum(attempt.nodes for attempt in attempts)
        largest = nearest.largest_gap()
        how = f"none of all choices among {candidates} usable holes and bands puts"
        found = f"complete search, {nodes} partial choices; the largest smallest gap is"
    else:
        largest = max(a.smallest_gap() for a in attempts)
        how = f"a search from {candidates} {kind} and bands has not put"
        found = "not a proof; the largest smallest gap found is"
    orders = nearest.orders
    return Impossible(
        wanted,
        f"{how} F0 in the order {_order(orders.rising[0])} and F1 in the order "
        f"{_order(orders.rising[1])} of cells ({found} {largest * 1e3:.4g} mN, and more than "
        f"{needed * 1e3:.2g} mN is needed): allow more places or other bands",
        proved=proved,
        region=nearest.region(),
        largest_gap=largest,
        gap_needed=needed,
    )


def engine_disagrees(wanted: str, attempt: Attempt, does: str) -> Impossible:
    """The orders are met, but the chain does something else."""
    return Impossible(
        wanted,
        f"with F0 and F1 in the wanted orders the engine finds {short(does)}, as can be with "
        f"unequal levers: allow equal_levers=True, or other levers",
        proved=False,
        region=attempt.region(),
        largest_gap=attempt.smallest_gap(),
    )


def _order(cells: tuple[int, ...]) -> str:
    return " < ".join(str(cell + 1) for cell in cells)
