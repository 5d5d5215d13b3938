"""Data for the fit, the net force of each moving cell, and the tension at their lengths."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, ReadOnly, grouped, to_unit
from stepwell.lab.bands.halves import student
from stepwell.lab.pair_test import PairTest, pair_tests
from stepwell.lab.series import Geometry, Series, geometry_of
from stepwell.mechanism import Band, Cell, Law, Table, geometry

_POINTS = 60
# Part of the force jump between two cells in which only the rig deforms.
_JUMP_PART = 0.25, 0.75
_FEWEST = 10  # samples needed to detect a jump


@dataclass(frozen=True, eq=False, repr=False)
class Sample(ByValue):
    """Data of one moving cell in one series for the fit, in the order of motion.

    Attributes:
        name: of the series, and of the cell if in a pair.
        geometry: d = q - p of the cell [m].
        bands: number on the cell.
        cell: nominal lever and stops.
        way: (n,) distance of the machine since the start of its motion [m].
        force: (n,) F of the block, the baseline subtracted [N].
        unloading: whether the cell goes from state 1 to state 0.
        fold: geometry of the outermost cell, by which samples are left out together [m].
        before: travel of the cell that moved before it [m].
        drive: (n,) force at the machine [N], which deforms the rig; None for a rigid rig.
        begins: distance and force of the machine where the cell began to move after another
            cell [m], [N]; None if not detected.
        series, place: the name of a pair's series, and the index of the cell, 0 the inner one.
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
        """Name of its stiffness: bands that were tested together share one stiffness."""
        return rubber_name(self.bands, self.in_pair)


@dataclass(frozen=True, eq=False)
class Weighing(ByValue):
    """Weight and friction from runs of pairs without a band.

    Attributes:
        weight: of the block between the cells: load of the inner less that of the outer cell [N].
        friction: of the machine and of joints without a band, against the motion [N]; NaN if only
            one direction was tested.
        doubt: standard deviation of the weight between runs [N].
        both: whether loading and unloading were tested; else friction is assumed equal.
    """

    weight: float
    friction: float
    doubt: float
    both: bool


@dataclass(frozen=True, eq=False, repr=False)
class Prepared(ByValue):
    """Input of a calibration: data for the fit, and pairs for its predictions.

    Attributes:
        samples: each cell that moves in a series.
        pairs: series of pairs with their model without a fit.
        tables: laws of bands by name, from tension tests.
        notes: recordings that were used or dropped, and irregularities, a line each.
    """

    samples: tuple[Sample, ...]
    pairs: tuple[PairTest, ...] = ()
    tables: Mapping[str, Table] = field(default_factory=dict)
    notes: tuple[str, ...] = field(default=(), repr=False)

    def __post_init__(self):
        object.__setattr__(self, "tables", ReadOnly(self.tables))


def rubber_name(bands: int, in_pair: bool) -> str:
    """Name of the stiffness of cells with this number of bands."""
    return f"stiffness_{bands}{'_in_pairs' * in_pair}"


def prepare(
    series: Sequence[Series], tables: Mapping[str, Table] | None = None, notes: Sequence[str] = ()
) -> Prepared:
    """Net force of each moving cell over even steps, in the order of motion.

    For pairs the baseline of the moving cell is subtracted, in the order shown by the forces. Data
    from the first snap on are not used, so no snap influences a fit. `tables` are band laws to
    try, `notes` those on recordings in no series, as `Sorted.notes`.
    """
    cells = [_of_cell(one) for one in series if len(one.chain) == 1]
    pairs = pair_tests([one for one in series if len(one.chain) > 1])
    in_pairs = (sample for test in pairs for sample in _of_pair(test))
    used = (f"{one.name}: {line}" for one in series for line in one.notes)
    return Prepared((*cells, *in_pairs), tuple(pairs), tables or {}, (*used, *notes))


def _baseline_levels(tests: Iterable[PairTest]) -> dict[int, list[tuple[float, float]]]:
    """Levels of all runs without a band, each run once, by direction: 1 loading, -1 unloading."""
    apart: dict[tuple[str, ...], PairTest] = {}
    for test in tests:
        apart.setdefault(tuple(run.source for run in test.series.baseline), test)
    based = (one for runs, one in apart.items() if runs)
    ways = ((-1 if one.series.unloading else 1, one.baseline_levels()) for one in based)
    return grouped((way, level) for way, each in ways for level in each)


def weigh(tests: Iterable[PairTest]) -> Weighing | None:
    """Weight between two cells and friction from runs without a band; None without such runs.

    They are half the sum and half the difference of loading and unloading at mid-travel.
    """
    levels = _baseline_levels(tests)
    if not levels:
        return None
    # Friction adds to the weight in loading, and is subtracted from it in unloading.
    mean = {way: np.mean(np.array(each), axis=0) for way, each in levels.items()}
    gaps = [-np.diff(np.array(each), axis=1) for each in levels.values()]
    weight = float(np.mean([np.mean(gap) for gap in gaps]))
    spread = [float(np.var(gap, ddof=1)) / len(gap) for gap in gaps if len(gap) > 1]
    both = len(mean) == 2
    friction = float(np.mean(mean[1] - mean[-1])) / 2.0 if both else math.nan
    doubt = math.sqrt(sum(spread)) / len(gaps) if spread else math.nan
    return Weighing(weight, friction, doubt, both)


class Handover(NamedTuple):
    """Stroke and force of a run at the jump to the next cell [m], [N]; compliance [m/N]."""

    stroke: float
    force: float
    compliance: float


def handovers(test: PairTest) -> list[Handover]:
    """Handovers of the runs that show one: a short stroke in which only the rig deforms."""
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
    """Means over strips in the order of motion, which reduce the noise."""
    parts = [
        np.array([float(np.mean(part)) for part in np.array_split(values, _POINTS) if len(part)])
        for values in columns
    ]
    return [part[::-1] for part in parts] if backwards else parts


# Largest half width of the 95 % band of a known tension, over the largest tension.
KNOWN_TENSION = 0.3
_LENGTHS = 13  # lengths of a curve


@dataclass(frozen=True, eq=False, repr=False)
class TensionCurve(ByValue):
    """Tension of one band against its length, in loading, where the data contain this length.

    Attributes:
        rubber: name of its stiffness, such as "stiffness_2_in_pairs".
        length: (n,) distance of the anchors [m].
        tension: (n,) from the fit to all geometries [N].
        low, high: (n,) 95 % band of curves, by leaving out one geometry in turn [N].
    """

    rubber: str
    length: Floats = field(repr=False)
    tension: Floats = field(repr=False)
    low: Floats = field(repr=False)
    high: Floats = field(repr=False)

    @property
    def width(self) -> float:
        """Largest half width of the band of curves over the largest tension [1]."""
        most = max(float(np.max(np.abs(self.tension))), 1e-12)
        return float(np.max(self.high - self.low)) / 2.0 / most

    @property
    def known(self) -> bool:
        """Whether the tension is known well enough for a design."""
        return self.width <= KNOWN_TENSION

    def __repr__(self):
        low, high = (to_unit(float(end), "mm") for end in self.length[[0, -1]])
        return f"TensionCurve({self.rubber}, {low:.3g} to {high:.3g} mm, ±{self.width:.0%})"


def lengths_of(samples: Sequence[Sample]) -> tuple[float, float]:
    """Least and largest distance of the anchors of a band in the data [m]."""
    ends: list[float] = []
    for sample in samples:
        cell, full = sample.cell, sample.cell.full_travel
        travel = np.clip(sample.way, 0.0, full)
        sine = geometry.sine_at(travel, cell.lever, cell.sin_limit)
        sine = -sine if sample.unloading else sine  # the way of unloading begins at state 1
        cosine = np.sqrt(1.0 - sine**2)
        length = geometry.band_length(sine, cosine, *sample.geometry, cell.lever)
        ends += [float(np.min(length)), float(np.max(length))]
    return min(ends), max(ends)


def tension_curve(
    rubber: str,
    samples: Sequence[Sample],
    whole: Callable[[Floats], Floats],
    left_out: Sequence[Callable[[Floats], Floats]],
) -> TensionCurve:
    """Curve of the bands of these samples; functions are tensions [N] at lengths (n,) [m]."""
    length = np.linspace(*lengths_of(samples), _LENGTHS)
    tension = whole(length)
    each = np.array([one(length) for one in left_out])
    n = len(each)
    scatter = np.sum((each - np.mean(each, axis=0)) ** 2, axis=0)
    wide = student(n - 1) * np.sqrt((n - 1) / n * scatter)
    return TensionCurve(rubber, length, tension, tension - wide, tension + wide)


def measured_law(law: Law, rest: float, curves: Sequence[TensionCurve]) -> Table:
    """A law as a table over the lengths in the data; `rest` is the rest length [m].

    Between the rest length and the least length in the data the table is a straight line.
    """
    low = max(min(float(curve.length[0]) for curve in curves), rest + 1e-4)
    high = max(float(curve.length[-1]) for curve in curves)
    extension = np.linspace(low, high, _LENGTHS) - rest
    one = Band((0.0, 0.0), (1.0, 0.0), 1.0, rest, law)
    shape = np.maximum.accumulate(np.maximum(one.tension(rest + extension), 1e-6))
    return Table((0.0, *extension.tolist()), (0.0, *shape.tolist()))
