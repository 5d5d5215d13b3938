"""First-order influence of each varied parameter on each result of a study."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.studies.store import PROBLEM, Study
from stepwell.studies.work import TEXT

# Least number of designs.
_LEAST = 50
# Probability that chance alone lifts any parameter above the floor.
_CHANCE = 0.05


class Influence(NamedTuple):
    """Influence of one parameter on a column.

    Attributes:
        name: name of the parameter.
        fraction: first-order fraction of the column's variance, from below 0 (by chance) to 1.
        trend: rank correlation (Spearman 1904), from -1 to 1.
    """

    name: str
    fraction: float
    trend: float


@dataclass(frozen=True, eq=False)
class DecidingNumbers(ByValue):
    """Influences of all parameters on a column.

    Attributes:
        column: its name.
        value: most frequent value of a column of words, whose occurrence is explained; "" for a
            column of numbers.
        designs: number of designs with a value.
        floor: fraction that chance exceeds for no parameter in 95 of 100 studies.
        influences: by falling fraction.
    """

    column: str
    value: str
    designs: int
    floor: float
    influences: tuple[Influence, ...] = field(repr=False)

    @property
    def sure(self) -> tuple[Influence, ...]:
        """Influences above the floor."""
        return tuple(one for one in self.influences if one.fraction > self.floor)

    def __repr__(self):
        names = ", ".join(f"{one.name} {one.fraction:.0%}" for one in self.sure[:3])
        what = f"{self.column} = {self.value}" if self.value else self.column
        return f"DecidingNumbers({what} by {names or 'none'}, of {self.designs} designs)"


def decided(study: Study) -> tuple[DecidingNumbers, ...]:
    """First-order influences of the varied parameters on every column of a study that differs.

    The values of a parameter are divided into classes of equal size, and a column's variance within
    the classes is compared with its total variance. Interactions are not included. The parameters
    must be varied independently, as by a grid or random draws. The result is empty for fewer than
    50 designs and for screened studies.

    Source: first-order indices from given data, Plischke, Borgonovo and Smith 2013; without the
    bias of few designs a class, Kelley 1935; the floor by the F distribution.
    """
    if study.work.screen:
        return ()
    chunks = study.done_chunks()
    varied = {name: study.values(name, chunks) for name in study.varied}
    results: list[DecidingNumbers] = []
    for name, unit in study.columns.items():
        # Columns of an atlas are JSON.
        if name in varied or (unit == TEXT and study.what == "atlas"):
            continue
        values = study.values(name, chunks)
        what = _of_text(name, values) if unit == TEXT else ("", values, np.isfinite(values))
        if one := _decided(name, *what, varied):
            results.append(one)
    return tuple(results)


def _of_text(column: str, values: Any) -> tuple[str, Floats, np.ndarray]:
    """The most frequent text, whether each design has it (n,), and which designs have a text."""
    words = [str(one) for one in values]
    if column == PROBLEM:
        words = [one.partition(":")[0] for one in words]
    counts = Counter(one for one in words if one)
    common = max(sorted(counts), key=counts.__getitem__, default="")
    # An empty text means no problem in the column of problems, and a missing value in others.
    known = np.array([column == PROBLEM or one != "" for one in words])
    return common, np.array([one == common for one in words], float), known


def _decided(
    column: str, value: str, y: Floats, known: np.ndarray, varied: dict[str, Floats]
) -> DecidingNumbers | None:
    from scipy.stats import f as fisher

    known = np.logical_and.reduce([known, *(np.isfinite(x) for x in varied.values())])
    y, n = y[known], int(known.sum())
    if n < _LEAST or not varied or np.ptp(y) <= 1e-12 * np.max(np.abs(y)):
        return None
    influences, floors = list[Influence](), list[float]()
    for name, x in varied.items():
        fraction, classes = explained(x[known], y)
        influences.append(Influence(name, fraction, _trend(x[known], y)))
        if classes > 1:
            chance = fisher.ppf(1 - _CHANCE / len(varied), classes - 1, n - classes)
            odds = (classes - 1) / (n - classes) * chance
            floors.append(float(1 - (n - 1) / (n - classes) / (1 + odds)))
    influences.sort(key=lambda one: -one.fraction)
    return DecidingNumbers(column, value, n, float(max(floors, default=0.0)), tuple(influences))


def explained(x: Floats, y: Floats) -> tuple[float, int]:
    """First-order fraction of the variance of y (n,) by x (n,), and the number of classes."""
    from scipy.stats import rankdata

    n = len(x)
    # More classes resolve a curve better, but contain fewer designs each.
    most = round(n ** (1 / 3))
    levels, of = np.unique(x, return_inverse=True)
    if len(levels) > most:
        # Equal values are in one class: that of the first of them.
        of = (rankdata(x, method="min").astype(int) - 1) * most // n
    counts = np.bincount(of)
    classes = int(np.count_nonzero(counts))
    centred = y - y.mean()
    sums = np.bincount(of, centred)[counts > 0]
    between, all_of_it = float(np.sum(sums**2 / counts[counts > 0])), float(centred @ centred)
    if classes < 2 or all_of_it == 0.0:
        return 0.0, classes
    within = max(all_of_it - between, 0.0) / (n - classes)
    return 1.0 - within / (all_of_it / (n - 1)), classes


def _trend(x: Floats, y: Floats) -> float:
    from scipy.stats import rankdata

    a, b = (rankdata(one) - (len(one) + 1) / 2 for one in (x, y))
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size else 0.0
