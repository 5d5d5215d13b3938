"""An atlas of machines: what a space of designs holds, as values, and what cannot occur in it."""

import hashlib
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import permutations

import numpy as np

from stepwell.base import ByValue, Drawn, Progress, Shown, number
from stepwell.concave import STROKE, Simple, Way, concave_box, graph_by_ends, same_travel
from stepwell.design import Share, Tolerances
from stepwell.mechanism import Chain
from stepwell.sequences import TransitionGraph, TransitionKind
from stepwell.studies.blocks import packed
from stepwell.studies.designs import Axis, IndependentBlocks
from stepwell.studies.run import Status, sweep

_NAME = 8  # hex digits


def ways_of(graph: TransitionGraph) -> tuple[Way, ...]:
    """The ways of a graph: from, to, direction of the drive, whether it snaps."""
    return tuple(
        (a, b, one.direction, one.kind is TransitionKind.SNAP) for a, b, one in graph.transitions()
    )


def canonical(ways: Iterable[Way], cells: int) -> str:
    """A text that two graphs share exactly if one is the other with its cells renumbered.

    Of all numberings the one is taken whose text comes first; ways as `concave.closed_graph` gives.
    """
    return _canonical(frozenset(ways), cells)


@lru_cache(4096)
def _canonical(ways: frozenset[Way], cells: int) -> str:
    def text(places: tuple[int, ...]) -> str:
        def moved(label: str) -> str:
            # What follows the cells tells nodes of one state apart.
            return "".join(label[place] for place in places) + label[cells:]

        return " ".join(
            sorted(
                f"{moved(a)}{'+' if up > 0 else '-'}{'!' * snaps}{moved(b)}"
                for a, b, up, snaps in ways
            )
        )

    return min(map(text, permutations(range(cells))))


def name_of(text: str) -> str:
    """The name of a graph by its canonical text: the first digits of its SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()[:_NAME]


# 4 cells have 105 orders, 5 have 945, each with 120 numberings.
_MOST = 4


@cache
def possible(cells: int, drive: int) -> frozenset[str] | None:
    """The canonical texts of all graphs that concave cells of one travel can have, proved.

    Where end forces alone tell the graph, it is that of their order, and the orders can be listed:
    every F1 is below its own F0, and which cell is which does not matter. Under a stroke that is so
    of two cells; of more, a snap may land by forces in between, and None is returned. Chains with a
    tie are none of these. The drive is STROKE or FORCE.

    Source: ours (theory page, "Graphs in closed form").
    """
    if cells > _MOST or (drive == STROKE and cells > 2):
        return None
    orders = (np.array(one, float).reshape(cells, 2) for one in permutations(range(2 * cells)))
    return frozenset(
        canonical(graph_by_ends(ends, drive), cells)
        for ends in orders
        if np.all(np.diff(ends[:, 0]) > 0) and np.all(ends[:, 1] < ends[:, 0])
    )


def proved_space(chain: Chain, axes: tuple[Axis, ...]) -> bool:
    """Whether every design of a space has concave taut cells of one travel, proved.

    The axes are anchors and stiffness, on which the proof does not hang.
    """
    numbers = packed(chain, [axis.name for axis in axes])
    values = np.array([(axis.low, axis.high) for axis in axes])
    ends = numbers.slopes[..., None] * values[:, None, None, :]
    low = numbers.base + np.sum(np.min(ends, axis=-1), axis=0)
    high = numbers.base + np.sum(np.max(ends, axis=-1), axis=0)
    # ℓ0, r and θc are those of the drawing, and k > 0 scales both sides of the certificate.
    if np.any(low[:, 3:] != high[:, 3:]) or np.any(low[:, 2] <= 0):
        return False
    travels = low[:, 4] * low[:, 5]
    if not same_travel(np.max(travels), np.min(travels)):
        return False
    return all(
        concave_box(Simple(*row), row[:2], top[:2]) for row, top in zip(low, high, strict=True)
    )


# Designs in a block: some tenths of a second of two cells, some seconds of three.
_SIZES = {2: 1_000_000, 3: 100_000}
_FEW = 10_000


@dataclass(frozen=True, eq=False)
class Machine(ByValue):
    """One transition graph that occurs, whichever cell is which.

    Attributes:
        name: the first digits of the SHA-256 of its canonical text.
        share: of the designs that closed form tells.
        design, chain: number of its most robust design, and that design.
        gap: by how much of the largest force two of its forces could come nearer before the graph
            is another one.
        kept: of so many mechanisms built after it within the tolerances, those with this graph; the
            engine follows what closed form does not tell.
        agrees: whether the engine finds the same graph of that design.
        cycle: what a full stroke to and fro does; cells are numbered as they load.
        states, reached: with every cell at a stop, and of these, how many one actuator reaches from
            all cells at 0.
        snaps: ways that cannot be turned back.
        sub_loops: loops besides the main one.
        remembers: whether it has return-point memory.
        scrambled: pairs of cells that flip in either order.
        counts, counts_by_hand: cycles of the drive that it takes to come into a rhythm, at most, 0
            if it is in one at once; and from states that a hand sets.
        gardens: states to which nothing leads, so that only a hand sets them.
        latches: moves that no later drive takes back.
        ways: of that design.
    """

    name: str
    share: Share
    design: int
    chain: Chain = field(repr=False)
    gap: float
    kept: Share
    agrees: bool
    cycle: str
    states: int
    reached: int
    snaps: int
    sub_loops: int
    remembers: bool
    scrambled: int
    counts: int
    counts_by_hand: int
    gardens: int
    latches: int
    ways: tuple[Way, ...] = field(repr=False)

    @property
    def memory(self) -> str:
        """What it does with what was done to it before, in the words that `find` understands."""
        counts = max(self.counts, self.counts_by_hand)
        by_hand = "" if self.counts == counts else " by hand"
        words = {
            "forgets": not self.remembers,
            "scrambles": self.scrambled,
            f"counts to {counts}{by_hand}": counts,
            "latches": self.latches,
        }
        return ", ".join(word for word, is_so in words.items() if is_so)

    def __repr__(self):
        return (
            f"Machine({self.name}: {self.cycle}, {number(self.share.share * 100)} % of designs, "
            f"yield {number(self.kept.share * 100)} %)"
        )


@dataclass(frozen=True, eq=False)
class Cycling(ByValue):
    """One full cycle that occurs, inner cell first.

    Attributes:
        sequence: such as "00>10>11>01>00".
        share: of the designs whose cells closed form tells.
        design, chain: number of the one whose forces are farthest from another order, and itself.
        gap: by how much of the largest force two of its forces could come nearer before the cycle
            is another one.
    """

    sequence: str
    share: Share
    design: int
    chain: Chain = field(repr=False)
    gap: float

    def __repr__(self):
        return f"Cycling({self.sequence}, {number(self.share.share * 100)} % of designs)"


@dataclass(frozen=True, eq=False)
class Sampled(ByValue):
    """What the engine found of a sample of the designs that closed form does not tell.

    Attributes:
        asked, failed: designs that it followed, and of these, those that it could not.
        machines: how often each graph came, by name; those of `Atlas.machines` and others.
    """

    asked: int
    failed: int
    machines: dict[str, int]


@dataclass(frozen=True, eq=False)
class Atlas(ByValue, Shown, Drawn):
    """What a space of designs holds.

    Attributes:
        chain, axes: what was varied, and what of it, between which values.
        drive: "stroke" or "force".
        seed, designs: of the draw, and how many were drawn, evenly over the space.
        told: how many closed form tells.
        not_proved: how many have a cell that is not proved concave and taut.
        ties: how many have two forces that tie.
        wakes: how many land by a flow of several cells that two step widths do not agree on.
        tolerances: within which designs are built.
        machines, cycles: every graph and every full cycle that occurs, most frequent first.
        unseen: of the designs in the second half of the blocks, those with a graph that none in the
            first half has; the share of all designs with a graph that was not found is at most its
            upper end, in 95 of 100 atlases. None of fewer than two blocks.
        sampled: what the engine found of designs that are not told.
        checked, agreed: designs drawn anew that closed form tells, and those of which the engine
            finds the same graph.
        possible: how many graphs concave cells can have at all, proved; None where not known.
        space_proved: whether every design of the space is proved to have concave cells, not only
            those that were drawn.
    """

    chain: Chain = field(repr=False)
    axes: tuple[Axis, ...] = field(repr=False)
    drive: str
    seed: int
    designs: int
    told: int
    not_proved: int
    ties: int
    wakes: int
    tolerances: Tolerances
    machines: tuple[Machine, ...] = field(repr=False)
    cycles: tuple[Cycling, ...] = field(repr=False)
    unseen: Share | None
    sampled: Sampled
    checked: int
    agreed: int
    possible: int | None
    space_proved: bool

    @property
    def whole(self) -> bool:
        """Whether it is proved that no other graph occurs in the space, ties left aside."""
        return self.space_proved and self.possible == len(self.machines)

    def __repr__(self):
        return (
            f"Atlas({len(self.chain)} cells by {self.drive}: {len(self.machines)} graphs and "
            f"{len(self.cycles)} cycles of {self.designs} designs)"
        )


def atlas_blocks(cells: int, axes: tuple[Axis, ...], designs: int, seed: int) -> IndependentBlocks:
    """At least so many designs of a space, in blocks of a size for chains of so many cells."""
    size = min(_SIZES.get(cells, _FEW), designs)
    return IndependentBlocks(axes, size, -(-designs // max(size, 1)), seed)


def atlas(
    chain: Chain,
    axes: tuple[Axis, ...],
    designs: int,
    folder: str | os.PathLike[str],
    *,
    drive: str = "stroke",
    seed: int = 0,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = None,
) -> Status:
    """Draw designs evenly over a space and count what they do, into a store that loses nothing.

    A call with the same arguments goes on with what is missing. `charted` makes an atlas of the
    store, finished or not. Other arguments and errors are those of `sweep`.

    Args:
        chain: that is varied: cells of one linear band each, without load or friction.
        axes: what varies, as `Axis` tells: anchors, stiffness, rest length, lever.
        designs: how many, rounded up to whole blocks.
        drive: "stroke" or "force".

    Raises:
        ValueError: cells or numbers that closed form does not take.
    """
    packed(chain, [axis.name for axis in axes])  # or refused, before there is a store
    of = atlas_blocks(len(chain), axes, designs, seed)
    return sweep(
        chain, "atlas", of, folder,
        given={"drive": drive}, chunk=1, workers=workers, scheduler=scheduler, progress=progress,
    )  # fmt: skip
