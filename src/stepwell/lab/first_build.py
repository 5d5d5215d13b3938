"""What a first build must be like, and which anchors to move to other holes."""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import combinations
from typing import Any

import numpy as np

from stepwell import base
from stepwell.base import ByValue, InputError, StepwellError, Vec2
from stepwell.design import Draws, Parameter, Tolerances, checked_cycle, parameters
from stepwell.lab import builds
from stepwell.lab.recordings.recording import LabError
from stepwell.mechanism import Chain

# Every move is tried on so many of the builds that agree, the best ones on all of them.
_FIRST, _BEST = 32, 3
# Further than so many holes another design is the better answer.
MOST_HOLES = 3
# Two anchors are moved where one does not mend so many; of the moves of one, so many are paired.
_ENOUGH, _PAIRED = 0.95, 8


@dataclass(frozen=True, eq=False)
class AnchorMove(ByValue):
    """One anchor moved along x or y, by a number of holes.

    Attributes:
        anchor: q of a cell; p as far the other way does the same.
        was, to: where its first band has it on the drawing, and where it would be there [m].
    """

    anchor: Parameter
    was: Vec2
    to: Vec2
    holes: int

    def of(self, chain: Chain) -> Chain:
        """A chain with this step."""
        return self.anchor.displaced(chain, (self.to[0] - self.was[0], self.to[1] - self.was[1]))

    def __str__(self):
        dx, dy = (
            base.number(base.to_unit(b - a, "mm")) for a, b in zip(self.was, self.to, strict=True)
        )
        words = builds.move_in_words(self.was, self.to, self.holes)
        return f"{builds.named(self.anchor)} {words}, by ({dx}, {dy}) mm"

    def __repr__(self):
        return f"AnchorMove({self})"


@dataclass(frozen=True, eq=False)
class Move(ByValue):
    """One anchor moved to another hole, or two: a step for each anchor and direction.

    `share` says of the builds that agree with what was seen how many then do what is wanted.
    """

    steps: tuple[AnchorMove, ...]
    share: float

    @property
    def anchor(self) -> Parameter:
        """The anchor of the first step."""
        return self.steps[0].anchor

    @property
    def was(self) -> Vec2:
        """Where the first step begins, on the drawing [m]."""
        return self.steps[0].was

    @property
    def to(self) -> Vec2:
        """Where the first step ends, on the drawing [m]."""
        return self.steps[0].to

    def of(self, chain: Chain) -> Chain:
        """A chain with this move."""
        for step in self.steps:
            chain = step.of(chain)
        return chain

    def __str__(self):
        return "move " + " and ".join(map(str, self.steps))

    def __repr__(self):
        return f"Move({self}: {base.percent(self.share)})"


def best_moves(
    drawing: Chain,
    built: Sequence[Chain],
    target: str,
    hole: float,
    share: float,
    count_trial: Callable[[], None],
) -> tuple[Move, ...]:
    """The best moves first, if they are better than leaving the anchors, beyond what chance does.

    One anchor is moved along x or y, by as few holes as help; two by one hole each where one does
    not mend nearly all. Two are told where they are better than one beyond chance.
    """

    def beyond(one: float, other: float) -> bool:
        # What two shares of n differ by chance, twice the standard deviation.
        both = (one + other) / 2
        return one - other > 2.0 * math.sqrt(2.0 * both * (1.0 - both) / len(built))

    def better(moves: list[Move], than: float) -> list[Move]:
        best = sorted(moves, key=lambda move: -move.share)[:_BEST]
        again = [_with_share(move.steps, built, target) for move in best]
        held = [move for move in again if beyond(move.share, than)]
        return sorted(held, key=lambda move: -move.share)

    def judged(steps: tuple[AnchorMove, ...]) -> Move:
        count_trial()
        return _with_share(steps, built[:_FIRST], target)

    if share == 1.0:
        return ()
    near: list[Move] = []
    chosen: list[Move] = []
    placed = [(one, builds.place_of(one, drawing)) for one in builds.outer_anchors(drawing)]
    for holes in range(1, MOST_HOLES + 1):
        far = holes * hole
        moves = [
            judged((AnchorMove(anchor, was, (was[0] + far * x, was[1] + far * y), holes),))
            for anchor, was in placed
            for x, y in builds.WAYS
        ]
        near = near or moves
        if chosen := better(moves, share):
            break
    most = chosen[0].share if chosen else share
    if most < _ENOUGH:
        single = sorted(near, key=lambda move: -move.share)[:_PAIRED]
        pairs = [
            judged((*a.steps, *b.steps)) for a, b in combinations(single, 2) if not _reverses(a, b)
        ]
        chosen = [*better(pairs, most), *chosen][:_BEST]
    return tuple(chosen)


def moves_of(chain: Chain) -> int:
    """How many moves of one anchor and of two there are to be tried."""
    steps = len(builds.WAYS) * len(builds.outer_anchors(chain))
    paired = min(steps, _PAIRED)
    return MOST_HOLES * steps + paired * (paired - 1) // 2


def _reverses(a: Move, b: Move) -> bool:
    """Whether the second move takes the first one back."""
    there = (a.to[0] - a.was[0] + b.to[0] - b.was[0], a.to[1] - a.was[1] + b.to[1] - b.was[1])
    return a.anchor == b.anchor and there == (0.0, 0.0)


def _with_share(steps: tuple[AnchorMove, ...], built: Sequence[Chain], target: str) -> Move:
    move, count = Move(steps, 0.0), 0
    for one in built:
        with suppress(StepwellError):  # Hooked there it cannot be built.
            count += does(move.of(one), target)
    return Move(steps, count / len(built))


def does(chain: Chain, target: str) -> bool:
    """Whether a chain does it; one that ties may do otherwise."""
    try:
        cycle = chain.cycle()
    except StepwellError:
        return False
    return str(cycle.sequence) == target and not cycle.degenerate


# What is believed of a first build before it is tried: drilled by hand, bands of one bag.
FIRST_BUILD = Tolerances(anchor=0.001, stiffness=0.10, travel=0.05)
# Where few move so, or those that do agree badly, parts may be further off; at most so many times,
# and the spread of a band ends below a quarter.
_MOST_WIDE, _WIDEST = 8.0, 0.24
# Half the squared errors of a number are a half in the mean; of a build that disagrees, more.
_AGREE = 2.0
# Of two hundred anchors ten are hooked into the hole beside their own.
WRONG_HOLE = 0.05
_MOST_WRONG = 0.4  # for one anchor; one of the two of a cell is then likelier wrong than right
_RARE = 0.05  # of the builds: wrong holes that fewer have are not told
# A doubt that shrank by less than this was not told by what was seen, where the mean stayed near.
_IDENTIFIED = 0.8
# What is told of every cell. Of anchors a motion knows d = q - p alone, so p is as drawn.
_PARTS = ("q.x", "q.y", "stiffness", "force_scale", "travel_scale", "friction")


@dataclass(frozen=True, eq=False)
class ParameterEstimate(ByValue):
    """One number of a build.

    Attributes:
        drawn: on the drawing.
        value, doubt: mean and standard deviation, given what was seen.
        before: standard deviation before it was tried.
    """

    parameter: Parameter
    drawn: float
    value: float
    doubt: float
    before: float

    @property
    def identified(self) -> bool:
        """Whether what was seen says anything of it: it is surer now, or far from the drawing."""
        return self.doubt < _IDENTIFIED * self.before or abs(self.value - self.drawn) > self.before

    def __repr__(self):
        return (
            f"ParameterEstimate({self.parameter.name}: {self.value:.4g} ± {self.doubt:.2g} "
            f"{self.parameter.unit}, drawn {self.drawn:.4g})"
        )


@dataclass(frozen=True, eq=False)
class AsBuilt(ByValue):
    """A build as what it did tells it to be, and the move that would make it do what is wanted.

    Attributes:
        drawing: what was meant to be built.
        seen, target: what it did, and what it should do.
        tolerances: how far parts were taken to be off at most.
        wider: how many times as far as first thought; 1 where that sufficed.
        samples, seed: how many were drawn, and which.
        agreeing: of those drawn, how many move as was seen, whatever the strokes and forces [1].
        known: every number of every cell.
        chain: the build, at the means; where these together do something else, the one drawn
            that agrees best.
        share: of those that agree, how many do what is wanted as they are.
        moves: the best three of one anchor, by as few holes as make it better than leaving it
            beyond what chance does, or of two; the best first, none where none does.
        hole: how far apart holes are [m].
        chance: how likely an anchor was taken to be one hole off.
        wrong: anchors that are in the hole beside their own in a twentieth of the builds that
            agree, or more; the likeliest first.
    """

    drawing: Chain = field(repr=False)
    seen: builds.Observed
    target: str
    tolerances: Tolerances
    wider: float
    samples: int
    seed: int
    agreeing: float
    known: tuple[ParameterEstimate, ...] = field(repr=False)
    chain: Chain = field(repr=False)
    share: float
    moves: tuple[Move, ...]
    hole: float
    chance: float = WRONG_HOLE
    wrong: tuple[builds.WrongHole, ...] = ()

    @property
    def advice(self) -> str:
        """What to do next, with the shares before and after."""
        now = f"{base.percent(self.share)} of the builds that would do this do what is wanted"
        if self.moves:
            best = self.moves[0]
            return f"{best}: {now} as they are, {base.percent(best.share)} after it"
        if not moves_of(self.drawing):
            return f"{now}; it has no anchor that could be moved"
        far = base.number(base.to_unit(MOST_HOLES * self.hole, "mm"))
        return (
            f"leave its anchors: {now}, and no move of one by up to {far} mm helps, nor of two by "
            f"{base.number(base.to_unit(self.hole, 'mm'))} mm"
        )

    def __repr__(self):
        return f"AsBuilt({self.advice})"


def as_built(
    drawing: Chain,
    seen: builds.Observed,
    tolerances: Tolerances = FIRST_BUILD,
    *,
    target: str | None = None,
    hole: float = 0.005,
    wrong_hole: float = WRONG_HOLE,
    samples: int = 200,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
) -> AsBuilt:
    """Find out what a build must be like to do what it was seen to do, and what to move.

    Builds are drawn within the tolerances until they agree with what was seen as well as its doubt
    asks for, their anchors in the holes of the drawing or, seldom, beside them; where they cannot,
    parts may be twice as far off, and so on. The numbers are means over these builds. On them one
    anchor is moved, by up to three holes, or two by one.

    Args:
        drawing: what was meant to be built.
        seen: what it did.
        tolerances: how far its parts may be off.
        target: what it should do; what the drawing does by default.
        hole: how far apart holes are [m].
        wrong_hole: how likely an anchor is in the hole beside its own, along x or y [1].
        samples, seed: how many builds, and which.
        progress: called with (done, total) builds and moves.

    Raises:
        LabError: nothing that is drawn within eight times the tolerances does what was seen.
        ValueError: an argument out of range.
    """
    base.check.whole("samples", samples, 100)
    base.check.whole("seed", seed, 0)
    if not 0 < hole < math.inf:
        raise InputError(f"hole = {hole} m: must be > 0, how far apart holes are.")
    if not 0 <= wrong_hole <= _MOST_WRONG:
        raise InputError(f"wrong_hole = {wrong_hole}: must be 0 to {_MOST_WRONG}, 0 for never.")
    last = drawing.last_state
    sequence = str(drawing.cycle().sequence) if target is None else checked_cycle(target, last)
    if seen.sequence is not None:
        checked_cycle(seen.sequence, last, "seen")
    done, total = 0, samples * (1 + 4 * builds.STEPS) + moves_of(drawing)

    def count() -> None:
        nonlocal done
        done += 1
        base.notify(progress, done, max(done, total))

    holes = builds.Holes(builds.outer_anchors(drawing) if wrong_hole else (), hole, wrong_hole)
    wider = 1.0
    while True:
        given = _wide(tolerances, wider, drawing)
        matching = builds.population(Draws(drawing, given, seed), holes, seen, samples, count)
        most = _AGREE * seen.numbers
        agrees = matching and not matching.few and np.mean(matching.misfits) <= most
        if agrees or wider >= _MOST_WIDE:
            break
        wider *= 2.0
        total += samples * (1 + 4 * builds.STEPS)
    if matching is None:
        raise LabError(
            "what was seen",
            f"none of {samples} builds with parts up to {wider:g} times as far off as "
            f"{tolerances!r} does this: check that this design was built, which cell is innermost, "
            f"and from where strokes were counted.",
        )
    known = _known(drawing, matching)
    likely = matching.built[int(np.argmin(matching.misfits))]
    with suppress(StepwellError):  # The means together may be no chain, or do otherwise.
        means = reduce(lambda chain, one: one.parameter.changed(chain, one.value), known, drawing)
        likely = means if math.isfinite(seen.misfit(means.cycle())) else likely
    share = sum(does(one, sequence) for one in matching.built) / samples
    moves = best_moves(drawing, matching.built, sequence, hole, share, count)
    return AsBuilt(
        drawing,
        seen,
        sequence,
        given,
        wider,
        samples,
        seed,
        matching.share,
        known,
        likely,
        share,
        moves,
        hole,
        wrong_hole,
        _wrong(drawing, holes, matching),
    )


def _wide(given: Tolerances, wider: float, drawing: Chain) -> Tolerances:
    """Wider tolerances of anchors or holes and of friction; of elements, those of the scales."""
    wide = replace(given, anchor=wider * given.anchor, friction=wider * given.friction)
    if len(drawing.elements) < len(drawing):
        return wide
    scales = {"stiffness": given.stiffness, "travel": given.travel}
    return replace(wide, **{name: min(wider * value, _WIDEST) for name, value in scales.items()})


def _wrong(
    drawing: Chain, holes: builds.Holes, population: builds.Population
) -> tuple[builds.WrongHole, ...]:
    """Anchors in wrong holes among builds that agree, the likeliest first."""
    wrong: list[builds.WrongHole] = []
    for i, anchor in enumerate(holes.anchors):
        was = builds.place_of(anchor, drawing)
        ways, counts = np.unique(population.shifts[:, i], axis=0, return_counts=True)
        for (dx, dy), count in zip(ways.tolist(), counts.tolist(), strict=True):
            if (dx or dy) and count >= _RARE * len(population.shifts):
                to = was[0] + dx, was[1] + dy
                wrong.append(builds.WrongHole(anchor, was, to, count / len(population.shifts)))
    return tuple(sorted(wrong, key=lambda one: -one.share))


def _known(drawing: Chain, population: builds.Population) -> tuple[ParameterEstimate, ...]:
    estimates: list[ParameterEstimate] = []
    for one in (parameter for parameter in parameters(drawing) if parameter.part in _PARTS):
        before, after = (
            np.array([_value(one, chain, drawing) for chain in chains])
            for chains in (population.before, population.built)
        )
        middle = float(population.weights @ before)
        spread = math.sqrt(float(population.weights @ (before - middle) ** 2))
        if spread > 0.0:
            drawn = _value(one, drawing, drawing)
            mean, doubt = float(np.mean(after)), float(np.std(after))
            estimates.append(ParameterEstimate(one, drawn, mean, doubt, spread))
    return tuple(estimates)


def _value(one: Parameter, chain: Chain, drawing: Chain) -> float:
    """A number of a build; where q is if p is as drawn, for a motion knows q - p alone."""
    value: Any = one.value(chain)
    if one.part.startswith("q."):
        inner = replace(one, part=one.part.replace("q", "p"))
        there: Any = inner.value(drawing)
        return float(value - inner.value(chain) + there)
    return float(value)
