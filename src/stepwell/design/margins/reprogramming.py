"""The smallest displacement of an anchor that makes a chain do something else."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence as Sized
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import REACH, ByValue, Quantity, Schema, variables, write_csv
from stepwell.concave import SortedChain
from stepwell.design.margins import by_engine, search as _hunt
from stepwell.design.margins.displacements import Floats, Ways
from stepwell.design.margins.nearest_places import Condition, nearest_places
from stepwell.design.margins.resistance import Push
from stepwell.design.orders import full_cycle
from stepwell.design.parameters import Knob, knob
from stepwell.design.tolerances import refuse_reach
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    import xarray

Vec2 = tuple[float, float]

# How far past the rim a chain is looked at [m]: far enough to leave no tie, near enough that
# nothing else has changed. The smaller ones are for regions that are narrower.
_HAIRS = (1e-8, 1e-9, 1e-10)
# The way of the anchor, at every fraction of it.
WAY: Schema = (
    Quantity("fraction", read="push.fraction"),
    Quantity("x", "mm", "x", lambda found: found.along(0), doc="displacement along x"),
    Quantity("y", "mm", "y", lambda found: found.along(1), doc="displacement along y"),
    Quantity(
        "force_0",
        "N",
        "at state 0",
        "push.force_0",
        doc="force against the displacement at state 0",
    ),
    Quantity(
        "force_1",
        "N",
        "at state 1",
        "push.force_1",
        doc="force against the displacement at state 1",
    ),
    Quantity(
        "peak",
        "N",
        "largest",
        "push.peak",
        doc="largest force against the displacement over the travel",
    ),
)


@dataclass(frozen=True, eq=False)
class Reprogramming(ByValue):
    """The smallest displacement of one anchor after which a chain does what is wanted.

    Attributes:
        chain: the design as it is.
        target: the sequence wanted; None for any other than now.
        by: the anchor, such as "inner.p".
        displacement: (dx, dy) of the anchor [m]; NaN where there is none within reach, zero
            where the chain does it already.
        distance: its length [m]; infinite where there is none within reach.
        reach: farthest displacement that was looked at [m].
        chain_after: the design a hair further on, where it does it; None if nowhere.
        before, after: the sequences as it is and a hair past, by the engine; `after` is empty
            where there is none.
        method: "exact" (closed form, to rounding) or "search".
        resolution: what a search can miss; empty where nothing was searched.
    """

    chain: Chain = field(repr=False)
    target: str | None
    by: str
    displacement: Vec2
    distance: float
    reach: float
    chain_after: Chain | None = field(repr=False)
    before: str
    after: str
    method: str
    resolution: str

    @property
    def cell(self) -> int:
        """The cell whose anchor it is, 0 the innermost."""
        number = knob(self.chain, self.by).cell
        assert number is not None
        return number

    @property
    def anchor(self) -> str:
        """Which of its anchors: "p" on the inner block or "q" on the outer one."""
        return knob(self.chain, self.by).part

    @property
    def place(self) -> Vec2:
        """Where the anchor has to be (of the cell's first band) [m]; NaN if nowhere."""
        x, y = getattr(self.chain.cells[self.cell].bands[0], self.anchor)
        return x + self.displacement[0], y + self.displacement[1]

    @cached_property
    def push(self) -> Push:
        """The force of the cell's bands against the displacement, from here to there."""
        if math.isinf(self.distance):
            return Push.nowhere()
        return Push.of(self.chain.cells[self.cell], self.anchor, self.displacement)

    def along(self, axis: int) -> Floats:
        """How far the anchor is on its way along x (0) or y (1) at every fraction of it [m]."""
        return self.push.fraction * self.displacement[axis]

    def to_xarray(self) -> xarray.Dataset:
        """The way as an xarray.Dataset over the fraction gone, units in the attributes."""
        import xarray

        return xarray.Dataset(
            variables(WAY[1:], self, "fraction"),
            {"fraction": self.push.fraction},
            {
                "title": self.chain.title or "reprogramming",
                "by": self.by,
                "before": self.before,
                "after": self.after,
                "distance_m": self.distance,
                "method": self.method,
                "work_0_J": self.push.work_0,
                "work_1_J": self.push.work_1,
            },
        )

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the way as CSV, units in the column names (mm, N)."""
        write_csv(file, ((q, q.of(self)) for q in WAY))

    def __str__(self):
        if math.isinf(self.distance):
            wanted = self.target or "another sequence"
            return (
                f"no displacement of {self.by} up to {self.reach * 1e3:.4g} mm makes it {wanted} "
                f"({self.method})"
            )
        if self.distance == 0 and self.after == self.before:
            return f"it does {self.before} already"
        x, y = (f"{part * 1e3:+.4g}" for part in self.displacement)
        lines = [
            f"move {self.by} by ({x}, {y}) mm, {self.distance * 1e3:.4g} mm: {self.before} -> "
            f"{self.after} ({self.method})",
            str(self.push),
        ]
        if self.resolution:
            lines.append(f"searched, not exact: {self.resolution}")
        return "\n".join(lines)

    def __repr__(self):
        return f"Reprogramming({'; '.join(str(self).splitlines()[:2])})"


def reprogram(
    chain: Chain,
    target: str | Sequence | None,
    by: str,
    *,
    along: Sized[float] | None = None,
    one_way: bool = False,
    reach: float = REACH,
    progress: Callable[[int, int], None] | None = None,
) -> Reprogramming:
    """The smallest displacement of one anchor after which a chain does what is wanted.

    Where all cells are proved concave under a rigid actuator and share one full travel, the
    sequence is the order of the end forces: the wanted one is a region of the anchor's plane
    between curves of constant F0 and F1, whose nearest point is found to rounding. That is the
    answer where the proof holds for every displacement up to it; otherwise the engine is asked
    as well, and the answer says "search".

    Args:
        chain: any number of cells.
        target: a full cycle such as "00>01>11>10>00", or None for any other than now.
        by: the anchor: "<cell>.p" on the inner block or "<cell>.q" on the outer one, of all
            bands of the cell; <cell> is a name or a number, 1 for the innermost.
        along: (dx, dy), a line that the anchor keeps to; anywhere in the plane by default.
        one_way: only in the sense of `along`, not against it.
        reach: largest displacement that is looked at [m].
        progress: called with (done, total) places while the engine is asked.

    Returns:
        The displacement, the design just past it, and what has to push the anchor on the way.
        Infinite where nothing within reach does it.

    Raises:
        ValueError: a target that is no full cycle of this chain, no anchor of that name, no
            direction, or no reach.
        StaticsError: the chain as it is cannot be followed.

    Source: sorting theorem, theory page; after Kamp et al. 2024, Fig. 4.
    """
    anchor = knob(chain, by)
    if not anchor.is_anchor or anchor.cell is None:
        raise ValueError(
            f"by = {by!r}: must be an anchor, for example {chain.names[0] + '.p'!r} or "
            f"{chain.names[-1] + '.q'!r}."
        )
    ways = Ways.of(along, one_way, reach)
    refuse_reach(chain, reach)
    wanted = None if target is None else _parsed(str(target), len(chain))
    before = cycle(chain).sequence
    text = None if wanted is None else str(wanted)

    def answer(
        u: Floats | None, past: Floats | None, method: str, resolution: str = ""
    ) -> Reprogramming:
        common = (chain, text, anchor.name)
        if u is None or past is None:
            none = (math.nan, math.nan)
            rest = (None, str(before), "", method, resolution)
            return Reprogramming(*common, none, math.inf, ways.reach, *rest)
        after = _moved(chain, anchor, ways.move(past))
        rest = (after, str(before), str(cycle(after).sequence), method, resolution)
        distance = float(np.linalg.norm(u))
        return Reprogramming(*common, ways.move(u), distance, ways.reach, *rest)

    def does(u: Floats) -> bool:
        try:
            done = by_engine.sequence(_moved(chain, anchor, ways.move(u)))
        except (ValueError, StaticsError):
            return False
        return done != before if wanted is None else done == wanted

    if before == wanted:
        here = np.zeros(ways.dimensions)
        return answer(here, here, "exact")
    forces = SortedChain.of(chain)
    known = None
    if forces is not None:
        sign = 1 if anchor.part == "q" else -1
        known = _nearest(forces, anchor.cell, wanted, ways, sign, does)
        away = ways.reach if known is None else float(np.linalg.norm(known[1]))
        if ways.proved(forces.cells[anchor.cell], sign, min(away, ways.reach)):
            return answer(*(known or (None, None)), "exact")
    within = ways.reach if known is None else float(np.linalg.norm(known[0]))
    u = _hunt.hunt(does, ways, within, progress)
    words = _hunt.resolution(ways)
    if u is not None and (known is None or float(np.linalg.norm(u)) < within):
        return answer(u, u, "search", words)
    return answer(*(known or (None, None)), "search", words)


def _parsed(target: str, cells: int) -> Sequence:
    return Sequence.parse(full_cycle(target, cells, "target"))


def _moved(chain: Chain, anchor: Knob, move: Vec2) -> Chain:
    old = anchor.read(chain)
    assert isinstance(old, tuple)
    return anchor.turned(chain, (old[0] + move[0], old[1] + move[1]))


def _nearest(
    forces: SortedChain,
    cell: int,
    wanted: Sequence | None,
    ways: Ways,
    sign: int,
    does: Callable[[Floats], bool],
) -> tuple[Floats, Floats] | None:
    """The nearest u in closed form, and u a hair past it; None where there is none."""
    places = [
        place
        for conditions in _regions(forces, cell, wanted)
        for place in nearest_places(forces.cells[cell], conditions, ways, sign)
    ]
    for place in sorted(places, key=lambda place: place.distance):
        for hair in _HAIRS:
            past = place.u + hair * place.inward
            if does(past):
                return place.u, past
    return None


def _regions(forces: SortedChain, cell: int, wanted: Sequence | None) -> list[list[Condition]]:
    """Conditions on the moved cell; the sequence is the wanted one where all of a list hold."""
    if wanted is None:
        return [[Condition(n.side, n.other, n.up)] for n in forces.neighbours(cell)]
    orders = wanted.orders
    if orders is None:
        return []
    found: list[Condition] = []
    # Cells load in ascending F0 and unload in descending F1.
    for side, up, order, now in (
        (-1, 1, orders[0], forces.loading),
        (+1, -1, orders[1], forces.unloading),
    ):
        if [i for i in order if i != cell] != [i for i in now if i != cell]:
            return []  # the other cells do not do their part
        force, place = forces.forces[0 if side < 0 else 1], order.index(cell)
        if place > 0:
            found.append(Condition(side, float(force[order[place - 1]]), up))
        if place + 1 < len(order):
            found.append(Condition(side, float(force[order[place + 1]]), -up))
    return [found]
