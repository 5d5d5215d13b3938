"""Observed behaviour of a build, and random builds with that behaviour, also with wrong holes."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell import base, sequences
from stepwell.design import Draws, Parameter, parameters
from stepwell.lab.recordings.curve import from_zero
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.mechanism import Chain

WAYS: tuple[base.Vec2, ...] = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
_COUNTS = {1: "one hole", 2: "two holes", 3: "three holes"}


@dataclass(frozen=True)
class Holes:
    """Prior of wrong holes in a build, with holes `apart` from each other [m].

    A motion depends on d = q - p alone, so a cell has one shift, of its q. A wrong hole of p is the
    opposite shift. `chance` is the probability that an anchor is one hole off, along x or y.
    """

    anchors: tuple[Parameter, ...]
    apart: float
    chance: float

    @property
    def _drawn(self) -> float:
        """Fraction of wrong holes among random builds: about one cell per build."""
        return 1.0 / (1.0 + len(self.anchors))

    def shifts(self, even: base.Floats) -> base.Floats:
        """(cells, 2) shift of q of each cell [m], for uniform numbers (cells,) from 0 to 1."""
        shifts = np.zeros((len(even), 2))
        wrong = even < self._drawn
        way = (even[wrong] / self._drawn * len(WAYS)).astype(int)
        shifts[wrong] = self.apart * np.array(WAYS)[np.minimum(way, len(WAYS) - 1)]
        return shifts

    def price(self, even: base.Floats) -> float:
        """Minus the logarithm of prior over sampling probability of these holes."""
        if not len(even):
            return 0.0
        off = 2.0 * self.chance  # either of two anchors
        wrong = int(np.sum(even < self._drawn))
        penalty = wrong * math.log(self._drawn / off) if wrong else 0.0
        return penalty + (len(even) - wrong) * math.log((1.0 - self._drawn) / (1.0 - off))

    def moved(self, chain: Chain, shifts: base.Floats) -> Chain:
        """The chain with its anchors in other holes."""
        for anchor, (dx, dy) in zip(self.anchors, shifts.tolist(), strict=True):
            if dx or dy:
                chain = anchor.displaced(chain, (dx, dy))
        return chain


@dataclass(frozen=True, eq=False)
class WrongHole(base.ByValue):
    """An anchor that may be one hole off.

    Attributes:
        anchor: q of a cell; the opposite shift of p has the same effect.
        was, to: nominal and possible position for its first band [m].
        fraction: fraction of the agreeing builds with this position.
    """

    anchor: Parameter
    was: base.Vec2
    to: base.Vec2
    fraction: float

    def of(self, chain: Chain) -> Chain:
        """The chain with this anchor in that hole."""
        return moved(chain, self.anchor, self.was, self.to)

    def __str__(self):
        return f"{named(self.anchor)} is {move_in_words(self.was, self.to, 1)}"

    def __repr__(self):
        return f"WrongHole({self}: {base.percent(self.fraction)})"


def outer_anchors(chain: Chain) -> tuple[Parameter, ...]:
    """q of every cell that has anchors."""
    return tuple(one for one in parameters(chain) if one.part == "q")


def place_of(anchor: Parameter, chain: Chain) -> base.Vec2:
    """Position of an anchor of the first band [m]."""
    x, y = np.asarray(anchor.value(chain), float).tolist()
    return x, y


def moved(chain: Chain, anchor: Parameter, was: base.Vec2, to: base.Vec2) -> Chain:
    """The chain with an anchor moved by the way from one place to another [m]."""
    return anchor.displaced(chain, (to[0] - was[0], to[1] - was[1]))


def named(anchor: Parameter) -> str:
    """Name of an anchor in words."""
    cell, _, part = anchor.name.rpartition(".")
    return f"{part} of {cell}"


def move_in_words(was: base.Vec2, to: base.Vec2, holes: int) -> str:
    """A move by a number of holes in words; +x is outwards, away from the block."""
    dx, dy = to[0] - was[0], to[1] - was[1]
    if abs(dx) > abs(dy):
        return f"{_COUNTS[holes]} {'outwards' if dx > 0 else 'inwards'}"
    return f"{_COUNTS[holes]} along {'+y' if dy > 0 else '-y'}"


# Number of compared forces per direction; a larger number is not more independent.
_PLACES = 12
# Least fraction of the stroke that a recording of this design covers.
_REACH = 0.5


class Pull(NamedTuple):
    """The force of the actuator [N] at a stroke from state 0 on [m], positive where it pulls.

    `direction` is +1 while loading, -1 while unloading.
    """

    direction: int
    stroke: float
    force: float


@dataclass(frozen=True, eq=False, repr=False)
class Observed(base.ByValue):
    """Observed behaviour of a build in one cycle of loading and unloading.

    Args:
        sequence: state sequence, such as "00>10>11>01>00"; None if unknown.
        out, back: strokes of the snaps in loading and in unloading [m]; None if unknown, empty for
            no snap.
        pulls: forces at some strokes.
        ruler, scale: standard deviation of a stroke [m] and of a force [N].

    Raises:
        ValueError: there is no observation, or a standard deviation is not above zero.
    """

    sequence: str | None = None
    out: tuple[float, ...] | None = None
    back: tuple[float, ...] | None = None
    pulls: tuple[Pull, ...] = ()
    ruler: float = 1e-3
    scale: float = 0.02

    def __post_init__(self):
        if self.sequence is None and self.out is None and self.back is None and not self.pulls:
            raise base.InputError(
                "no observation is given: pass states, strokes of snaps, or forces at some strokes."
            )
        for name in ("ruler", "scale"):
            if not 0 < (value := getattr(self, name)) < math.inf:
                raise base.InputError(f"{name} = {value}: must be > 0, a standard deviation.")

    @property
    def numbers(self) -> int:
        """Number of observed strokes and forces."""
        return len(self.out or ()) + len(self.back or ()) + len(self.pulls)

    def misfit(self, cycle: sequences.Cycle) -> float:
        """Half the sum of squared errors in standard deviations; infinite for another motion.

        Another number of snaps is another motion; so is a tie, whose outcome is undecided.
        """
        if self.sequence is not None and str(cycle.sequence) != self.sequence:
            return math.inf
        gaps: list[base.Floats] = []
        for direction, observed in ((1, self.out), (-1, self.back)):
            if observed is not None:
                snaps = sorted(e.drive for e in cycle.snaps if e.direction == direction)
                if len(snaps) != len(observed):
                    return math.inf
                gaps.append(np.subtract(snaps, sorted(observed)) / self.ruler)
        if self.pulls:
            off = _forces(cycle, self.pulls) - [pull.force for pull in self.pulls]
            gaps.append(off / self.scale)
        return sum((0.5 * float(gap @ gap) for gap in gaps), 0.0)


def _forces(cycle: sequences.Cycle, pulls: tuple[Pull, ...]) -> base.Floats:
    stroke, force = cycle.path.stroke, cycle.path.force
    top = int(np.argmax(stroke))
    ways = {1: (stroke[: top + 1], force[: top + 1]), -1: (stroke[top:][::-1], force[top:][::-1])}
    return np.array([np.interp(pull.stroke, *ways[pull.direction]) for pull in pulls])


def pulls_of(recording: Recording, full: float) -> tuple[Pull, ...]:
    """Forces of a recording at even strokes, each the mean of the samples around it.

    `full` is the stroke with every cell at state 1 [m].

    Raises:
        LabError: its stroke is below half or above 1.5 times that stroke.
    """
    stroke = from_zero(recording, full)
    reached = float(np.ptp(stroke))
    if not _REACH * full <= reached <= (1.0 + _REACH) * full:
        raise LabError(
            recording.source,
            f"its stroke is {base.to_unit(reached, 'mm'):.4g} mm and that of the design "
            f"{base.to_unit(full, 'mm'):.4g} mm: check the unit in the header, and that this "
            "design was tested.",
        )
    edges = np.linspace(0.0, full, _PLACES + 1)
    pulls: list[Pull] = []
    for half in recording.halves:
        direction = 1 if recording.direction_of(half) == "loading" else -1
        place = np.digitize(stroke[half], edges) - 1
        for k in np.intersect1d(place, np.arange(_PLACES)):
            here = place == k
            u, force = stroke[half][here], recording.force[half][here]
            pulls.append(Pull(direction, float(np.mean(u)), float(np.mean(force))))
    return tuple(pulls)


# Random steps after each generation, and largest number of generations.
STEPS, _GENERATIONS = 2, 20
# Target acceptance rate of the steps; the step size is adapted to it.
_TAKEN = 0.3
# Fractions of n builds that should have, and must have, the observed motion; largest number of
# draws over n. Below a quarter of n distinct builds, 4 times as many steps are made.
_PLENTY, _FEW, _ROUNDS, _FAMILY, _MORE = 0.06, 0.02, 8, 0.25, 4
# Fraction of the steps that also draw a new hole for one anchor; equally many do so for all.
_REHOOKED = 0.15


@dataclass(frozen=True)
class Population:
    """Equally probable builds that agree with the observations.

    Attributes:
        misfits, shifts: (n,) as `Observed.misfit`, and (n, cells, 2) of q to another hole [m].
        before, weights: builds before the observations, and their probabilities.
        fraction: probability of the observed motion before the observations.
        few: whether too few builds had the observed motion.
    """

    built: list[Chain]
    misfits: base.Floats
    shifts: base.Floats
    before: list[Chain]
    weights: base.Floats
    fraction: float
    few: bool


def population(
    draws: Draws, holes: Holes, observed: Observed, n: int, count: Callable[[], None]
) -> Population | None:
    """n random builds given the observations; None if no drawn build has the observed motion.

    Sequential Monte Carlo: observations and the prior of wrong holes get more weight in every
    generation. Builds are resampled by weight, and each then makes some Metropolis steps.

    Source: Del Moral, Doucet and Jasra 2006.
    """
    none = np.zeros((0, draws.columns + len(holes.anchors)))
    sampler = _BuildSampler(draws, holes, observed, count, np.random.default_rng(draws.seed), none)
    fits = sampler.begin(n)
    if not np.any(fits):
        return None
    likely = np.exp([-one.price for one in sampler.made])
    whole = np.array([one.chain is not None for one in sampler.made])
    before = [one.chain for one in sampler.made if one.chain is not None]
    fraction, fit = float(np.sum(likely[fits]) / np.sum(likely)), np.flatnonzero(fits)
    sampler.take(fit[np.arange(n) % len(fit)])
    counts = 0.0
    steps = STEPS * (_MORE if len(fit) < _FAMILY * n else 1)
    for generation in range(_GENERATIONS):
        cost = np.array([one.cost for one in sampler.made])
        left = 1.0 - counts
        more = left if generation == _GENERATIONS - 1 else _exponent_step(cost, left)
        counts += more
        sampler.take(_resampled(np.exp(np.min(cost) - cost) ** more, sampler.random))
        sampler.walk(counts, steps)
        if counts >= 1.0:
            break
    return Population(
        [one.chain for one in sampler.made if one.chain is not None],
        np.array([one.misfit for one in sampler.made]),
        np.array([holes.shifts(row[draws.columns :]) for row in sampler.even]),
        before,
        likely[whole] / np.sum(likely[whole]),
        fraction,
        len(fit) < _FEW * n,
    )


class _TriedBuild(NamedTuple):
    """A trial build with its misfit; its chain is None if it cannot be built."""

    chain: Chain | None
    misfit: float
    price: float

    @property
    def cost(self) -> float:
        """Minus the logarithm of its probability given the observations."""
        return self.misfit + self.price


@dataclass
class _BuildSampler:
    """Builds and their uniform numbers (n, columns): first parameters, then holes."""

    draws: Draws
    holes: Holes
    observed: Observed
    count: Callable[[], None]
    random: np.random.Generator
    even: base.Floats
    made: list[_TriedBuild] = field(default_factory=list)
    far: float = 1.0  # step size over the standard deviation of the builds

    def tried(self, row: base.Floats) -> _TriedBuild:
        """The build of one row and its misfit."""
        self.count()
        parts, holes = np.split(row, [self.draws.columns])
        price = self.holes.price(holes)
        try:
            chain = self.draws.built(self.draws.shaped(parts[None].copy())[0])
            chain = self.holes.moved(chain, self.holes.shifts(holes))
            return _TriedBuild(chain, self.observed.misfit(chain.cycle()), price)
        except base.StepwellError:
            return _TriedBuild(None, math.inf, price)

    def begin(self, n: int) -> base.Bools:
        """Draw until enough builds have the observed motion; mask of these."""
        fits = np.zeros(0, bool)
        for _ in range(_ROUNDS):
            more = self.random.random((n, self.even.shape[1]))
            self.even = np.concatenate([self.even, more])
            self.made += [self.tried(row) for row in more]
            fits = np.isfinite([one.misfit for one in self.made])
            if np.sum(fits) >= _PLENTY * n:
                break
        return fits

    def take(self, places: base.Ints) -> None:
        """Keep the builds at these indices; an index may occur several times."""
        self.even, self.made = self.even[places], [self.made[k] for k in places]

    def walk(self, counts: float, steps: int) -> None:
        """Make random steps; `counts` is the weight of the observations, from 0 to 1."""
        n = len(self.made)
        spread = np.std(self.even, axis=0)
        spread[self.draws.columns :] = 0.0
        for _ in range(steps):
            there = self.neighbours(spread)
            taken = 0
            for k, draw in enumerate(self.random.random(n)):
                one = self.tried(there[k])
                if draw < math.exp(min(0.0, counts * (self.made[k].cost - one.cost))):
                    self.made[k], self.even[k] = one, there[k]
                    taken += 1
            self.far = min(max(self.far * math.exp(taken / n - _TAKEN), 0.02), 2.0)

    def neighbours(self, spread: base.Floats) -> base.Floats:
        """Random numbers near those of each build; some anchors get another hole."""
        n, columns = len(self.even), len(self.holes.anchors)
        step = self.far * spread * self.random.standard_normal(self.even.shape)
        # Reflected at 0 and 1.
        there = np.mod(self.even + step, 2.0)
        there = np.minimum(there, 2.0 - there)
        if columns:
            draw, other = self.random.random(n), self.random.random((n, columns))
            one = np.arange(columns) == self.random.integers(columns, size=(n, 1))
            new = (draw < 2 * _REHOOKED)[:, None] & (one | (draw < _REHOOKED)[:, None])
            there[:, self.draws.columns :][new] = other[new]
        return there


def _exponent_step(misfits: base.Floats, most: float) -> float:
    """Largest step of the weight for which the effective number of builds stays above half."""

    def effective(more: float) -> float:
        weights = np.exp(more * (np.min(misfits) - misfits))
        return float(np.sum(weights) ** 2 / np.sum(weights**2)) / len(misfits)

    if effective(most) >= 0.5:
        return most
    return max(base.bisected(lambda more: effective(more) >= 0.5, 0.0, most, 40)[0], 1e-6)


def _resampled(weights: base.Floats, random: np.random.Generator) -> base.Ints:
    """Indices drawn by weight, with systematic resampling."""
    n = len(weights)
    places = np.cumsum(weights) / np.sum(weights)
    return np.minimum(np.searchsorted(places, (np.arange(n) + random.random()) / n), n - 1)
