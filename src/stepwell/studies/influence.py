"""Which number decides what: how much of what a study found each number explains by itself."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.studies.store import PROBLEM, Study
from stepwell.studies.work import TEXT

# Designs below which nothing is said.
_LEAST = 50
# How often chance alone may lift any of the numbers above the floor.
_CHANCE = 0.05


class Influence(NamedTuple):
    """What one number decides of a column.

    Attributes:
        name: of the number.
        share: of the column's variance that it explains by itself, from below 0 (by chance) to 1.
        trend: rank correlation (Spearman 1904), from -1 to 1.
    """

    name: str
    share: float
    trend: float


@dataclass(frozen=True, eq=False)
class DecidingNumbers(ByValue):
    """Which numbers decide a column.

    Attributes:
        column: its name.
        value: of a column of words, the most frequent one: what is explained is whether a design
            does this. "" of a column of numbers.
        designs: that have a value.
        floor: a share that chance lifts none of the numbers above, in 95 of 100 studies.
        influences: by falling share.
    """

    column: str
    value: str
    designs: int
    floor: float
    influences: tuple[Influence, ...] = field(repr=False)

    @property
    def sure(self) -> tuple[Influence, ...]:
        """Those above the floor."""
        return tuple(one for one in self.influences if one.share > self.floor)

    def __repr__(self):
        told = ", ".join(f"{one.name} {one.share:.0%}" for one in self.sure[:3])
        what = f"{self.column} = {self.value}" if self.value else self.column
        return f"DecidingNumbers({what} by {told or 'none'}, of {self.designs} designs)"


def decided(study: Study) -> tuple[DecidingNumbers, ...]:
    """Which numbers decide what a study has found so far, of every column that differs.

    Every number's values are cut into classes of as many designs each, and a column's variance
    within them is compared with all of it. What numbers only do together is none's share. It takes
    for granted that the numbers were varied independently, as a grid and every draw vary them. Of
    fewer than 50 designs, and of those that a screen chose, nothing is said.

    Source: first-order indices from given data, Plischke, Borgonovo and Smith 2013; without the
    bias of few designs a class, Kelley 1935; the floor by the F distribution.
    """
    if study.work.screen:
        return ()
    chunks = study.done_chunks()
    varied = {name: study.values(name, chunks) for name in study.varied}
    found: list[DecidingNumbers] = []
    for name, unit in study.columns.items():
        # What an atlas counts is JSON.
        if name in varied or (unit == TEXT and study.what == "atlas"):
            continue
        values = study.values(name, chunks)
        what = _of_text(name, values) if unit == TEXT else ("", values, np.isfinite(values))
        if one := _decided(name, *what, varied):
            found.append(one)
    return tuple(found)


def _of_text(column: str, values: Any) -> tuple[str, Floats, np.ndarray]:
    """The most frequent text, whether each is that one, and which designs have a text."""
    words = [str(one) for one in values]
    if column == PROBLEM:
        words = [one.partition(":")[0] for one in words]
    counts = Counter(one for one in words if one)
    common = max(sorted(counts), key=counts.__getitem__, default="")
    # A design without a problem has none; an empty text in any other column is missing.
    known = np.array([column == PROBLEM or one != "" for one in words])
    return common, np.array([one == common for one in words], float), known


def _decided(
    column: str, value: str, y: Floats, told: np.ndarray, varied: dict[str, Floats]
) -> DecidingNumbers | None:
    from scipy.stats import f as fisher

    told = np.logical_and.reduce([told, *(np.isfinite(x) for x in varied.values())])
    y, n = y[told], int(told.sum())
    if n < _LEAST or not varied or np.ptp(y) <= 1e-12 * np.max(np.abs(y)):
        return None
    influences, floors = list[Influence](), list[float]()
    for name, x in varied.items():
        share, classes = explained(x[told], y)
        influences.append(Influence(name, share, _trend(x[told], y)))
        if classes > 1:
            chance = fisher.ppf(1 - _CHANCE / len(varied), classes - 1, n - classes)
            odds = (classes - 1) / (n - classes) * chance
            floors.append(float(1 - (n - 1) / (n - classes) / (1 + odds)))
    influences.sort(key=lambda one: -one.share)
    return DecidingNumbers(column, value, n, float(max(floors, default=0.0)), tuple(influences))


def explained(x: Floats, y: Floats) -> tuple[float, int]:
    """Share of the variance of y (n,) that x (n,) explains by itself, and by how many classes."""
    from scipy.stats import rankdata

    n = len(x)
    # More classes follow a curve more closely, and hold fewer designs each.
    most = round(n ** (1 / 3))
    levels, of = np.unique(x, return_inverse=True)
    if len(levels) > most:
        # Equal values are in one class, the one where the first of them is.
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
