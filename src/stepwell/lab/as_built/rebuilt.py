"""What a first build must be like, from what it was seen to do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stepwell.base import ByValue, Floats, InputError, StepwellError, check, number, percent
from stepwell.design import Parameter, Tolerances, made, parameters
from stepwell.lab.as_built.moves import Move, best_moves, moves_of
from stepwell.lab.as_built.seen import Seen
from stepwell.lab.recordings import LabError
from stepwell.mechanism import Chain

# What is believed of a first build before it is tried: drilled by hand, bands of one bag.
FIRST_BUILD = Tolerances(anchor=0.001, stiffness=0.10, travel=0.05)
# So many that agree say enough; where fewer do, parts may be further off, at most so many times.
_ENOUGH, _WIDER, _MOST_WIDE, _WIDEST = 40.0, 2.0, 3, 0.24
# Moves are tried on so many of them.
_BUILT = 200
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
        agreeing: to how many equally likely ones those that agree amount; few make it rough.
        known: every number of every cell.
        chain: the build, at the means; where these together do something else, the one drawn
            that agrees best.
        share: of those that agree, how many do what is wanted as they are.
        moves: the best three, by one hole each, the best first.
        hole: how far apart holes are [m].
    """

    drawing: Chain = field(repr=False)
    seen: Seen
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
    def move(self) -> Move | None:
        """The move to make; None where none is better than leaving it, beyond what chance does."""
        if not self.moves:
            return None
        best = self.moves[0]
        both = (best.share + self.share) / 2
        chance = math.sqrt(2 * both * (1 - both) / min(_BUILT, max(self.agreeing, 1.0)))
        return best if best.share - self.share > 2 * chance else None

    @property
    def advice(self) -> str:
        """What to do next, with the shares before and after."""
        now = f"{percent(self.share)} of the builds that would do this do what is wanted"
        if self.move is None:
            far = number(self.hole * 1e3)
            return f"leave it: {now}, and no move of one anchor by {far} mm makes them more"
        return f"{self.move}: {now} as they are, {percent(self.move.share)} after it"

    def __repr__(self):
        return f"AsBuilt({self.advice})"


def as_built(
    drawing: Chain,
    seen: Seen,
    tolerances: Tolerances = FIRST_BUILD,
    *,
    wanted: str | None = None,
    hole: float = 0.005,
    n: int = 1000,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
) -> AsBuilt:
    """Find out what a build must be like to do what it was seen to do, and what to move.

    Builds are drawn within the tolerances and weighed by how well each agrees with what was seen
    (importance sampling); where too few agree, parts may be twice as far off, and so on. The
    numbers are means over those that agree. Moves of one anchor by one hole are tried on them.

    Args:
        drawing: what was meant to be built.
        seen: what it did.
        tolerances: how far its parts may be off.
        wanted: what it should do; what the drawing does by default.
        hole: how far apart holes are [m].
        n: how many are drawn at a time.
        seed: which.
        progress: called with (done, total) builds and moves.

    Returns:
        The build, and what to do next.

    Raises:
        LabError: nothing that is drawn within eight times the tolerances does what was seen.
        ValueError: an argument out of range.

    Source: importance sampling, Kahn and Marshall 1953.
    """
    check.whole("n", n, 100)
    check.whole("seed", seed, 0)
    if not 0 < hole < math.inf:
        raise InputError(f"hole = {hole} m: must be > 0, how far apart holes are.")
    want = str(drawing.cycle().sequence) if wanted is None else wanted
    total = n + moves_of(drawing)
    done = 0

    def tell(_: Any = None) -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(min(done, total), total)

    wider, given = 1.0, tolerances
    for _ in range(_MOST_WIDE + 1):
        done = 0
        built, misfits = _drawn(drawing, given, seen, n, seed, tell)
        weights, agreeing = _weights(misfits)
        if agreeing >= _ENOUGH:
            break
        if wider < _WIDER**_MOST_WIDE:
            wider *= _WIDER
            given = _wide(tolerances, wider)
    if not agreeing:
        raise LabError(
            "what was seen",
            f"none of {n} builds with parts up to {number(wider)} times as far off as "
            f"{tolerances!r} does this: check that this design was built, which cell is "
            f"innermost, and where strokes were counted from.",
        )
    known = _known(drawing, built, weights)
    likely = _at_means(drawing, known)
    if likely is None or math.isinf(_misfit(likely, seen)):
        likely = built[int(np.argmin(misfits))]
    # As many of each as its weight says, in even steps, which no chance disturbs.
    places = np.searchsorted(np.cumsum(weights), (np.arange(_BUILT) + 0.5) / _BUILT)
    some = [built[min(int(k), len(built) - 1)] for k in places]
    share, moves = best_moves(drawing, some, want, hole, tell)
    return AsBuilt(
        drawing, seen, want, given, wider, n, seed, agreeing, known, likely, share, moves, hole
    )


def _drawn(
    drawing: Chain,
    tolerances: Tolerances,
    seen: Seen,
    n: int,
    seed: int,
    tell: Callable[[], None],
) -> tuple[list[Chain], Floats]:
    """Builds at random, and how badly each agrees with what was seen."""
    built: list[Chain] = []
    misfits: list[float] = []
    for one in made(drawing, tolerances, n, seed):
        built.append(one)
        misfits.append(_misfit(one, seen))
        tell()
    return built, np.array(misfits)


def _misfit(chain: Chain, seen: Seen) -> float:
    try:
        return seen.misfit(chain.cycle())
    except StepwellError:
        return math.inf


def _weights(misfits: Floats) -> tuple[Floats, float]:
    """The weight of each, their sum 1, and to how many equal ones they amount (Kish 1965)."""
    best = float(np.min(misfits, initial=math.inf))
    if math.isinf(best):
        return np.zeros(len(misfits)), 0.0
    weights = np.exp(best - misfits)
    weights /= np.sum(weights)
    return weights, float(1.0 / np.sum(weights**2))


def _wide(given: Tolerances, wider: float) -> Tolerances:
    """The tolerances so many times as wide; bands keep a stiffness."""
    shares = ("stiffness", "rest_length", "travel")
    return replace(
        given,
        anchor=wider * given.anchor,
        friction=wider * given.friction,
        **{name: min(wider * getattr(given, name), _WIDEST) for name in shares},
    )


def _known(drawing: Chain, built: list[Chain], weights: Floats) -> tuple[Known, ...]:
    found: list[Known] = []
    for one in parameters(drawing):
        if one.part not in _PARTS:
            continue
        values = np.array([_value(one, chain, drawing) for chain in built])
        before = float(np.std(values))
        if before > 0.0:
            mean = float(weights @ values)
            doubt = math.sqrt(float(weights @ (values - mean) ** 2))
            found.append(Known(one, _value(one, drawing, drawing), mean, doubt, before))
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
