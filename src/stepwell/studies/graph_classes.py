"""Atlas of transition graphs: the graphs that occur in a design space, and those possible."""

import hashlib
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import permutations

import numpy as np

from stepwell.base import ByValue, Drawn, Progress, Shown, number
from stepwell.concave import STROKE, Simple, Way, concave_box, graph_by_ends, same_travel
from stepwell.design import Fraction, Tolerances
from stepwell.mechanism import Chain
from stepwell.sequences import TransitionGraph, TransitionKind
from stepwell.studies.blocks import packed
from stepwell.studies.designs import Axis, IndependentBlocks
from stepwell.studies.run import Status, sweep

_NAME = 8  # hex digits


def ways_of(graph: TransitionGraph) -> tuple[Way, ...]:
    """The transitions of a graph: from, to, direction of the drive, whether it snaps."""
    return tuple(
        (a, b, one.direction, one.kind is TransitionKind.SNAP) for a, b, one in graph.transitions()
    )


def canonical(ways: Iterable[Way], cells: int) -> str:
    """Canonical text of a graph: equal for two graphs if and only if they differ only by the
    numbers of their cells.

    It is the alphabetically first text of all numberings; ways are those of `concave.closed_graph`.
    """
    return _canonical(frozenset(ways), cells)


@lru_cache(4096)
def _canonical(ways: frozenset[Way], cells: int) -> str:
    def text(places: tuple[int, ...]) -> str:
        def moved(label: str) -> str:
            # The characters after the cells distinguish nodes of one state.
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
    """The canonical texts of all possible graphs of concave cells with one travel, proved.

    If the order of the critical forces determines the graph, all orders can be listed: every F1 is
    below its own F0, and the numbers of the cells do not matter. Under displacement control this
    holds for two cells. With more cells a landing may depend on intermediate forces, and None is
    returned. Chains with ties are excluded. The drive is STROKE or FORCE.

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
    """Whether every design of a space has concave cells in tension with one travel, proved.

    The axes must be anchors and stiffness.
    """
    numbers = packed(chain, [axis.name for axis in axes])
    values = np.array([(axis.low, axis.high) for axis in axes])
    ends = numbers.slopes[..., None] * values[:, None, None, :]
    low = numbers.base + np.sum(np.min(ends, axis=-1), axis=0)
    high = numbers.base + np.sum(np.max(ends, axis=-1), axis=0)
    # ℓ0, r and θc are nominal, and k > 0 scales both sides of the certificate.
    if np.any(low[:, 3:] != high[:, 3:]) or np.any(low[:, 2] <= 0):
        return False
    travels = low[:, 4] * low[:, 5]
    if not same_travel(np.max(travels), np.min(travels)):
        return False
    return all(
        concave_box(Simple(*row), row[:2], top[:2]) for row, top in zip(low, high, strict=True)
    )


# Designs in a block: a few tenths of a second for two cells, a few seconds for three.
_SIZES = {2: 1_000_000, 3: 100_000}
_FEW = 10_000


@dataclass(frozen=True, eq=False)
class GraphClass(ByValue):
    """A transition graph that occurs in a design space, up to the numbers of the cells.

    Attributes:
        name: the first digits of the SHA-256 of its canonical text.
        fraction: fraction of the designs evaluated in closed form.
        design, chain: number of its most robust design, and that design.
        gap: change of the difference of two forces, as a fraction of the largest force, up to which
            the graph stays the same.
        kept: yield of the most robust design: samples within the tolerances with this graph; a
            sample without a closed form is simulated.
        agrees: whether the general engine finds the same graph for that design.
        cycle: sequence of a full cycle; cells are numbered in loading order.
        states, reached: number of states with every cell at a stop, and number of these that are
            reachable from all cells at 0.
        snaps: number of snaps.
        sub_loops: number of loops other than the main loop.
        remembers: whether it has return-point memory.
        scrambled: number of pairs of cells that switch in either order.
        counts, counts_by_hand: largest number of drive cycles before the motion is periodic, 0 if
            it is periodic at once; the second starts from states set by hand.
        gardens: number of Garden-of-Eden states, which only a hand can set.
        latches: number of transitions that no later drive reverses.
        ways: transitions of that design.
    """

    name: str
    fraction: Fraction
    design: int
    chain: Chain = field(repr=False)
    gap: float
    kept: Fraction
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
        """Its memory, in the phrases of `find`."""
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
            f"GraphClass({self.name}: {self.cycle}, {number(self.fraction.estimate * 100)} % of "
            f"designs, yield {number(self.kept.estimate * 100)} %)"
        )


@dataclass(frozen=True, eq=False)
class FullCycle(ByValue):
    """A full cycle that occurs in a design space, inner cell first.

    Attributes:
        sequence: such as "00>10>11>01>00".
        fraction: fraction of the designs whose cells are evaluated in closed form.
        design, chain: number of the design whose forces are farthest from another order, and that
            design.
        gap: change of the difference of two forces, as a fraction of the largest force, up to which
            the cycle stays the same.
    """

    sequence: str
    fraction: Fraction
    design: int
    chain: Chain = field(repr=False)
    gap: float

    def __repr__(self):
        return f"FullCycle({self.sequence}, {number(self.fraction.estimate * 100)} % of designs)"


@dataclass(frozen=True, eq=False)
class SampledGraphs(ByValue):
    """Result of the general engine for a sample of the designs without a closed form.

    Attributes:
        asked, failed: number of simulated designs, and of failed simulations.
        graph_classes: number of designs by name of the graph, in `Atlas.graph_classes` or not.
    """

    asked: int
    failed: int
    graph_classes: dict[str, int]


@dataclass(frozen=True, eq=False)
class Atlas(ByValue, Shown, Drawn):
    """Transition graphs and full cycles that occur in a design space.

    Attributes:
        chain, axes: the nominal design, and its varied parameters with their ranges.
        drive: "stroke" or "force".
        seed, designs: random seed, and number of designs, uniformly distributed over the space.
        closed_form: number of designs evaluated in closed form.
        not_proved: number of designs with a cell that is not proved concave and in tension.
        ties: number of designs with two equal critical forces.
        wakes: number of designs with a landing that two step sizes do not agree on.
        tolerances: tolerances of the yields.
        graph_classes, cycles: every graph and every full cycle that occurs, most frequent first.
        unseen: fraction of designs in the second half of the blocks with a graph that does not
            occur in the first half. Its upper end bounds the fraction of all designs with an unseen
            graph, at 95 % confidence. None with fewer than two blocks.
        sampled: result of the engine for designs without a closed form.
        checked, agreed: number of new designs with a closed form, and number of these for which the
            engine finds the same graph.
        possible: number of possible graphs of concave cells, proved; None if unknown.
        space_proved: whether every design of the space, drawn or not, is proved to have concave
            cells.
    """

    chain: Chain = field(repr=False)
    axes: tuple[Axis, ...] = field(repr=False)
    drive: str
    seed: int
    designs: int
    closed_form: int
    not_proved: int
    ties: int
    wakes: int
    tolerances: Tolerances
    graph_classes: tuple[GraphClass, ...] = field(repr=False)
    cycles: tuple[FullCycle, ...] = field(repr=False)
    unseen: Fraction | None
    sampled: SampledGraphs
    checked: int
    agreed: int
    possible: int | None
    space_proved: bool

    @property
    def whole(self) -> bool:
        """Whether no other graph can occur in the space, ties excluded; proved."""
        return self.space_proved and self.possible == len(self.graph_classes)

    def __repr__(self):
        return (
            f"Atlas({len(self.chain)} cells by {self.drive}: {len(self.graph_classes)} graphs and "
            f"{len(self.cycles)} cycles of {self.designs} designs)"
        )


def atlas_blocks(cells: int, axes: tuple[Axis, ...], designs: int, seed: int) -> IndependentBlocks:
    """At least `designs` designs of a space, in blocks whose size suits the number of cells."""
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
    """Count the graphs and cycles of designs drawn uniformly from a space, in a resumable store.

    A call with the same arguments computes what is missing. `charted` makes an atlas of the store,
    finished or not. Other arguments and errors are those of `sweep`.

    Args:
        chain: nominal design: cells of one linear band each, without load or friction.
        axes: varied parameters: anchors, stiffness, rest length, lever.
        designs: number of designs, rounded up to whole blocks.
        drive: "stroke" or "force".

    Raises:
        ValueError: cells or parameters without a closed form.
    """
    packed(chain, [axis.name for axis in axes])  # an error must come before the store is made
    of = atlas_blocks(len(chain), axes, designs, seed)
    return sweep(
        chain, "atlas", of, folder,
        given={"drive": drive}, chunk=1, workers=workers, scheduler=scheduler, progress=progress,
    )  # fmt: skip
