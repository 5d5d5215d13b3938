"""For which mobilities of its cells a snap lands where it does."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Ints, check, require
from stepwell.mechanism import HIGH, LOW, MOBILITIES, Chain, phase_at
from stepwell.statics.events import Event
from stepwell.statics.following import Problem, log as logged, stand_all_on
from stepwell.statics.landings import Snap, factors_of, land_all, snaps_of

# Places whose travels differ by less than this share of the full travel are one.
_ALIKE = 1e-6
# Cells further apart than the least and the largest mobility can be nobody has.
MOST_RATIO = MOBILITIES[1] / MOBILITIES[0]


class Proof(Enum):
    """Why a landing holds for all mobilities within a ratio."""

    FREEDOM = "only one cell or one pair moves, and for no mobilities would another one join"
    ENERGY = "no other place of rest can be reached with the energy that there is"
    ENCLOSURE = "all ways from the start were enclosed, and they lead to one place"


@dataclass(frozen=True, slots=True, eq=False)
class Elsewhere(ByValue):
    """Another place where a snap lands, with mobilities that lead there; N cells.

    Attributes:
        mobility: (N,) factors beside the given mobilities, the least 1.
        travel: (N,) where it comes to rest [m].
        sheet: (N,) on which sheets of the cells' curves.
        state: the phases there, - in transit.
        share: of the samples, those that land there.
    """

    mobility: tuple[float, ...]
    travel: tuple[float, ...]
    sheet: tuple[int, ...]
    state: str
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class Landing(ByValue):
    """Whether a snap lands in one place for all mobilities within a ratio.

    Attributes:
        event: the snap; where it passes through saddles, the first of those that follow at once.
        ratio: of the fastest to the slowest factor beside the given mobilities, >= 1.
        proof: why it holds; None where it was only sampled.
        samples: how many mobilities were tried; 0 where it is proved.
        elsewhere: every other place that was found, the most frequent first.
    """

    event: Event
    ratio: float
    proof: Proof | None
    samples: int
    elsewhere: tuple[Elsewhere, ...]

    @property
    def holds(self) -> bool:
        """Whether no mobilities were found that lead elsewhere."""
        return not self.elsewhere

    def __str__(self):
        if self.proof is not None:
            return f"holds for mobilities up to {self.ratio:g} apart: {self.proof.value}."
        if self.holds:
            return (
                f"holds in all of {self.samples} samples of mobilities up to {self.ratio:g} apart."
            )
        places = ", ".join(f"{place.state} in {place.share:.0%}" for place in self.elsewhere)
        return (
            f"hangs on the mobilities: of {self.samples} samples up to {self.ratio:g} apart, it "
            f"lands elsewhere: {places}."
        )

    def __repr__(self):
        return f"Landing({self.event!r}: {self})"


def landings(
    chain: Chain,
    problem: Problem,
    log: logged.Log,
    start: tuple[Floats, Ints],
    events: list[Event],
    *,
    ratio: float,
    samples: int,
    seed: int,
) -> Iterator[Landing]:
    """Whether each snap of a path lands where it does for all mobilities within a ratio.

    Args:
        chain: what moved.
        problem: that it sets.
        log: what was written down of the path.
        start: (N,) travels [m] and sheets at its beginning.
        events: its snaps, in order.
        ratio, samples, seed: as for `Path.landings`.

    Raises:
        ValueError: a ratio below 1 or above MOST_RATIO, or less than one sample.
    """
    ratio = check.finite("ratio", ratio, "1")
    if not 1.0 <= ratio <= MOST_RATIO:
        raise InputError(
            f"ratio = {ratio:g}: must be between 1 and {check.short(MOST_RATIO)}, that of the "
            f"fastest to the slowest cell."
        )
    samples, seed = check.whole("samples", samples, 1), check.whole("seed", seed, 0)
    require("samples", samples, "samples =")
    at = 0
    for found in snaps_of(problem, log, *start):
        cells = sorted({cell for event in events[at : at + found.rows] for cell in event.cells})
        factors = factors_of(np.array(cells), len(chain), ratio, samples, seed)
        elsewhere = _elsewhere(chain, problem, found, factors)
        yield Landing(events[at], ratio, None, samples, tuple(elsewhere))
        at += found.rows


def _elsewhere(chain: Chain, problem: Problem, snap: Snap, factors: Floats) -> list[Elsewhere]:
    """Every place but its own where a snap lands with other mobilities, most frequent first."""
    count = len(factors)
    landed = land_all(problem, snap.start, factors)
    places = [(snap.travel, snap.sheet)]
    first, hits = [-1], [0]
    for k in np.flatnonzero(landed.settled).tolist():
        here = landed.travel[k], landed.sheet[k]
        for place, there in enumerate(places):
            if same_place(chain, problem, here, there):
                hits[place] += 1
                break
        else:
            places.append(here)
            first.append(k)
            hits.append(1)
    order = sorted(range(1, len(places)), key=lambda place: -hits[place])
    return [
        Elsewhere(
            tuple((factors[first[p]] / np.min(factors[first[p]])).tolist()),
            tuple(places[p][0].tolist()),
            tuple(places[p][1].tolist()),
            state_of(chain, *places[p]),
            hits[p] / count,
        )
        for p in order
    ]


def same_place(
    chain: Chain, problem: Problem, here: tuple[Floats, Ints], there: tuple[Floats, Ints]
) -> bool:
    """Whether two landings are one.

    Friction makes a continuum of places of rest: on it phases and stops decide.
    """
    if not np.array_equal(here[1], there[1]):
        return False
    if np.all(np.abs(here[0] - there[0]) <= _ALIKE * problem.laws.full):
        return True
    if not np.any(problem.laws.friction > 0.0):
        return False
    stand_all_on(problem.laws, problem.sheets, problem.pieces, here[1])
    ends, slip = problem.sheets.ends[:, [LOW, HIGH]], _ALIKE * problem.laws.full
    one, two = (np.abs(travel[:, None] - ends) <= slip[:, None] for travel in (here[0], there[0]))
    return np.array_equal(one, two) and state_of(chain, *here) == state_of(chain, *there)


def state_of(chain: Chain, travel: Floats, sheet: Ints) -> str:
    """The phases of a place, - in transit."""
    cells = zip(chain.stretches, sheet.tolist(), travel.tolist(), strict=True)
    return "".join(phase_at(own, on, s) for own, on, s in cells)
