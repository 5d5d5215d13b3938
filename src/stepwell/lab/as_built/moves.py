"""Which anchors to move to other holes, for a build that is known as far as it was seen."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

from stepwell.base import ByValue, StepwellError, Vec2, number, percent
from stepwell.design import Parameter
from stepwell.lab.as_built.holes import WAYS, named, outer_anchors, place_of, way_in_words
from stepwell.mechanism import Chain

# Every move is tried on so many of the builds that agree, the best ones on all of them.
_FIRST, _BEST = 32, 3
# Further than so many holes another design is the better answer.
MOST_HOLES = 3
# Two anchors are moved where one does not mend so many; of the moves of one, so many are paired.
_ENOUGH, _PAIRED = 0.95, 8


@dataclass(frozen=True, eq=False)
class Step(ByValue):
    """One anchor moved along x or y.

    Attributes:
        anchor: q of a cell; p as far the other way does the same.
        was, to: where its first band has it on the drawing, and where it would be there [m].
        holes: how many holes that is.
    """

    anchor: Parameter
    was: Vec2
    to: Vec2
    holes: int

    def of(self, chain: Chain) -> Chain:
        """A chain with this step."""
        return self.anchor.displaced(chain, (self.to[0] - self.was[0], self.to[1] - self.was[1]))

    def __str__(self):
        dx, dy = (number((b - a) * 1e3) for a, b in zip(self.was, self.to, strict=True))
        words = way_in_words(self.was, self.to, self.holes)
        return f"{named(self.anchor)} {words}, by ({dx}, {dy}) mm"

    def __repr__(self):
        return f"Step({self})"


@dataclass(frozen=True, eq=False)
class Move(ByValue):
    """One anchor moved to another hole, or two.

    Attributes:
        steps: one for each anchor and direction.
        share: of the builds that agree with what was seen, how many then do what is wanted.
    """

    steps: tuple[Step, ...]
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
        return f"Move({self}: {percent(self.share)})"


def best_moves(
    drawing: Chain,
    built: Sequence[Chain],
    wanted: str,
    hole: float,
    share: float,
    tried: Callable[[], None],
) -> tuple[Move, ...]:
    """The best moves, if they are better than leaving the anchors, beyond what chance does.

    One anchor is moved along x or y, by as few holes as help; two by one hole each where one does
    not mend nearly all. Two are told where they are better than one beyond chance.

    Args:
        drawing: whose anchors are named.
        built: as they may be, each as likely as the others.
        wanted: the sequence of states.
        hole: how far apart holes are [m].
        share: how many of the builds do it as they are.
        tried: called after each move that was tried.

    Returns:
        Moves, the best one first.
    """

    def better(moves: list[Move], than: float) -> list[Move]:
        best = sorted(moves, key=lambda move: -move.share)[:_BEST]
        again = [_judged(move.steps, built, wanted) for move in best]
        held = [move for move in again if move.share - than > _chance(move.share, than, len(built))]
        return sorted(held, key=lambda move: -move.share)

    def judged(steps: tuple[Step, ...]) -> Move:
        tried()
        return _judged(steps, built[:_FIRST], wanted)

    if share == 1.0:
        return ()
    near: list[Move] = []
    found: list[Move] = []
    for holes in range(1, MOST_HOLES + 1):
        moves = [judged((step,)) for step in _steps(drawing, hole, holes)]
        near = near or moves
        if found := better(moves, share):
            break
    most = found[0].share if found else share
    if most < _ENOUGH:
        single = sorted(near, key=lambda move: -move.share)[:_PAIRED]
        pairs = [
            judged((*a.steps, *b.steps)) for a, b in combinations(single, 2) if not _back(a, b)
        ]
        found = [*better(pairs, most), *found][:_BEST]
    return tuple(found)


def moves_of(chain: Chain) -> int:
    """How many moves of one anchor and of two there are to be tried."""
    steps = len(WAYS) * len(outer_anchors(chain))
    paired = min(steps, _PAIRED)
    return MOST_HOLES * steps + paired * (paired - 1) // 2


def _steps(drawing: Chain, hole: float, holes: int) -> list[Step]:
    found: list[Step] = []
    for anchor in outer_anchors(drawing):
        was = place_of(anchor, drawing)
        for x, y in WAYS:
            to = was[0] + holes * hole * x, was[1] + holes * hole * y
            found.append(Step(anchor, was, to, holes))
    return found


def _back(a: Move, b: Move) -> bool:
    """Whether the second move takes the first one back."""
    there = (a.to[0] - a.was[0] + b.to[0] - b.was[0], a.to[1] - a.was[1] + b.to[1] - b.was[1])
    return a.anchor == b.anchor and there == (0.0, 0.0)


def _chance(one: float, other: float, n: int) -> float:
    """By how much two shares of n differ by chance, twice the standard deviation."""
    both = (one + other) / 2
    return 2.0 * math.sqrt(2.0 * both * (1.0 - both) / n)


def _judged(steps: tuple[Step, ...], built: Sequence[Chain], wanted: str) -> Move:
    move, count = Move(steps, 0.0), 0
    for one in built:
        try:
            count += does(move.of(one), wanted)
        except StepwellError:
            continue  # Hooked there it cannot be built.
    return Move(steps, count / len(built))


def does(chain: Chain, wanted: str) -> bool:
    """Whether a chain does it; one that ties may do otherwise."""
    try:
        cycle = chain.cycle()
    except StepwellError:
        return False
    return str(cycle.sequence) == wanted and not cycle.degenerate
