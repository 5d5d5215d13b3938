"""Builds that do what was seen, drawn at random: the more likely one is, the more there are."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints, StepwellError
from stepwell.design import Draws
from stepwell.lab.as_built.holes import Holes
from stepwell.lab.as_built.observed import Observed
from stepwell.mechanism import Chain

# Steps after each generation, and how many generations at most.
STEPS, _GENERATIONS = 2, 20
# Of the steps so many should be taken: fewer go too far, more not far enough.
_TAKEN = 0.3
# Of n builds so many should move as was seen, and so many must; up to so many times n are drawn.
# What descends from less than a quarter of n goes more steps, so that it is no family.
_PLENTY, _FEW, _ROUNDS, _FAMILY, _MORE = 0.06, 0.02, 8, 0.25, 4
# Of the steps so many try another hole for one anchor too, and as many for all.
_REHOOKED = 0.15


@dataclass(frozen=True)
class Population:
    """Builds, each as likely as the others.

    Attributes:
        built: n of them.
        misfits: (n,) how badly each agrees, as `Observed.misfit`.
        shifts: (n, cells, 2) by how much q of each cell is in another hole [m].
        before, weights: those before anything was seen, and how likely each is.
        share: of those before, how many moved as was seen, whatever its strokes and forces.
        few: whether fewer moved so than are needed to draw from.
    """

    built: list[Chain]
    misfits: Floats
    shifts: Floats
    before: list[Chain]
    weights: Floats
    share: float
    few: bool


def population(
    draws: Draws, holes: Holes, observed: Observed, n: int, tell: Callable[[], None]
) -> Population | None:
    """Builds given what was seen of one; None where of n none moves so.

    What was seen counts little at first and more in every generation: the better ones are taken
    more often, and all then go some steps at random, among those that are as likely. So it is with
    how unlikely wrong holes are, of which more are drawn at first than there are.

    Args:
        draws: what builds may be before anything was seen.
        holes: where their anchors may be by mistake.
        observed: what was seen.
        n: how many.
        tell: called for every one that is tried.

    Source: Del Moral, Doucet and Jasra 2006.
    """
    random = np.random.default_rng(draws.seed)
    parts = draws.columns

    def tried(row: Floats) -> _Tried:
        tell()
        price = holes.price(row[parts:]) if holes.columns else 0.0
        try:
            chain = draws.built(draws.shaped(row[None, :parts].copy())[0])
            if holes.columns:
                chain = holes.moved(chain, holes.shifts(row[parts:]))
            return _Tried(chain, observed.misfit(chain.cycle()), price)
        except StepwellError:
            return _Tried(None, math.inf, price)

    even, made, fits = np.zeros((0, parts + holes.columns)), list[_Tried](), np.zeros(0, bool)
    for _ in range(_ROUNDS):
        more = random.random((n, parts + holes.columns))
        even, made = np.concatenate([even, more]), made + [tried(row) for row in more]
        fits = np.isfinite([one.misfit for one in made])
        if np.sum(fits) >= _PLENTY * n:
            break
    if not np.any(fits):
        return None
    likely = np.exp([-one.price for one in made])
    whole = np.array([one.chain is not None for one in made])
    before = [one.chain for one in made if one.chain is not None]
    share, fit = float(np.sum(likely[fits]) / np.sum(likely)), np.flatnonzero(fits)

    def take(places: Ints) -> None:
        nonlocal even, made
        even, made = even[places], [made[k] for k in places]

    take(fit[np.arange(n) % len(fit)])
    counts, far = 0.0, 1.0
    steps = STEPS * (_MORE if len(fit) < _FAMILY * n else 1)
    for generation in range(_GENERATIONS):
        worse = np.array([one.worse for one in made])
        more = 1.0 - counts if generation == _GENERATIONS - 1 else _more(worse, 1.0 - counts)
        counts += more
        take(_chosen(np.exp(np.min(worse) - worse) ** more, random))
        spread = np.std(even, axis=0)
        spread[parts:] = 0.0
        for _ in range(steps):
            there = _within(even + far * spread * random.standard_normal(even.shape))
            if holes.columns:
                luck, other = random.random(n), random.random((n, holes.columns))
                one = np.arange(holes.columns) == random.integers(holes.columns, size=(n, 1))
                new = (luck < 2 * _REHOOKED)[:, None] & (one | (luck < _REHOOKED)[:, None])
                there[:, parts:][new] = other[new]
            luck, taken = random.random(n), 0
            for k in range(n):
                one = tried(there[k])
                if luck[k] < math.exp(min(0.0, counts * (made[k].worse - one.worse))):
                    made[k], even[k] = one, there[k]
                    taken += 1
            far = min(max(far * math.exp(taken / n - _TAKEN), 0.02), 2.0)
        if counts >= 1.0:
            break
    cells = len(holes.anchors)
    return Population(
        [one.chain for one in made if one.chain is not None],
        np.array([one.misfit for one in made]),
        np.array([holes.shifts(row[parts:]) for row in even])
        if holes.columns
        else np.zeros((n, cells, 2)),
        before,
        likely[whole] / np.sum(likely[whole]),
        share,
        len(fit) < _FEW * n,
    )


class _Tried(NamedTuple):
    """One build that was tried: None where it cannot be built."""

    chain: Chain | None
    misfit: float
    price: float

    @property
    def worse(self) -> float:
        """Minus the logarithm of how likely it is, given what was seen."""
        return self.misfit + self.price


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
