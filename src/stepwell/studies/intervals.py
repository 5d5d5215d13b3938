"""Intervals of equal outcomes along the only varied parameter of a study."""

from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.design import Method, parameter_boundaries, parameters
from stepwell.mechanism import Cell, Chain
from stepwell.studies.store import PROBLEM, Study
from stepwell.studies.work import SCREEN_COLUMNS, TEXT

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
    unit, factor = study.display_unit(name)
    along = study.values(name)
    aside = {name, PROBLEM, *SCREEN_COLUMNS}
    columns = [one for one, kind in study.columns.items() if kind == TEXT and one not in aside]
    found: list[OutcomeInterval] = []
    order = [k for k in np.argsort(along, kind="stable").tolist() if np.isfinite(along[k])]
    for column in columns:
        words = [str(word) for word in study.values(column)]
        known = [k for k in order if words[k]]
        runs = [[*run] for _, run in groupby(known, words.__getitem__)]
        if not 0 < len(runs) <= _MOST:
            continue
        ends = [(float(along[run[0]]), float(along[run[-1]])) for run in runs]
        gaps = [(a, b) for (_, a), (b, _) in pairwise(ends)]
        exact = _between(gaps, _exact(study, name, along)) if gaps else []
        at = [None, *(None if one is None else one * factor for one in exact), None]
        for k, (run, (first, last)) in enumerate(zip(runs, ends, strict=True)):
            scaled = first * factor, last * factor
            value = words[run[0]]
            found.append(OutcomeInterval(column, value, unit, *scaled, at[k], at[k + 1], len(run)))
    return tuple(found)


def _between(gaps: list[tuple[float, float]], exact: Floats) -> list[float | None]:
    """The exact boundary in each gap, if there is one and only one."""
    inside = [exact[(exact >= low) & (exact <= high)] for low, high in gaps]
    return [float(one[0]) if len(one) == 1 else None for one in inside]


def _exact(study: Study, name: str, along: Floats) -> Floats:
    """Values of the parameter at which the sequence changes, in closed form; empty if unknown."""
    chain = study.subject
    if study.what != "cycle" or not isinstance(chain, Chain):
        return np.empty(0)
    own = [one for one in parameters(chain) if one.name == name]
    if not own or not all(isinstance(cell, Cell) for cell in chain.cells):
        return np.empty(0)
    # Boundaries are curves over two parameters; the second one is an anchor that hardly moves.
    other = next(one for one in parameters(chain) if one.part in ("q.x", "q.y") and one != own[0])
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
