"""As-built parameters of a first build from its observed behaviour, and anchors to move."""

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

# Every move is tried on 32 of the agreeing builds, the 3 best moves on all of them.
_FIRST, _BEST = 32, 3
# For larger moves of an anchor another design is better.
MOST_HOLES = 3
# Pairs of anchors are tried if no single move reaches this fraction; from the 8 best single moves.
_ENOUGH, _PAIRED = 0.95, 8


@dataclass(frozen=True, eq=False)
class AnchorMove(ByValue):
    """One anchor moved along x or y, by a number of holes.

    Attributes:
        anchor: q of a cell; moving p by the opposite vector has the same effect.
        was, to: nominal position for its first band, before and after the move [m].
    """

    anchor: Parameter
    was: Vec2
    to: Vec2
    holes: int

    def of(self, chain: Chain) -> Chain:
        """The chain after this step."""
        return builds.moved(chain, self.anchor, self.was, self.to)

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
    """One or two anchors moved to other holes: a step for each anchor and direction.

    `fraction` of the agreeing builds reach the target after the move.
    """

    steps: tuple[AnchorMove, ...]
    fraction: float

    @property
    def anchor(self) -> Parameter:
        """The anchor of the first step."""
        return self.steps[0].anchor

    @property
    def was(self) -> Vec2:
        """Nominal position before the first step [m]."""
        return self.steps[0].was

    @property
    def to(self) -> Vec2:
        """Nominal position after the first step [m]."""
        return self.steps[0].to

    def of(self, chain: Chain) -> Chain:
        """The chain after this move."""
        for step in self.steps:
            chain = step.of(chain)
        return chain

    def __str__(self):
        return "move " + " and ".join(map(str, self.steps))

    def __repr__(self):
        return f"Move({self}: {base.percent(self.fraction)})"


def best_moves(
    drawing: Chain,
    built: Sequence[Chain],
    target: str,
    hole: float,
    fraction: float,
    count_trial: Callable[[], None],
) -> tuple[Move, ...]:
    """Moves that reach the target significantly more often than the unmoved anchors, best first.

    One anchor is moved along x or y, by the least number of holes that helps. If that does not
    repair nearly all builds, two anchors are moved by one hole each. A move of two is returned
    only if it is significantly better than a move of one.
    """

    def beyond(one: float, other: float) -> bool:
        # Twice the standard deviation of the difference of two fractions of n builds.
        both = (one + other) / 2
        return one - other > 2.0 * math.sqrt(2.0 * both * (1.0 - both) / len(built))

    def better(moves: list[Move], than: float) -> list[Move]:
        best = sorted(moves, key=lambda move: -move.fraction)[:_BEST]
        again = [_with_fraction(move.steps, built, target) for move in best]
        held = [move for move in again if beyond(move.fraction, than)]
        return sorted(held, key=lambda move: -move.fraction)

    def judged(steps: tuple[AnchorMove, ...]) -> Move:
        count_trial()
        return _with_fraction(steps, built[:_FIRST], target)

    if fraction == 1.0:
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
        if chosen := better(moves, fraction):
            break
    most = chosen[0].fraction if chosen else fraction
    if most < _ENOUGH:
        single = sorted(near, key=lambda move: -move.fraction)[:_PAIRED]
        pairs = [
            judged((*a.steps, *b.steps)) for a, b in combinations(single, 2) if not _reverses(a, b)
        ]
        chosen = [*better(pairs, most), *chosen][:_BEST]
    return tuple(chosen)


def moves_of(chain: Chain) -> int:
    """Number of moves of one anchor and of two to try."""
    steps = len(builds.WAYS) * len(builds.outer_anchors(chain))
    paired = min(steps, _PAIRED)
    return MOST_HOLES * steps + paired * (paired - 1) // 2


def _reverses(a: Move, b: Move) -> bool:
    """Whether the second move reverses the first one."""
    there = (a.to[0] - a.was[0] + b.to[0] - b.was[0], a.to[1] - a.was[1] + b.to[1] - b.was[1])
    return a.anchor == b.anchor and there == (0.0, 0.0)


def _with_fraction(steps: tuple[AnchorMove, ...], built: Sequence[Chain], target: str) -> Move:
    move, count = Move(steps, 0.0), 0
    for one in built:
        with suppress(StepwellError):  # With the anchor there it cannot be built.
            count += does(move.of(one), target)
    return Move(steps, count / len(built))


def does(chain: Chain, target: str) -> bool:
    """Whether a chain has the target sequence without a tie."""
    try:
        cycle = chain.cycle()
    except StepwellError:
        return False
    return str(cycle.sequence) == target and not cycle.degenerate


# Assumed tolerances of a first build before its test: drilled by hand, bands of one bag.
FIRST_BUILD = Tolerances(anchor=0.001, stiffness=0.10, travel=0.05)
# If few builds agree, or agree badly, the tolerances are widened, by at most 8 times. The standard
# deviation of a band's stiffness stays below a quarter.
_MOST_WIDE, _WIDEST = 8.0, 0.24
# Largest mean misfit per number; its expected value is a half for a build that agrees.
_AGREE = 2.0
# Probability of an anchor in a neighbouring hole: ten of two hundred.
WRONG_HOLE = 0.05
_MOST_WRONG = 0.4  # for one anchor; the two of a cell are then probably not both right
_RARE = 0.05  # fraction of builds below which a wrong hole is not reported
# A number is identified if its standard deviation shrinks below this fraction.
_IDENTIFIED = 0.8
# Reported numbers of every cell. A motion depends on d = q - p alone, so p is nominal.
_PARTS = ("q.x", "q.y", "stiffness", "force_scale", "travel_scale", "friction")


@dataclass(frozen=True, eq=False)
class ParameterEstimate(ByValue):
    """Estimate of one parameter of a build, given the observations.

    Attributes:
        drawn: nominal value.
        value, doubt: mean and standard deviation, given the observations; the latter is NaN if all
            agreeing builds are one random build, whose scatter is not known.
        before: standard deviation before the observations.
    """

    parameter: Parameter
    drawn: float
    value: float
    doubt: float
    before: float

    @property
    def identified(self) -> bool:
        """Whether observations reduce its uncertainty, or move it far from the nominal value."""
        if math.isnan(self.doubt):
            return False
        return self.doubt < _IDENTIFIED * self.before or abs(self.value - self.drawn) > self.before

    def __repr__(self):
        return (
            f"ParameterEstimate({self.parameter.name}: {self.value:.4g} ± {self.doubt:.2g} "
            f"{self.parameter.unit}, drawn {self.drawn:.4g})"
        )


@dataclass(frozen=True, eq=False)
class AsBuilt(ByValue):
    """Inferred parameters of a build, and the anchor moves that would make it reach the target.

    Attributes:
        drawing: the nominal design.
        seen, target: the observations, and the target sequence.
        tolerances: assumed tolerances of the parts.
        wider: factor by which the given tolerances were widened; 1 if they were sufficient.
        samples, seed: number of builds that agree, and random seed.
        agreeing: fraction of random builds with the observed sequence of snaps [1].
        known: estimates of all parameters of all cells.
        chain: the build with the mean parameters. If these together have another sequence, the
            random build that agrees best.
        fraction: fraction of the agreeing builds that reach the target without a move.
        moves: up to three moves that help significantly, best first; empty for none.
        hole: distance between holes [m].
        chance: assumed probability of an anchor one hole off.
        wrong: anchors in a neighbouring hole in at least 5 % of the agreeing builds, likeliest
            first.
        converged: whether enough random builds have the observed sequence of snaps, and the mean
            deviation of the agreeing ones is within the uncertainty of the observations.
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
    fraction: float
    moves: tuple[Move, ...]
    hole: float
    chance: float = WRONG_HOLE
    wrong: tuple[builds.WrongHole, ...] = ()
    converged: bool = True

    @property
    def single(self) -> bool:
        """Whether all agreeing builds are one random build: no standard deviation is known."""
        return bool(self.known) and all(math.isnan(one.doubt) for one in self.known)

    @property
    def advice(self) -> str:
        """Recommended change, with the fractions before and after it."""
        now = f"{base.percent(self.fraction)} of the builds that agree reach the target"
        if self.moves:
            best = self.moves[0]
            return f"{best}: {now} unchanged, {base.percent(best.fraction)} after the move"
        if not moves_of(self.drawing):
            return f"{now}; it has no anchor to move"
        far = base.number(base.to_unit(MOST_HOLES * self.hole, "mm"))
        return (
            f"leave its anchors: {now}, and no move of one anchor by up to {far} mm helps, nor of "
            f"two by {base.number(base.to_unit(self.hole, 'mm'))} mm"
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
    """Infer as-built parameters from the observed behaviour, and which anchors to move.

    Builds are drawn at random within the tolerances until they agree with the observations within
    their uncertainty. Anchors are in the nominal holes or, seldom, in neighbouring ones. If no
    builds agree, the tolerances are doubled, up to eight times. Estimates are means over the
    agreeing builds. Moves of one anchor by up to three holes, or of two by one, are tried on them.

    Args:
        drawing: the nominal design.
        seen: the observations.
        tolerances: of its parts.
        target: target sequence; by default that of the nominal design.
        hole: distance between holes [m].
        wrong_hole: probability of an anchor in the neighbouring hole, along x or y [1].
        samples, seed: number of builds, and random seed.
        progress: called with (done, total) builds and moves.

    Raises:
        LabError: no build within eight times the tolerances agrees with the observations.
        ValueError: an argument out of range.
    """
    base.check.whole("samples", samples, 100)
    base.check.whole("seed", seed, 0)
    if not 0 < hole < math.inf:
        raise InputError(f"hole = {hole} m: must be > 0, the distance between holes.")
    if not 0 <= wrong_hole <= _MOST_WRONG:
        raise InputError(f"wrong_hole = {wrong_hole}: must be 0 to {_MOST_WRONG}, 0 for none.")
    last = drawing.last_state
    names = drawing.names
    nominal = str(drawing.cycle().sequence)
    sequence = nominal if target is None else checked_cycle(target, last, "target", names)
    if seen.sequence is not None:
        seen = replace(seen, sequence=checked_cycle(seen.sequence, last, "seen", names))
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
        agrees = bool(matching and not matching.few and np.mean(matching.misfits) <= most)
        if agrees or wider >= _MOST_WIDE:
            break
        wider *= 2.0
        total += samples * (1 + 4 * builds.STEPS)
    if matching is None:
        raise LabError(
            "what was seen",
            f"none of {samples} builds within {wider:g} times the tolerances ({tolerances}) has "
            f"this behaviour: check that this design was built, which cell is innermost, and where "
            f"stroke 0 is.",
        )
    known = _known(drawing, matching)
    likely = matching.built[int(np.argmin(matching.misfits))]
    with suppress(StepwellError):  # The means may be no chain, or another sequence.
        means = reduce(lambda chain, one: one.parameter.changed(chain, one.value), known, drawing)
        likely = means if math.isfinite(seen.misfit(means.cycle())) else likely
    fraction = sum(does(one, sequence) for one in matching.built) / samples
    moves = best_moves(drawing, matching.built, sequence, hole, fraction, count)
    return AsBuilt(
        drawing,
        seen,
        sequence,
        given,
        wider,
        samples,
        seed,
        matching.fraction,
        known,
        likely,
        fraction,
        moves,
        hole,
        wrong_hole,
        _wrong(drawing, holes, matching),
        agrees,
    )


def _wide(given: Tolerances, wider: float, drawing: Chain) -> Tolerances:
    """Tolerances of anchors and friction times `wider`; for elements, those of the scales."""
    wide = given.scaled(wider, "anchor", "friction")
    if len(drawing.elements) < len(drawing):
        return wide
    return wide.scaled(wider, "stiffness", "travel", most=_WIDEST)


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
    return tuple(sorted(wrong, key=lambda one: -one.fraction))


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
            mean = float(np.mean(after))
            doubt = float(np.std(after)) if np.ptp(after) else math.nan
            estimates.append(ParameterEstimate(one, drawn, mean, doubt, spread))
    return tuple(estimates)


def _value(one: Parameter, chain: Chain, drawing: Chain) -> float:
    """A parameter of a build; q relative to the nominal p, since a motion depends on q - p."""
    value: Any = one.value(chain)
    if one.part.startswith("q."):
        inner = replace(one, part=one.part.replace("q", "p"))
        there: Any = inner.value(drawing)
        return float(value - inner.value(chain) + there)
    return float(value)
