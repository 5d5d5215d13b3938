"""What tension tests show of bands: stiffness, its dependence on the window, losses, force laws."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from stepwell.base import ByValue, Drawn, InputError, grouped
from stepwell.lab.bands.band import BandTest, stiffness, stiffness_grid
from stepwell.lab.bands.choice import Candidate, Choice, Interval, this_band
from stepwell.lab.bands.halves import Estimate, of_samples


class WindowStiffness(NamedTuple):
    """The stiffness of the line from one stroke [m] to another one [N/m]."""

    start: float
    end: float
    stiffness: float


class OneBand(NamedTuple):
    """Readings of one band, its stiffness [N/m], and its rest length [m] if that is known."""

    readings: int
    stiffness: Interval
    rest_length: Interval | None


@dataclass(frozen=True, eq=False)
class BandFit(ByValue, Drawn):
    """Tension tests with all that follows from them.

    Attributes:
        choice: the force laws that were tried.
        written: the law that a design file gets.
        stiffness: of the line through the window [N/m].
        loss: share of the loading work that a cycle loses [1]; None where no cycle unloads.
        alone: the one band that was tested; None for several.
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
    """Stiffness, losses and force law of bands; a design file gets `law`, by default the chosen
    one.

    Raises:
        ValueError: a law that is not known.
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
