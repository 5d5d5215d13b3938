"""Summary of a study: frequencies and intervals of outcomes, and ranges of numbers."""

from collections import Counter
from collections.abc import Iterator
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.design import Fraction, Method, fraction_of, parameter_boundaries, parameters
from stepwell.mechanism import Chain
from stepwell.studies.designs import How
from stepwell.studies.store import PROBLEM, Study
from stepwell.studies.work import SCREEN_COLUMNS, TEXT

# Largest number of values counted in a column of words, the most frequent first.
_VALUES = 20


class Varied(NamedTuple):
    """A varied parameter with its range in a unit, "" for a ratio.

    Without prescribed bounds, the range is that of the finished designs; None if there are none.
    """

    parameter: str
    unit: str
    low: float | None
    high: float | None


class Frequency(NamedTuple):
    """Frequency of one value of a column of words.

    `fraction` is the fraction of the designs with a value; in a screened study, of those drawn at
    random. Its interval is valid only if the designs are a random sample (`sampled`).
    """

    column: str
    value: str
    fraction: Fraction
    sampled: bool


class Extent(NamedTuple):
    """Least, median and largest value of a column in a unit, "" for a ratio or a count.

    `designs` is the number of designs with a value; if it is 0, the others are None.
    """

    column: str
    unit: str
    least: float | None
    median: float | None
    most: float | None
    designs: int


def varied(study: Study) -> tuple[Varied, ...]:
    """The varied parameters of a study with their ranges."""
    axes = {axis.name: (axis.low, axis.high) for axis in getattr(study.designs, "axes", ())}
    parameters: list[Varied] = []
    for name in study.varied:
        unit, factor = study.display_unit(name)
        values = np.array(axes[name]) if name in axes else _finite(study, name)
        ends = [float(of(values)) * factor if len(values) else None for of in (np.min, np.max)]
        parameters.append(Varied(name, unit, *ends))
    return tuple(parameters)


def frequencies(study: Study) -> tuple[Frequency, ...]:
    """Frequencies of the outcomes in every column of words, the most frequent first."""
    if study.what == "atlas":
        # Columns of an atlas are JSON.
        return ()
    sampled = study.designs.how not in (How.GRID, "listed")
    frequencies: list[Frequency] = []
    for name in (name for name, unit in _result_units(study).items() if unit == TEXT):
        words = np.array([str(one) for one in study.values(name)], object)
        if study.work.screen:
            # Only designs drawn at random are a sample; a screen's choice is not.
            words = words[study.values("lot") == 1]
        counts = Counter(words.tolist())
        counts.pop("", None)
        of = sum(counts.values())
        often = sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
        frequencies += [Frequency(name, value, fraction_of(n, of), sampled) for value, n in often]
    return tuple(frequencies)


def extents(study: Study) -> tuple[Extent, ...]:
    """The range of every result that is a number."""
    extents: list[Extent] = []
    for name in (name for name, unit in _result_units(study).items() if unit != TEXT):
        unit, factor = study.display_unit(name)
        values = _finite(study, name) * factor
        least, median, most = (
            float(of(values)) if len(values) else None for of in (np.min, np.median, np.max)
        )
        extents.append(Extent(name, unit, least, median, most, len(values)))
    return tuple(extents)


def _result_units(study: Study) -> dict[str, str]:
    """Unit of every result column by its name."""
    others = {*study.varied, *SCREEN_COLUMNS, PROBLEM}
    return {name: unit for name, unit in study.columns.items() if name not in others}


def _finite(study: Study, name: str) -> Floats:
    values = study.values(name)
    return values[np.isfinite(values)]


# Largest number of intervals of a column; more are no strip but noise.
_MOST = 24
# Width of the plane around the varied parameter in which boundaries are looked for, as a fraction
# of the other parameter's size.
_NARROW = 1e-6


class OutcomeInterval(NamedTuple):
    """Neighbouring designs with one outcome, along the varied parameter in its display unit.

    Attributes:
        column: a column of words.
        value: the outcome.
        unit: unit of the parameter, "" for a ratio.
        first, last: the parameter of its first and last design.
        low, high: exact boundaries to the neighbouring intervals; None if they are known only
            to lie between two designs, or if there is no neighbour.
        designs: number of designs.
    """

    column: str
    value: str
    unit: str
    first: float
    last: float
    low: float | None
    high: float | None
    designs: int


def intervals(study: Study) -> tuple[OutcomeInterval, ...]:
    """Intervals of equal outcomes of every column of words, in the order of the parameter.

    Exact boundaries are those of `design.parameter_boundaries` in the range of the closed form.
    The result is empty unless exactly one parameter is varied, for screened studies, and for
    columns with more than 24 intervals. Designs without an outcome belong to no interval.
    """
    if study.what == "atlas" or study.work.screen or len(study.varied) != 1:
        return ()
    (name,) = study.varied
    along = study.values(name, study.done_chunks())
    aside = {name, PROBLEM, *SCREEN_COLUMNS}
    columns = [one for one, kind in study.columns.items() if kind == TEXT and one not in aside]
    return tuple(one for column in columns for one in _of_column(study, column, name, along))


def _of_column(study: Study, column: str, name: str, along: Floats) -> Iterator[OutcomeInterval]:
    """The intervals of one column over the values `along` of the parameter."""
    unit, factor = study.display_unit(name)
    words = [str(word) for word in study.values(column, study.done_chunks())]
    order = np.argsort(along, kind="stable").tolist()
    known = [k for k in order if words[k] and np.isfinite(along[k])]
    runs = [[*run] for _, run in groupby(known, words.__getitem__)]
    if not 0 < len(runs) <= _MOST:
        return
    ends = [(float(along[run[0]]), float(along[run[-1]])) for run in runs]
    gaps = [(a, b) for (_, a), (b, _) in pairwise(ends)]
    exact = _between(gaps, _exact(study, name, along), factor) if gaps else []
    edges = pairwise([None, *exact, None])
    for run, (first, last), between in zip(runs, ends, edges, strict=True):
        scaled = first * factor, last * factor
        yield OutcomeInterval(column, words[run[0]], unit, *scaled, *between, len(run))


def _between(gaps: list[tuple[float, float]], exact: Floats, factor: float) -> list[float | None]:
    """The exact boundary in each gap, if there is one and only one, times the factor."""
    inside = [exact[(exact >= low) & (exact <= high)] for low, high in gaps]
    return [float(one[0]) * factor if len(one) == 1 else None for one in inside]


def _exact(study: Study, name: str, along: Floats) -> Floats:
    """Values of the parameter at which the sequence changes, in closed form; empty if unknown."""
    chain = study.subject
    if study.what != "cycle" or not isinstance(chain, Chain) or chain.elements:
        return np.empty(0)
    by_name = {one.name: one for one in parameters(chain)}
    own = by_name.pop(name, None)
    if own is None:
        return np.empty(0)
    # Boundaries are curves over two parameters; the second one is an anchor that hardly moves.
    other = next(one for one in by_name.values() if one.part in ("q.x", "q.y"))
    at = other.value(chain)
    assert isinstance(at, float)
    apart = _NARROW * max(abs(at), 1e-3)
    axes = (name, np.unique(along[np.isfinite(along)])), (other.name, [at - apart, at + apart])
    try:
        curves = parameter_boundaries(chain, *axes, search=2)
    except InputError:
        return np.empty(0)
    proved = [one.points for one in curves if one.method is Method.EXACT]
    crossings = [float(x) for points in proved for x in _crossings(points, at)]
    return np.unique(np.round(crossings, 12))


def _crossings(points: Floats, at: float) -> Floats:
    """First coordinates where a curve (m, 2) crosses this value of the second one."""
    x, off = points[:, 0], points[:, 1] - at
    k = np.flatnonzero(np.signbit(off[1:]) != np.signbit(off[:-1]))
    share = off[k] / (off[k] - off[k + 1])
    return x[k] + share * (x[k + 1] - x[k])
