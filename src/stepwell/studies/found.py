"""What a study has found so far: how often each outcome occurs, the range of every number."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.design import Share, share_of
from stepwell.studies.designs import How
from stepwell.studies.store import PROBLEM, Study
from stepwell.studies.work import SCREEN_COLUMNS, TEXT

# Of a column of words so many of the most frequent values are counted.
_VALUES = 20


class Varied(NamedTuple):
    """A number that differs from design to design, between two values in a unit, "" for a ratio.

    The ends of what is not bounded, such as samples, are those so far; None before any design.
    """

    parameter: str
    unit: str
    low: float | None
    high: float | None


class Frequency(NamedTuple):
    """How often a column of words has one of its most frequent values.

    The share is of the designs that have a value; of a screened study of those drawn at random. Its
    interval means nothing where the designs are no sample (`sampled`).
    """

    column: str
    value: str
    share: Share
    sampled: bool


class Extent(NamedTuple):
    """The values of a column of numbers, in a unit, "" for a ratio or a count.

    Of the `designs` that have a value; least, median and most are None where none has.
    """

    column: str
    unit: str
    least: float | None
    median: float | None
    most: float | None
    designs: int


def varied(study: Study) -> tuple[Varied, ...]:
    """What differs from design to design."""
    axes = {axis.name: (axis.low, axis.high) for axis in getattr(study.designs, "axes", ())}
    found: list[Varied] = []
    for name in study.varied:
        unit, factor = study.told(name)
        values = np.array(axes[name]) if name in axes else _finite(study, name)
        ends = [float(of(values)) * factor if len(values) else None for of in (np.min, np.max)]
        found.append(Varied(name, unit, *ends))
    return tuple(found)


def frequencies(study: Study) -> tuple[Frequency, ...]:
    """How often each outcome occurs, of every column of words the most frequent first."""
    if study.what == "atlas":
        # What an atlas counts is JSON.
        return ()
    sampled = study.designs.how not in (How.GRID, "listed")
    found: list[Frequency] = []
    for name in (name for name, unit in _found(study).items() if unit == TEXT):
        words = np.array([str(one) for one in study.values(name)], object)
        if study.work.screen:
            # Those that a screen chose are no sample of the designs; those drawn at random are.
            words = words[study.values("lot") == 1]
        counts = Counter(words.tolist())
        counts.pop("", None)
        of = sum(counts.values())
        often = sorted(counts.items(), key=lambda one: (-one[1], one[0]))[:_VALUES]
        found += [Frequency(name, value, share_of(n, of), sampled) for value, n in often]
    return tuple(found)


def extents(study: Study) -> tuple[Extent, ...]:
    """The range of every column of numbers that was found."""
    found: list[Extent] = []
    for name in (name for name, unit in _found(study).items() if unit != TEXT):
        unit, factor = study.told(name)
        values = _finite(study, name) * factor
        least, median, most = (
            float(of(values)) if len(values) else None for of in (np.min, np.median, np.max)
        )
        found.append(Extent(name, unit, least, median, most, len(values)))
    return tuple(found)


def _found(study: Study) -> dict[str, str]:
    """Unit of every column that was found, by its name."""
    others = {*study.varied, *SCREEN_COLUMNS, PROBLEM}
    return {name: unit for name, unit in study.columns.items() if name not in others}


def _finite(study: Study, name: str) -> Floats:
    values = study.values(name)
    return values[np.isfinite(values)]
