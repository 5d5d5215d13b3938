"""Results of tension tests: stiffness, its dependence on the window, losses, force laws."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from stepwell.base import ByValue, Drawn, InputError, grouped
from stepwell.lab.bands.band import BandTest, stiffness, stiffness_grid
from stepwell.lab.bands.choice import Candidate, Choice, Interval, this_band
from stepwell.lab.bands.halves import Estimate, of_samples


class WindowStiffness(NamedTuple):
    """Stiffness [N/m] of the line between two strokes [m]."""

    start: float
    end: float
    stiffness: float


class OneBand(NamedTuple):
    """Number of readings, stiffness [N/m] and, if known, rest length [m] of one band."""

    readings: int
    stiffness: Interval
    rest_length: Interval | None


@dataclass(frozen=True, eq=False)
class BandFit(ByValue, Drawn):
    """Tension tests and their results.

    Attributes:
        choice: the compared force laws.
        written: the law for a design file.
        stiffness: of the line through the window [N/m].
        loss: fraction of the loading work lost in a cycle [1]; None without unloading.
        alone: result for a single tested band; None for several.
        windows: the stiffness in other windows.
    """

    test: BandTest
    choice: Choice
    written: Candidate = field(repr=False)
    stiffness: Estimate
    loss: Estimate | None = field(repr=False)
    alone: OneBand | None = field(repr=False)
    windows: tuple[WindowStiffness, ...] = field(repr=False)


def fit_bands(test: BandTest, choice: Choice, law: str | None = None) -> BandFit:
    """Stiffness, losses and force law of bands; `law` is for the design file.

    By default it is the chosen law.

    Raises:
        ValueError: the law is unknown.
    """
    known = {candidate.law.name: candidate for candidate in choice.candidates}
    if law is not None and law not in known:
        raise InputError(f"law = {law!r}: must be one of {', '.join(known)}.")
    losses = grouped((loop.sample, loop.loss) for loop in test.used if not math.isnan(loop.loss))
    edges, grid = stiffness_grid(test)
    return BandFit(
        test,
        choice,
        choice.chosen if law is None else known[law],
        stiffness(test),
        of_samples({s: sum(v) / len(v) for s, v in losses.items()}) if losses else None,
        _one_band(test, choice),
        tuple(
            WindowStiffness(float(low), float(high), float(k))
            for low, row in zip(edges, grid, strict=True)
            for high, k in zip(edges, row, strict=True)
            if not math.isnan(k)
        ),
    )


def _one_band(test: BandTest, choice: Choice) -> OneBand | None:
    if (band := this_band(test, choice)) is None:
        return None
    (slope, onset), gauge = band, choice.gauge
    length = None if gauge is None else Interval(*(gauge + edge for edge in onset))
    return OneBand(len(test.samples_of(test.samples[0], test.window)[0]), slope, length)
