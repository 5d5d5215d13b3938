"""What a build was seen to do, and builds drawn at random that do it, wrong holes among them."""

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
    """What is believed of the holes of a build before it is tried, `apart` [m] from each other.

    Of anchors a motion knows d = q - p alone, so a cell has one shift, of its q; a wrong hole of p
    is the opposite one. `chance` is that one of the anchors is one hole off, along x or y.
    """

    anchors: tuple[Parameter, ...]
    apart: float
    chance: float

    @property
    def _drawn(self) -> float:
        """The share of wrong holes among those drawn: of all cells about one."""
        return 1.0 / (1.0 + len(self.anchors))

    def shifts(self, even: base.Floats) -> base.Floats:
        """(cells, 2) by how much q of each cell is off [m], for numbers (cells,) from 0 to 1."""
        shifts = np.zeros((len(even), 2))
        wrong = even < self._drawn
        way = (even[wrong] / self._drawn * len(WAYS)).astype(int)
        shifts[wrong] = self.apart * np.array(WAYS)[np.minimum(way, len(WAYS) - 1)]
        return shifts

    def price(self, even: base.Floats) -> float:
        """By how much less likely these holes are than they are drawn: minus the logarithm."""
        if not len(even):
            return 0.0
        off = 2.0 * self.chance  # of two anchors either
        wrong = int(np.sum(even < self._drawn))
        penalty = wrong * math.log(self._drawn / off) if wrong else 0.0
        return penalty + (len(even) - wrong) * math.log((1.0 - self._drawn) / (1.0 - off))

    def moved(self, chain: Chain, shifts: base.Floats) -> Chain:
        """A chain with its anchors in other holes."""
        for anchor, (dx, dy) in zip(self.anchors, shifts.tolist(), strict=True):
            if dx or dy:
                chain = anchor.displaced(chain, (dx, dy))
        return chain


@dataclass(frozen=True, eq=False)
class WrongHole(base.ByValue):
    """An anchor that may be one hole off.

    Attributes:
        anchor: q of a cell; p the other way would do the same.
        was, to: where its first band has it on the drawing, and where it may be [m].
        share: of the builds that agree with what was seen, how many have it there.
    """

    anchor: Parameter
    was: base.Vec2
    to: base.Vec2
    share: float

    def __str__(self):
        return f"{named(self.anchor)} is {move_in_words(self.was, self.to, 1)}"

    def __repr__(self):
        return f"WrongHole({self}: {base.percent(self.share)})"


def outer_anchors(chain: Chain) -> tuple[Parameter, ...]:
    """q of every cell that has anchors."""
    return tuple(one for one in parameters(chain) if one.part == "q")


def place_of(anchor: Parameter, chain: Chain) -> base.Vec2:
    """Where the first band has an anchor [m]."""
    x, y = np.asarray(anchor.value(chain), float).tolist()
    return x, y


def named(anchor: Parameter) -> str:
    """An anchor in words."""
    cell, _, part = anchor.name.rpartition(".")
    return f"{part} of {cell}"


def move_in_words(was: base.Vec2, to: base.Vec2, holes: int) -> str:
    """How far from one place to another, in holes; along x q goes outwards, away from its block."""
    dx, dy = to[0] - was[0], to[1] - was[1]
    if abs(dx) > abs(dy):
        return f"{_COUNTS[holes]} {'outwards' if dx > 0 else 'inwards'}"
    return f"{_COUNTS[holes]} along {'+y' if dy > 0 else '-y'}"


# Forces of a recording that are compared, each way; more of them are no more independent.
_PLACES = 12
# Of the stroke, what a recording must reach over to be one of this design.
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
    """What a build did when it was pulled out and let back once.

    Args:
        sequence: the states it went through, such as "00>10>11>01>00"; None if it is not known.
        out, back: strokes at which it snapped while it was pulled out and let back [m]; None if
            they are not known, empty where it did not snap.
        pulls: forces that were read on the way.
        ruler, scale: standard deviation of a stroke [m] and of a force [N].

    Raises:
        ValueError: nothing was seen, or a doubt that is not above zero.
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
                "nothing was seen: give the states, strokes of snaps, or forces on the way."
            )
        for name in ("ruler", "scale"):
            if not 0 < (value := getattr(self, name)) < math.inf:
                raise base.InputError(f"{name} = {value}: must be > 0, as doubts are.")

    @property
    def numbers(self) -> int:
        """How many strokes and forces were read."""
        return len(self.out or ()) + len(self.back or ()) + len(self.pulls)

    def misfit(self, cycle: sequences.Cycle) -> float:
        """Half the sum of squared errors in standard deviations; infinite where it did otherwise.

        Another number of snaps is another motion, and so is a tie, which may end either way.
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
    """Forces at even strokes of a recording, each the mean of what lies about it.

    `full` is the stroke with every cell at state 1 [m].

    Raises:
        LabError: it does not reach over half of that stroke, or over more than half as much again.
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
        misfits, shifts: (n,) as `Observed.misfit`, and (n, cells, 2) of q to another hole [m].
        before, weights: those before anything was seen, and how likely each is.
        share: of those before, how many moved as was seen, whatever its strokes and forces.
        few: whether fewer moved so than are needed to draw from.
    """

    built: list[Chain]
    misfits: base.Floats
    shifts: base.Floats
    before: list[Chain]
    weights: base.Floats
    share: float
    few: bool


def population(
    draws: Draws, holes: Holes, observed: Observed, n: int, count: Callable[[], None]
) -> Population | None:
    """n builds given what was seen of one; None where of n none moves so.

    What was seen, and how unlikely wrong holes are, counts little at first and more in every
    generation: the better builds are taken more often, and all then go some steps at random,
    among builds that are as likely.

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
    share, fit = float(np.sum(likely[fits]) / np.sum(likely)), np.flatnonzero(fits)
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
        share,
        len(fit) < _FEW * n,
    )


class _TriedBuild(NamedTuple):
    """One build that was tried: None where it cannot be built."""

    chain: Chain | None
    misfit: float
    price: float

    @property
    def cost(self) -> float:
        """Minus the logarithm of how likely it is, given what was seen."""
        return self.misfit + self.price


@dataclass
class _BuildSampler:
    """Builds and the even numbers (n, columns) that they are made of, first draws, then holes."""

    draws: Draws
    holes: Holes
    observed: Observed
    count: Callable[[], None]
    random: np.random.Generator
    even: base.Floats
    made: list[_TriedBuild] = field(default_factory=list)
    far: float = 1.0  # of a step, over the spread of the builds

    def tried(self, row: base.Floats) -> _TriedBuild:
        """The build of one row, and how badly it fits what was seen."""
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
        """Draw until enough fit; which of all fit."""
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
        """Go on with the builds at these places; one may be there several times."""
        self.even, self.made = self.even[places], [self.made[k] for k in places]

    def walk(self, counts: float, steps: int) -> None:
        """Some steps at random; what was seen `counts` so much, from 0 to 1."""
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
        """A place near each build; some anchors hook into another hole."""
        n, columns = len(self.even), len(self.holes.anchors)
        step = self.far * spread * self.random.standard_normal(self.even.shape)
        # What goes beyond 0 or 1 comes back as by mirrors there.
        there = np.mod(self.even + step, 2.0)
        there = np.minimum(there, 2.0 - there)
        if columns:
            draw, other = self.random.random(n), self.random.random((n, columns))
            one = np.arange(columns) == self.random.integers(columns, size=(n, 1))
            new = (draw < 2 * _REHOOKED)[:, None] & (one | (draw < _REHOOKED)[:, None])
            there[:, self.draws.columns :][new] = other[new]
        return there


def _exponent_step(misfits: base.Floats, most: float) -> float:
    """By how much more what was seen may count for half of them to stay."""

    def kept(more: float) -> float:
        weights = np.exp(more * (np.min(misfits) - misfits))
        return float(np.sum(weights) ** 2 / np.sum(weights**2)) / len(misfits)

    if kept(most) >= 0.5:
        return most
    return max(base.bisected(lambda more: kept(more) >= 0.5, 0.0, most, 40)[0], 1e-6)


def _resampled(weights: base.Floats, random: np.random.Generator) -> base.Ints:
    """As many of each as its weight says, by even steps from a random start."""
    n = len(weights)
    places = np.cumsum(weights) / np.sum(weights)
    return np.minimum(np.searchsorted(places, (np.arange(n) + random.random()) / n), n - 1)
