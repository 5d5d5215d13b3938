"""How far a design is from doing something else."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import REACH, ByValue, Floats
from stepwell.concave import SortedChain
from stepwell.design.margins.change import RESOLUTION, Change, stiffness
from stepwell.design.margins.displacements import Displacements
from stepwell.design.margins.nearest import nearest, sequence
from stepwell.design.margins.search import resolution
from stepwell.design.parameters import Parameter
from stepwell.design.plane import Method
from stepwell.design.tolerances import refuse_reach
from stepwell.mechanism import Chain

# Printed lines, and the longest chain whose sequences are printed with them.
_SHOWN = 6
_SHORT = 12


@dataclass(frozen=True, eq=False)
class Margin(ByValue):
    """How far a design is from another sequence, for every anchor and every stiffness.

    Attributes:
        changes: for every cell the smallest change of its anchor, then of its stiffness.
        gap: smallest difference of two F0 or of two F1 over k r of the innermost cell; NaN
            where the sequence is not a matter of F0 and F1 alone.
        method: exact where every change is in closed form, else a search.
        reach: farthest an anchor was moved [m].
        resolution: what a search can miss; empty where nothing was searched.
    """

    chain: Chain = field(repr=False)
    changes: tuple[Change, ...]
    gap: float
    method: Method
    reach: float
    resolution: str

    @property
    def anchors(self) -> Floats:
        """(N,) smallest displacement of each cell's anchor [m]."""
        return self._distances("anchor")

    @property
    def stiffness(self) -> Floats:
        """(N,) smallest relative change of each cell's stiffness [1]."""
        return self._distances("stiffness")

    def _distances(self, parameter: str) -> Floats:
        return np.array([c.distance for c in self.changes if c.parameter == parameter])

    def __str__(self):
        near = sorted(self.changes, key=lambda change: change.distance)
        lines: list[str] = []
        for change in near[:_SHOWN]:
            becomes = change.becomes if len(self.chain) <= _SHORT else ""
            lines.append(
                f"{self.chain.names[change.cell]}: {change}" + (f" -> {becomes}" if becomes else "")
            )
        if len(near) > _SHOWN:
            lines.append(f"and {len(near) - _SHOWN} more, less sensitive")
        if self.resolution:
            lines.append(f"searched, not exact: {self.resolution}")
        return "\n".join(lines)

    def __repr__(self):
        anchor, stiffness = float(np.min(self.anchors)), float(np.min(self.stiffness))
        far = f"more than {self.reach * 1e3:.4g} mm"
        anchors = far if math.isinf(anchor) else f"{anchor * 1e3:.4g} mm"
        stiff = "no change of stiffness" if math.isinf(stiffness) else f"{stiffness * 100:.4g} %"
        return f"Margin({self.method}: anchors {anchors}, stiffness {stiff}, gap {self.gap:.3g})"


def margin(
    chain: Chain,
    *,
    reach: float = REACH,
    progress: Callable[[int, int], None] | None = None,
) -> Margin:
    """How far each anchor and each stiffness may change before the sequence does.

    All else as for `Chain.margin`.
    """
    ways = Displacements.of(None, False, reach)
    refuse_reach(chain, reach)
    forces = SortedChain.of(chain)
    now = sequence(chain)
    changes: list[Change] = []
    for cell in range(len(chain)):
        if progress is not None:
            progress(2 * cell, 2 * len(chain))
        anchor = Parameter(f"{cell + 1}.q", cell, "q")
        found = nearest(chain, forces, now, anchor, None, ways)
        changes.append(Change(chain, cell, "anchor", *found))
        changes.append(stiffness(chain, forces, now, cell))
    if progress is not None:
        progress(2 * len(chain), 2 * len(chain))
    words = {
        "anchor": f"anchors {resolution(ways, small=False)}",
        "stiffness": f"stiffnesses {RESOLUTION}",
    }
    searched = {change.parameter for change in changes if change.method is Method.SEARCH}
    scale = chain.cells[0].bands[0].stiffness * chain.cells[0].lever
    return Margin(
        chain,
        tuple(changes),
        math.nan if forces is None else forces.smallest_gap() / scale,
        Method.SEARCH if searched else Method.EXACT,
        reach,
        "; ".join(words[parameter] for parameter in words if parameter in searched),
    )
