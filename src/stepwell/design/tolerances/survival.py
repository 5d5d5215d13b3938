"""Yield of a stroke program: fraction of samples that end in the target state."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from stepwell.base import ONE_BY_ONE, InputError, Progress, require, tracked
from stepwell.design.tolerances.draws import (
    DEFAULT_TOLERANCES,
    Draws,
    Tolerances,
    frictionless,
    validate,
)
from stepwell.design.tolerances.tally import Counted, sampling_text
from stepwell.mechanism import Chain, SlipError, Stretch, sizes
from stepwell.sequences import checked_state
from stepwell.statics import StaticsError, drive_range


@dataclass(frozen=True, eq=False)
class Survival(Counted):
    """Number of random samples within tolerances that a program brings to the target state.

    Attributes:
        chain, tolerances: the nominal design and its tolerances.
        turning_points: drives of the program [m], or [N] under force control.
        start, target: states at its beginning and at its end.
        samples, seed: number of samples, and random seed.
        fraction, interval: successes over samples, and the 95 % confidence interval of the
            probability (Clopper & Pearson 1934).
        successes: samples that end with every cell in, or nearest to, its phase in `target`.
    """

    turning_points: tuple[float, ...]
    start: str
    target: str

    @property
    def assumptions(self) -> str:
        """Assumptions of the yield."""
        assumed = (
            sampling_text(self.chain),
            "failed samples count as failures",
            frictionless(self.tolerances, self.chain),
        )
        return "; ".join(filter(None, assumed))

    def __repr__(self):
        low, high = self.interval
        return (
            f"Survival({self.start} to {self.target}: {100 * self.fraction:.1f} % of "
            f"{self.samples}, {100 * low:.1f} % to {100 * high:.1f} %, {self.tolerances!r})"
        )


def survival(
    chain: Chain,
    turning_points: Sequence[float],
    target: str,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    *,
    start: str | None = None,
    samples: int | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> Survival:
    """Compute the yield of a stroke program from random samples within tolerances.

    All else as for `Chain.survival`.
    """
    start = checked_state(chain, "start", chain.first_state if start is None else start)
    checked_state(chain, "target", target)
    samples = ONE_BY_ONE if samples is None else samples
    if samples < 1:
        raise InputError(f"samples = {samples}: must be 1 or more.")
    require("samples", samples, "samples =")
    validate(tolerances, chain)
    slips = sizes.drives(chain, turning_points)
    if slips:
        raise SlipError(slips, "")
    points = tuple(float(point) for point in turning_points)
    successes = count_ends(Draws(chain, tolerances, seed), points, start, target, samples, progress)
    counted = {"chain": chain, "tolerances": tolerances, "samples": samples, "seed": seed}
    return Survival(points, start, target, successes=successes, **counted)


def count_ends(
    draws: Draws, points: tuple[float, ...], start: str, end: str, n: int, progress: Progress = None
) -> int:
    """Number of the first n samples that a program brings to its target state."""
    successes = 0
    for number in tracked(range(n), progress):
        with suppress(ValueError, StaticsError):
            successes += ends_right(draws.sample(number), points, start, end)
    return successes


def ends_right(sample: Chain, points: tuple[float, ...], start: str, ends: str) -> bool:
    """Whether a program, its points [m] or [N], ends with every cell in or nearest to its phase."""
    if math.isinf(sample.actuator_stiffness):
        if not sample.elements:
            full = sample.full_travels
            begin = math.fsum(f for f, c in zip(full, start, strict=True) if c == "1")
            points = (begin, *points[1:])
        low, high = drive_range(sample)
        points = (points[0], *(min(max(point, low), high) for point in points[1:]))
    path = sample.path(points, start=start)
    ending = zip(sample.stretches, path.end_sheet, path.end.tolist(), ends, strict=True)
    return all(_nearest(own, sheet, travel) == int(digit) for own, sheet, travel, digit in ending)


def _nearest(stretches: tuple[Stretch, ...], sheet: int, travel: float) -> int:
    """The number of the phase nearest to a place [m], of those on its sheet if there are any."""
    away = [(own != sheet, max(low - travel, travel - high)) for own, low, high in stretches]
    return away.index(min(away))
