"""Margin of a design: the smallest change of one anchor or number that changes the sequence."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import REACH, ByValue, Drawn, Floats, Progress, to_unit, tracked
from stepwell.concave import SortedChain
from stepwell.design.margins import numbers
from stepwell.design.margins.nearest import Aim, nearest, nearest_proved, sequence
from stepwell.design.margins.search import Displacements, resolution
from stepwell.design.parameters import Parameter, of_cell
from stepwell.design.plane import Method
from stepwell.design.tolerances.draws import refuse_reach
from stepwell.mechanism import Cell, Chain, Element
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    from stepwell.design.tolerances.draws import Tolerances
    from stepwell.proof import MarginProof

# Longest chain whose sequence after each change is always computed, which takes a cycle.
LONGEST_FOLLOWED = 12


@dataclass(frozen=True, eq=False, repr=False)
class Change(ByValue):
    """The smallest change of one parameter of one cell that changes the sequence.

    Attributes:
        chain: the nominal design.
        cell: the cell of the parameter, 0 the innermost.
        parameter: "anchor" (q on the outer block; moving p the opposite way is the same) or
            "stiffness" (of all bands); for an element "force_scale", "travel_scale" or "friction".
        distance: size of the change [m], or as a fraction of the number (for friction, of the
            element's largest force); infinite if no change within reach changes the sequence.
        move: displacement (dx, dy) of the anchor [m], or the signed fraction; NaN if infinite.
        past: a slightly larger change, after which the sequence is another one.
        method: exact, or a search.
    """

    chain: Chain = field(repr=False)
    cell: int
    parameter: str
    distance: float
    move: tuple[float, float] | float
    past: tuple[float, float] | float = field(repr=False)
    method: Method

    @property
    def design(self) -> Chain | None:
        """The chain just past the change; None if there is no change."""
        if np.isinf(self.distance):
            return None
        if isinstance(self.past, tuple):
            return of_cell(self.chain, self.cell, "q").displaced(self.chain, self.past)
        number = of_cell(self.chain, self.cell, self.parameter)
        return numbers.changed_by(self.chain, number, self.past)

    @cached_property
    def becomes(self) -> str:
        """The simulated sequence just past the change; empty if there is no change."""
        if self.design is None:
            return ""
        try:
            return str(cycle(self.design).sequence)
        except StaticsError as failure:
            return f"no answer: {failure}"

    def __str__(self):
        if np.isinf(self.distance):
            return f"{self.parameter}: none within reach"
        if isinstance(self.move, tuple):
            x, y = self.move
            return (
                f"anchor: {to_unit(self.distance, 'mm'):.4g} mm "
                f"(move q by ({to_unit(x, 'mm'):+.4g}, {to_unit(y, 'mm'):+.4g}) mm)"
            )
        of = " of the largest force" if self.parameter == "friction" else ""
        return f"{self.parameter}: {self.move * 100:+.4g} %{of}"


def number_change(
    chain: Chain, forces: SortedChain | None, now: Sequence, cell: int, part: str
) -> Change:
    """The smallest change of a number of a cell, for all its bands, that changes the sequence."""
    number = Parameter(f"{cell + 1}.{part}", cell, part, chain.measure)
    return Change(chain, cell, part, *numbers.nearest_share(chain, forces, str(now), number))


# Printed lines, and the longest chain whose sequences are printed with them.
_SHOWN = 6
_SHORT = 12


@dataclass(frozen=True, eq=False)
class Margin(ByValue, Drawn):
    """Smallest changes of every anchor and every stiffness that change the sequence.

    Attributes:
        changes: for every cell the smallest change of its anchor, then of its stiffness; for every
            element of all its forces, of all its travels, and of its friction.
        gap: smallest difference of two F0 or of two F1 over k r of the innermost cell; NaN
            if F0 and F1 alone do not decide the sequence.
        method: exact if every change is in closed form, else a search.
        reach: largest displacement of an anchor that was tried [m].
        resolution: resolution of the search; empty if nothing was searched.
    """

    chain: Chain = field(repr=False)
    changes: tuple[Change, ...]
    gap: float
    method: Method
    reach: float
    resolution: str

    @property
    def anchors(self) -> Floats:
        """Smallest displacement of the anchor of each lever cell [m]."""
        return self._distances("anchor")

    @property
    def stiffness(self) -> Floats:
        """Smallest relative change of the stiffness of each lever cell [1]."""
        return self._distances("stiffness")

    def prove(
        self, tolerances: "Tolerances | None" = None, progress: Progress = None
    ) -> "MarginProof":
        """Prove that no change of one parameter below its margin alters the sequence.

        Needs python-flint, the extra `proof`.

        Args:
            tolerances: prove the sequence for all machines within them too.
            progress: called with (done, total) changes.

        Raises:
            ValueError: tolerances of mobilities, which no proof covers.
            ExtraError: python-flint is not installed.

        Source: ours (theory page, "Proofs within tolerances").
        """
        from stepwell import proof

        return proof.prove_margin(self, tolerances, progress)

    def _distances(self, parameter: str) -> Floats:
        return np.array([c.distance for c in self.changes if c.parameter == parameter])

    def __str__(self):
        near = sorted(self.changes, key=lambda change: change.distance)
        lines: list[str] = []
        for change in near[:_SHOWN]:
            becomes = change.becomes if len(self.chain) <= _SHORT else ""
            then = f" -> {becomes}" if becomes else ""
            lines.append(f"{self.chain.names[change.cell]}: {change}{then}")
        if len(near) > _SHOWN:
            lines.append(f"and {len(near) - _SHOWN} more, less sensitive")
        if self.resolution:
            lines.append(f"searched, not exact: {self.resolution}")
        return "\n".join(lines)

    def __repr__(self):
        parts: list[str] = []
        for parameter in dict.fromkeys(change.parameter for change in self.changes):
            least = float(np.min(self._distances(parameter)))
            if parameter == "anchor":
                beyond = "more than " * math.isinf(least)
                parts.append(f"anchors {beyond}{to_unit(min(least, self.reach), 'mm'):.4g} mm")
            else:
                words = parameter.replace("_", " ")
                far = f"no change of {words}" if math.isinf(least) else f"{least * 100:.4g} %"
                parts.append(f"{words} {far}")
        return f"Margin({self.method}: {', '.join(parts)}, gap {self.gap:.3g})"


def margin(chain: Chain, *, reach: float = REACH, progress: Progress = None) -> Margin:
    """Smallest change of each anchor and each stiffness that changes the sequence.

    All else as for `Chain.margin`.
    """
    ways = Displacements.of(None, False, reach)
    refuse_reach(chain, reach)
    forces = SortedChain.of(chain)
    now = sequence(chain)
    changes: list[Change] = []
    asked = [(cell, part) for cell, one in enumerate(chain.cells) for part in _parts(one)]
    for cell, part in tracked(asked, progress):
        if part == "anchor":
            anchor = Parameter(f"{cell + 1}.q", cell, "q")
            nearest_change = nearest(Aim(chain, now, anchor, None), forces, ways)
            changes.append(Change(chain, cell, part, *nearest_change))
        else:
            changes.append(number_change(chain, forces, now, cell, part))
    return _assembled_margin(chain, forces, changes, ways)


def proved_margin(chain: Chain) -> Margin | None:
    """The result of `margin` if closed forms prove all of it; None if it needs a search."""
    forces = SortedChain.of(chain)
    if forces is None:
        return None
    changes: list[Change] = []
    for cell, numbers_of in enumerate(forces.cells):
        neighbours = tuple(forces.neighbours(cell))
        nearest_change = nearest_proved(numbers_of, neighbours, len(chain) == 1, REACH)
        if nearest_change is None:
            return None
        changes.append(Change(chain, cell, "anchor", *nearest_change))
        changes.append(Change(chain, cell, "stiffness", *numbers.share_of_stiffness(neighbours)))
    return _assembled_margin(chain, forces, changes, Displacements.of(None, False, REACH))


def _assembled_margin(
    chain: Chain, forces: SortedChain | None, changes: list[Change], ways: Displacements
) -> Margin:
    travel, _, force = chain.measure.words
    parts = {
        "stiffness": "stiffnesses",
        "force_scale": f"scales of {force}",
        "travel_scale": f"scales of {travel}",
        "friction": "friction",
    }
    words = {"anchor": f"anchors {resolution(ways, small=False)}"}
    words |= {part: f"{name} {numbers.resolution(part, force)}" for part, name in parts.items()}
    searched = {change.parameter for change in changes if change.method is Method.SEARCH}
    gap = math.nan
    if forces is not None:
        first = forces.cells[0]
        gap = forces.smallest_gap() / (first.stiffness * first.lever)
    return Margin(
        chain,
        tuple(changes),
        gap,
        Method.SEARCH if searched else Method.EXACT,
        ways.reach,
        "; ".join(words[parameter] for parameter in words if parameter in searched),
    )


def _parts(cell: Cell | Element) -> tuple[str, ...]:
    if isinstance(cell, Element):
        return "force_scale", "travel_scale", "friction"
    return "anchor", "stiffness"
