"""Whether tension tests are of one kind of band, and which of them are not."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

# Bands of a kind scatter by 10 %, seldom by 15; two that lie further apart than this factor, with
# none between them, are of two kinds, or one of the runs is broken.
_APART = 1.4
# Rubber softens from cycle to cycle and never stiffens: by half in its first cycles, then by a few
# percent. Past these factors the next cycle is of another band.
_SOFTER_AT_FIRST, _SOFTER, _STIFFER = 4.0, 1.5, 1.3
_EARLY = 2
_ABOUT = 0.12  # between a factor and the count of bands that may explain it


class Run(NamedTuple):
    """A loading half and its stiffness in the window [N/m]."""

    sample: int
    cycle: int
    source: str
    stiffness: float


class Kind(NamedTuple):
    """Runs of bands that are alike: their median stiffness [N/m], and how many bands they are."""

    runs: tuple[Run, ...]
    stiffness: float
    bands: int


def kinds(runs: Iterable[Run]) -> tuple[Kind, ...]:
    """Runs sorted into kinds of bands, the kind of most bands first.

    The runs of a sample are one band as long as its stiffness only drifts from cycle to cycle.
    Bands are of one kind while no gap wider than a factor separates them.
    """
    by_sample: dict[int, list[Run]] = {}
    for run in runs:
        by_sample.setdefault(run.sample, []).append(run)
    bands = [band for sample in by_sample.values() for band in _one_band_each(sample)]
    stiff = sorted(((_typical(band), band) for band in bands), key=lambda one: one[0])
    groups: list[list[tuple[float, list[Run]]]] = []
    for one in stiff:
        if groups and _ratio(groups[-1][-1][0], one[0]) <= _APART:
            groups[-1].append(one)
        else:
            groups.append([one])
    found = [
        Kind(tuple(r for _, band in g for r in band), float(np.median([k for k, _ in g])), len(g))
        for g in groups
    ]
    return tuple(sorted(found, key=lambda kind: -kind.bands))


def differing(usual: Kind, other: Kind) -> str:
    """How the runs of a kind differ from the usual one, with their files."""
    ratio = other.stiffness / usual.stiffness
    files = listed([run.source for run in other.runs])
    if ratio <= 0:
        return f"{files}: {other.stiffness:.3g} N/m, which does not pull at all"
    factor = ratio if ratio > 1 else 1 / ratio
    times = f"{factor:.3g} times as {'stiff' if ratio > 1 else 'soft'}"
    whole = round(factor)
    hint = ""
    if 2 <= whole <= 4 and abs(factor / whole - 1) < _ABOUT:
        hint = (
            f" ({whole} bands in place of 1?)" if ratio > 1 else f" (1 band in place of {whole}?)"
        )
    return f"{files}: {other.stiffness:.4g} N/m, {times}{hint}"


def listed(names: Sequence[str]) -> str:
    """A few names, and how many more there are."""
    shown = ", ".join(name.replace("\\", "/").rpartition("/")[2] for name in names[:3])
    return shown + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _one_band_each(runs: list[Run]) -> list[list[Run]]:
    """The runs of a sample, parted where the next cycle cannot be of the same band."""
    ordered = sorted(runs, key=lambda run: run.cycle)
    parts = [[ordered[0]]]
    for before, run in pairwise(ordered):
        softer = _SOFTER_AT_FIRST if before.cycle < _EARLY else _SOFTER
        rises = run.stiffness > before.stiffness
        allowed = _STIFFER if rises else softer
        if _ratio(*sorted((before.stiffness, run.stiffness))) <= allowed:
            parts[-1].append(run)
        else:
            parts.append([run])
    return parts


def _typical(runs: list[Run]) -> float:
    """Median stiffness of a band, without its first cycle where it has others."""
    later = [run.stiffness for run in runs if run.cycle > 1]
    return float(np.median(later or [run.stiffness for run in runs]))


def _ratio(low: float, high: float) -> float:
    return high / low if low > 0 else (1.0 if high <= 0 else math.inf)
