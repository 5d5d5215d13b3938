"""What recordings of cells and pairs give to a fit: for each cell that moves its net force."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, ReadOnly, grouped
from stepwell.lab.pair_test import PairTest, pair_tests
from stepwell.lab.series import Geometry, Series, geometry_of
from stepwell.mechanism import Cell, Table

_POINTS = 60
# Between these shares of the jump in force from one cell to the next the rig alone gives way.
_JUMP_PART = 0.25, 0.75
_FEWEST = 10  # samples in which a jump can be seen


@dataclass(frozen=True, eq=False, repr=False)
class Sample(ByValue):
    """One cell moving in one series, made ready for the fit, in the order of motion.

    Attributes:
        name: of the series, and in a pair of the cell.
        geometry: d = q - p of the cell [m].
        bands: how many it carried.
        cell: lever and stops as designed.
        way: (n,) of the machine since its motion began [m].
        force: (n,) F of the block, the baseline subtracted [N].
        unloading: whether the cell goes from state 1 to state 0.
        fold: the geometry with which it is left out: that of the outermost cell [m].
        before: travel of the cell that moved before it [m].
        drive: (n,) force at the machine [N], by which the rig gives way; None where it is stiff.
        begins: way of the machine and its force where it began to move after another cell
            [m], [N]; None where that is not seen.
        series, place: the name of a pair's series, and which of its cells it is, 0 the inner one.
    """

    name: str
    geometry: Geometry
    bands: int
    cell: Cell = field(repr=False)
    way: Floats = field(repr=False)
    force: Floats = field(repr=False)
    unloading: bool
    fold: Geometry
    before: float = 0.0
    drive: Floats | None = field(default=None, repr=False)
    begins: tuple[float, float] | None = None
    series: str = ""
    place: int = 0

    @property
    def in_pair(self) -> bool:
        """Whether another cell is in series with it."""
        return self.drive is not None

    @property
    def rubber(self) -> str:
        """Name of its stiffness: pieces that were tested together are one kind of rubber."""
        return rubber_name(self.bands, self.in_pair)


@dataclass(frozen=True, eq=False)
class Weighing(ByValue):
    """What runs of pairs without a band tell: the force while one cell moves, and the other.

    Attributes:
        weight: how much more the inner cell carries than the outer one [N]: the block between.
        friction: of the machine and of empty joints, against the motion [N]; NaN where one
            direction alone was tested.
        doubt: standard deviation of the weight between runs [N].
        both: whether loading and unloading were tested; else friction is taken to be the same.
    """

    weight: float
    friction: float
    doubt: float
    both: bool


@dataclass(frozen=True, eq=False, repr=False)
class Prepared(ByValue):
    """What is fitted, and what it is tried on.

    Attributes:
        samples: each cell that moves in a series.
        pairs: series of pairs beside their model without a fit.
        tables: laws of bands by name, from tension tests.
        notes: which recordings were used, which were dropped, and what is odd, a line each.
    """

    samples: tuple[Sample, ...]
    pairs: tuple[PairTest, ...] = ()
    tables: Mapping[str, Table] = field(default_factory=dict)
    notes: tuple[str, ...] = field(default=(), repr=False)

    def __post_init__(self):
        object.__setattr__(self, "tables", ReadOnly(self.tables))


def rubber_name(bands: int, in_pair: bool) -> str:
    """Name of the stiffness of cells with so many bands: other tests, other pieces of rubber."""
    return f"stiffness_{bands}{'_in_pairs' * in_pair}"


def prepare(
    series: Sequence[Series], tables: Mapping[str, Table] | None = None, notes: Sequence[str] = ()
) -> Prepared:
    """Net forces of cells on even ways, in the order of motion; of pairs for each of both cells.

    In pairs the baseline of the cell that moves is subtracted, in the order that the forces show,
    and nothing from the first snap on is used, so that no snap has a part in a fit. `tables` are
    laws of bands to try, `notes` on recordings that are in no series, as `Sorted.notes`.
    """
    cells = [_of_cell(one) for one in series if len(one.chain) == 1]
    pairs = pair_tests([one for one in series if len(one.chain) > 1])
    in_pairs = (sample for test in pairs for sample in _of_pair(test))
    used = (f"{one.name}: {line}" for one in series for line in one.notes)
    return Prepared((*cells, *in_pairs), tuple(pairs), tables or {}, (*used, *notes))


def weigh(tests: Iterable[PairTest]) -> Weighing | None:
    """Weight between two cells and friction, from their runs without a band; None without such.

    At mid-travel of each cell, the half-sum and the half-difference of rising and falling runs.
    """
    apart: dict[tuple[str, ...], PairTest] = {}
    for test in tests:
        apart.setdefault(tuple(run.source for run in test.series.baseline), test)
    based = (one for runs, one in apart.items() if runs)
    ways = ((-1 if one.series.unloading else 1, one.baseline_levels()) for one in based)
    levels = grouped((way, level) for way, each in ways for level in each)
    if not levels:
        return None
    # Weight and friction of inner and outer cell add up going up, and are subtracted going down.
    mean = {way: np.mean(np.array(each), axis=0) for way, each in levels.items()}
    gaps = [-np.diff(np.array(each), axis=1) for each in levels.values()]
    weight = float(np.mean([np.mean(gap) for gap in gaps]))
    spread = [float(np.var(gap, ddof=1)) / len(gap) for gap in gaps if len(gap) > 1]
    both = len(mean) == 2
    friction = float(np.mean(mean[1] - mean[-1])) / 2.0 if both else math.nan
    doubt = math.sqrt(sum(spread)) / len(gaps) if spread else math.nan
    return Weighing(weight, friction, doubt, both)


class Handover(NamedTuple):
    """Where the force of a run jumps to the next cell [m], [N], and how the rig gives way [m/N]."""

    stroke: float
    force: float
    compliance: float


def handovers(test: PairTest) -> list[Handover]:
    """The handover of each run that shows one: a short stroke, for the rig alone gives way."""
    low, high = test.handover
    jumps: list[Handover] = []
    for run in test.series.recordings:
        stroke = test.series.placed(run)
        near = (low <= stroke) & (stroke <= high)
        u, force = stroke[near], run.force[near]
        if len(u) < _FEWEST:
            continue
        edge = len(u) // 10 + 1
        first, last = float(np.median(force[:edge])), float(np.median(force[-2 * edge :]))
        share = (force - first) / (last - first if last != first else 1.0)
        jump = (share > _JUMP_PART[0]) & (share < _JUMP_PART[1])
        if np.count_nonzero(jump) > 1:
            compliance = float(np.ptp(u[jump]) / max(float(np.ptp(force[jump])), 1e-9))
            jumps.append(Handover(float(np.mean(u[jump])), float(np.mean(force[jump])), compliance))
    return jumps


def _of_cell(series: Series) -> Sample:
    cell, curve, use = series.chain.levers[0], series.curve, series.judged()
    force = series.net(curve.stroke, curve.force)[use]
    way = cell.full_travel - curve.stroke[use] if series.unloading else curve.stroke[use]
    ways, forces = _strips(series.unloading, way, force)
    d = series.geometry
    return Sample(series.name, d, series.bands, cell, ways, forces, series.unloading, d)


def _of_pair(test: PairTest) -> list[Sample]:
    series, use = test.series, test.fitted
    full = series.chain.full_stroke
    fold = geometry_of(series.chain.levers[-1])
    ways = full - test.stroke if series.unloading else test.stroke
    samples: list[Sample] = []
    before, seen = 0.0, handovers(test)
    begins = None
    if seen:
        stroke, push, _ = np.mean(np.array(seen), axis=0)
        begins = float(full - stroke if series.unloading else stroke), float(push)
    for i, moving in test.moving():
        moving_now, cell = use & moving, series.chain.levers[i]
        if np.count_nonzero(moving_now) > 1:
            columns = ways[moving_now], test.force[moving_now], series.curve.force[moving_now]
            way, force, drive = _strips(series.unloading, *columns)
            sample = Sample(
                f"{series.name}, {series.chain.names[i]}",
                geometry_of(cell),
                series.bands,
                cell,
                way,
                force,
                series.unloading,
                fold,
                before,
                drive,
                begins if before else None,
                series.name,
                i,
            )
            samples.append(sample)
        before += cell.full_travel
    return samples


def _strips(backwards: bool, *columns: Floats) -> list[Floats]:
    """Means over strips, in the order of motion: what is fitted is the curve, not its noise."""
    parts = [
        np.array([float(np.mean(part)) for part in np.array_split(values, _POINTS) if len(part)])
        for values in columns
    ]
    return [part[::-1] for part in parts] if backwards else parts
