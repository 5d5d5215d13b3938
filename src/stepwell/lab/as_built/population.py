"""Builds that do what was seen, drawn at random: the more likely one is, the more there are."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats, Ints, StepwellError
from stepwell.design import Draws
from stepwell.lab.as_built.observed import Observed
from stepwell.mechanism import Chain

# Steps after each generation, and how many generations at most.
STEPS, _GENERATIONS = 2, 20
# Of the steps so many should be taken: fewer go too far, more not far enough.
_TAKEN = 0.3


@dataclass(frozen=True)
class Population:
    """Builds, each as likely as the others.

    Attributes:
        built: n of them.
        misfits: (n,) how badly each agrees, as `Observed.misfit`.
        before: n before anything was seen.
        share: of those before, how many moved as was seen, whatever its strokes and forces.
    """

    built: list[Chain]
    misfits: Floats
    before: list[Chain]
    share: float


def population(
    draws: Draws, observed: Observed, n: int, tell: Callable[[], None]
) -> Population | None:
    """Builds given what was seen of one; None where of n none moves so.

    What was seen counts little at first and more in every generation: the better ones are taken
    more often, and all then go some steps at random, among those that are as likely.

    Args:
        draws: what builds may be before anything was seen.
        observed: what was seen.
        n: how many.
        tell: called for every one that is tried.

    Source: Del Moral, Doucet and Jasra 2006.
    """
    random = np.random.default_rng(draws.seed)
    even = random.random((n, draws.columns))
    made = [_tried(draws, row, observed, tell) for row in even]
    misfits = np.array([misfit for _, misfit in made])
    fit = np.flatnonzero(np.isfinite(misfits))
    before = [chain for chain, _ in made if chain is not None]
    if not len(fit):
        return None
    built = [chain for chain, _ in made]

    def take(places: Ints) -> None:
        nonlocal even, built, misfits
        even, misfits = even[places], misfits[places]
        built = [built[k] for k in places]

    take(fit[np.arange(n) % len(fit)])
    counts, far = 0.0, 1.0
    for generation in range(_GENERATIONS):
        more = 1.0 - counts if generation == _GENERATIONS - 1 else _more(misfits, 1.0 - counts)
        counts += more
        take(_chosen(np.exp(np.min(misfits) - misfits) ** more, random))
        spread = np.std(even, axis=0)
        for _ in range(STEPS):
            there = _within(even + far * spread * random.standard_normal(even.shape))
            luck, taken = random.random(n), 0
            for k in range(n):
                chain, misfit = _tried(draws, there[k], observed, tell)
                if luck[k] < math.exp(min(0.0, counts * (misfits[k] - misfit))):
                    built[k], misfits[k], even[k] = chain, misfit, there[k]
                    taken += 1
            far = min(max(far * math.exp(taken / n - _TAKEN), 0.02), 2.0)
        if counts >= 1.0:
            break
    return Population([one for one in built if one is not None], misfits, before, len(fit) / n)


def _tried(
    draws: Draws, row: Floats, observed: Observed, tell: Callable[[], None]
) -> tuple[Chain | None, float]:
    tell()
    try:
        chain = draws.built(draws.shaped(row[None].copy())[0])
        return chain, observed.misfit(chain.cycle())
    except StepwellError:
        return None, math.inf


def _more(misfits: Floats, most: float) -> float:
    """By how much more what was seen may count for half of them to stay."""

    def kept(more: float) -> float:
        weights = np.exp(more * (np.min(misfits) - misfits))
        return float(np.sum(weights) ** 2 / np.sum(weights**2)) / len(misfits)

    if kept(most) >= 0.5:
        return most
    low, high = 0.0, most
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if kept(middle) >= 0.5 else (low, middle)
    return max(low, 1e-6)


def _chosen(weights: Floats, random: np.random.Generator) -> Ints:
    """As many of each as its weight says, by even steps from a random start."""
    n = len(weights)
    steps = (np.arange(n) + random.random()) / n
    places = np.searchsorted(np.cumsum(weights) / np.sum(weights), steps)
    return np.minimum(places, n - 1)


def _within(even: Floats) -> Floats:
    """Numbers brought back between 0 and 1 as by mirrors there."""
    folded = np.mod(even, 2.0)
    return np.where(folded > 1.0, 2.0 - folded, folded)
