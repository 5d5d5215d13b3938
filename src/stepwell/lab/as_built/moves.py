"""Which anchor to move to another hole, for a build that is known as far as it was seen."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from stepwell.base import ByValue, StepwellError, number, percent
from stepwell.design import Parameter, parameters
from stepwell.mechanism import Chain

# Every move is tried on so many of the builds that agree, the best ones on all of them.
_FIRST, _BEST = 32, 3


@dataclass(frozen=True, eq=False)
class Move(ByValue):
    """One anchor moved to another hole.

    Attributes:
        anchor: p or q of a cell.
        was, to: where its first band has it on the drawing, and where to hook it instead [m].
        share: of the builds that agree with what was seen, how many then do what is wanted.
    """

    anchor: Parameter
    was: tuple[float, float]
    to: tuple[float, float]
    share: float

    def of(self, chain: Chain) -> Chain:
        """A chain with this move."""
        return self.anchor.displaced(chain, (self.to[0] - self.was[0], self.to[1] - self.was[1]))

    def __str__(self):
        cell, _, part = self.anchor.name.rpartition(".")
        was, to = (f"({number(x * 1e3)}, {number(y * 1e3)})" for x, y in (self.was, self.to))
        return f"move {part} of {cell} from {was} to {to} mm"

    def __repr__(self):
        return f"Move({self}: {percent(self.share)})"


def best_moves(
    drawing: Chain,
    built: Sequence[Chain],
    wanted: str,
    far: float,
    share: float,
    tried: Callable[[], None],
) -> tuple[Move, ...]:
    """The best moves of one anchor, if they are better than leaving it, beyond what chance does.

    Args:
        drawing: whose anchors are named.
        built: as they may be, each as likely as the others.
        wanted: the sequence of states.
        far: how far an anchor is moved, along x or y [m].
        share: how many of the builds do it as they are.
        tried: called after each move that was tried.

    Returns:
        Moves, the best one first.
    """
    moves: list[Move] = []
    for anchor in parameters(drawing):
        if not anchor.is_anchor:
            continue
        was: Any = anchor.value(drawing)
        for dx, dy in ((far, 0.0), (-far, 0.0), (0.0, far), (0.0, -far)):
            move = Move(anchor, was, (was[0] + dx, was[1] + dy), 0.0)
            moves.append(_judged(move, built[:_FIRST], wanted))
            tried()
    best = sorted(moves, key=lambda move: -move.share)[:_BEST]
    again = [_judged(move, built, wanted) for move in best]
    better = [move for move in again if move.share - share > _chance(move.share, share, len(built))]
    return tuple(sorted(better, key=lambda move: -move.share))


def _chance(one: float, other: float, n: int) -> float:
    """By how much two shares of n differ by chance, twice the standard deviation."""
    both = (one + other) / 2
    return 2.0 * math.sqrt(2.0 * both * (1.0 - both) / n)


def moves_of(chain: Chain) -> int:
    """How many moves there are to be tried."""
    return 4 * sum(one.is_anchor for one in parameters(chain))


def _judged(move: Move, built: Sequence[Chain], wanted: str) -> Move:
    count = 0
    for one in built:
        try:
            count += does(move.of(one), wanted)
        except StepwellError:
            continue  # Hooked there it cannot be built.
    return Move(move.anchor, move.was, move.to, count / len(built))


def does(chain: Chain, wanted: str) -> bool:
    """Whether a chain does it; one that ties may do otherwise."""
    try:
        cycle = chain.cycle()
    except StepwellError:
        return False
    return str(cycle.sequence) == wanted and not cycle.degenerate
