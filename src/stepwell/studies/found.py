"""Summary of a study: frequencies of outcomes and ranges of numbers."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.design import Fraction, fraction_of
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
