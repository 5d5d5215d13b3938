"""What a first build must be like, from what it was seen to do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stepwell.base import ByValue, InputError, StepwellError, check, number, percent
from stepwell.design import Draws, Parameter, Tolerances, checked_cycle, parameters
from stepwell.lab.as_built.moves import Move, best_moves, does, moves_of
from stepwell.lab.as_built.observed import Observed
from stepwell.lab.as_built.population import STEPS, Population, population
from stepwell.lab.recordings import LabError
from stepwell.mechanism import Chain

# What is believed of a first build before it is tried: drilled by hand, bands of one bag.
FIRST_BUILD = Tolerances(anchor=0.001, stiffness=0.10, travel=0.05)
# Where fewer than this move so, or those that do agree badly, parts may be further off; at most so
# many times, and the spread of a band ends below a quarter.
_FEW, _MOST_WIDE, _WIDEST = 0.02, 8.0, 0.24
# Half the squared errors of a number are a half in the mean; of a build that disagrees, more.
_AGREE = 2.0
# Further than so many holes another design is the better answer.
_MOST_HOLES = 3
# A doubt that shrank by less than this was not told by what was seen.
_TOLD = 0.8
# What is told of every cell. Of anchors a motion knows d = q - p alone, so p is as drawn.
_PARTS = ("q.x", "q.y", "stiffness", "force_scale", "travel_scale", "friction")


@dataclass(frozen=True, eq=False)
class Known(ByValue):
    """One number of a build.

    Attributes:
        parameter: which.
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
    def told(self) -> bool:
        """Whether what was seen says anything of it."""
        return self.doubt < _TOLD * self.before

    def __repr__(self):
        return (
            f"Known({self.parameter.name}: {self.value:.4g} ± {self.doubt:.2g} "
            f"{self.parameter.unit}, drawn {self.drawn:.4g})"
        )


@dataclass(frozen=True, eq=False)
class AsBuilt(ByValue):
    """A build as what it did tells it to be, and the move that would make it do what is wanted.

    Attributes:
        drawing: what was meant to be built.
        seen: what it did.
        wanted: what it should do.
        tolerances: how far parts were taken to be off at most.
        wider: how many times as far as first thought; 1 where that sufficed.
        n, seed: how many were drawn, and which.
        agreeing: of those drawn, how many move as was seen, whatever the strokes and forces [1].
        known: every number of every cell.
        chain: the build, at the means; where these together do something else, the one drawn
            that agrees best.
        share: of those that agree, how many do what is wanted as they are.
        moves: the best three of one anchor, the best first, by as few holes as make it better than
            leaving it beyond what chance does; none where up to three do not.
        hole: how far apart holes are [m].
    """

    drawing: Chain = field(repr=False)
    seen: Observed
    wanted: str
    tolerances: Tolerances
    wider: float
    n: int
    seed: int
    agreeing: float
    known: tuple[Known, ...] = field(repr=False)
    chain: Chain = field(repr=False)
    share: float
    moves: tuple[Move, ...]
    hole: float

    @property
    def advice(self) -> str:
        """What to do next, with the shares before and after."""
        now = f"{percent(self.share)} of the builds that would do this do what is wanted"
        if self.moves:
            best = self.moves[0]
            return f"{best}: {now} as they are, {percent(best.share)} after it"
        if not moves_of(self.drawing):
            return f"{now}; it has no anchor that could be moved"
        far = number(_MOST_HOLES * self.hole * 1e3)
        return f"leave its anchors: {now}, and no move of one of them by up to {far} mm helps"

    def __repr__(self):
        return f"AsBuilt({self.advice})"


def as_built(
    drawing: Chain,
    seen: Observed,
    tolerances: Tolerances = FIRST_BUILD,
    *,
    wanted: str | None = None,
    hole: float = 0.005,
    n: int = 200,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
) -> AsBuilt:
    """Find out what a build must be like to do what it was seen to do, and what to move.

    Builds are drawn within the tolerances until they agree with what was seen as well as its doubt
    asks for; where they cannot, parts may be twice as far off, and so on. The numbers are means
    over these builds. On them one anchor is moved, by up to three holes.

    Args:
        drawing: what was meant to be built.
        seen: what it did.
        tolerances: how far its parts may be off.
        wanted: what it should do; what the drawing does by default.
        hole: how far apart holes are [m].
        n: how many builds.
        seed: which.
        progress: called with (done, total) builds and moves.

    Returns:
        The build, and what to do next.

    Raises:
        LabError: nothing that is drawn within eight times the tolerances does what was seen.
        ValueError: an argument out of range.
    """
    check.whole("n", n, 100)
    check.whole("seed", seed, 0)
    if not 0 < hole < math.inf:
        raise InputError(f"hole = {hole} m: must be > 0, how far apart holes are.")
    last = drawing.last_state
    want = str(drawing.cycle().sequence) if wanted is None else checked_cycle(wanted, last)
    if seen.sequence is not None:
        checked_cycle(seen.sequence, last, "seen")
    done, total = 0, n * (1 + 4 * STEPS) + _MOST_HOLES * moves_of(drawing)

    def tell() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, max(done, total))

    wider = 1.0
    while True:
        given = _wide(tolerances, wider, drawing)
        found = population(Draws(drawing, given, seed), seen, n, tell)
        if (found is not None and _agrees(found, seen)) or wider >= _MOST_WIDE:
            break
        wider *= 2.0
        total += n * (1 + 4 * STEPS)
    if found is None:
        raise LabError(
            "what was seen",
            f"none of {n} builds with parts up to {wider:g} times as far off as {tolerances!r} "
            f"does this: check that this design was built, which cell is innermost, and from "
            f"where strokes were counted.",
        )
    known = _known(drawing, found)
    likely = _at_means(drawing, known)
    if likely is None or math.isinf(_misfit(likely, seen)):
        likely = found.built[int(np.argmin(found.misfits))]
    share = sum(does(one, want) for one in found.built) / n
    moves: tuple[Move, ...] = ()
    for holes in range(1, _MOST_HOLES + 1):
        moves = best_moves(drawing, found.built, want, holes * hole, share, tell)
        if moves or share == 1.0:
            break
    return AsBuilt(
        drawing, seen, want, given, wider, n, seed, found.share, known, likely, share, moves, hole
    )


def _agrees(found: Population, seen: Observed) -> bool:
    """Whether enough builds move as was seen, with strokes and forces within their doubts."""
    if found.share < _FEW:
        return False
    return float(np.mean(found.misfits)) <= _AGREE * seen.numbers


def _misfit(chain: Chain, seen: Observed) -> float:
    try:
        return seen.misfit(chain.cycle())
    except StepwellError:
        return math.inf


def _wide(given: Tolerances, wider: float, drawing: Chain) -> Tolerances:
    """The tolerances so many times as wide; an anchor is in another hole before a band is another.

    Of a chain of elements, which has no anchors, the scales are.
    """
    found = replace(given, anchor=wider * given.anchor, friction=wider * given.friction)
    if len(drawing.elements) < len(drawing):
        return found
    scales = {"stiffness": given.stiffness, "travel": given.travel}
    return replace(found, **{name: min(wider * value, _WIDEST) for name, value in scales.items()})


def _known(drawing: Chain, builds: Population) -> tuple[Known, ...]:
    found: list[Known] = []
    for one in parameters(drawing):
        if one.part not in _PARTS:
            continue
        before, after = (
            [_value(one, chain, drawing) for chain in chains]
            for chains in (builds.before, builds.built)
        )
        spread = float(np.std(before))
        if spread > 0.0:
            drawn = _value(one, drawing, drawing)
            found.append(Known(one, drawn, float(np.mean(after)), float(np.std(after)), spread))
    return tuple(found)


def _value(one: Parameter, chain: Chain, drawing: Chain) -> float:
    """A number of a build; where q is if p is as drawn, for a motion knows q - p alone."""
    value: Any = one.value(chain)
    if one.part.startswith("q."):
        inner = replace(one, part=one.part.replace("q", "p"))
        there: Any = inner.value(drawing)
        return float(value - inner.value(chain) + there)
    return float(value)


def _at_means(drawing: Chain, known: tuple[Known, ...]) -> Chain | None:
    """The drawing with every number at its mean; None where that cannot be made."""
    chain = drawing
    try:
        for one in known:
            chain = one.parameter.changed(chain, one.value)
    except StepwellError:
        return None
    return chain
