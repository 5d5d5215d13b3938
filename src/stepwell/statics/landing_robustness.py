"""Robustness of the landing of a snap against the mobilities of the cells."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Ints, check, percent_at_most
from stepwell.kernels import UNLIMITED
from stepwell.mechanism import HIGH, LOW, Chain, phase_at
from stepwell.statics.events import Event
from stepwell.statics.following.pieces import find_piece, stand_all_on
from stepwell.statics.following.snap import COARSE
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.landings.proofs import enclosed, energy_holds, goes_one_way
from stepwell.statics.landings.sampling import corners_of, factors_of, land_all
from stepwell.statics.landings.start import Snap

# Places whose travels differ by less than this fraction of the full travel are one.
_ALIKE = 1e-6
# Steps from equal mobilities to mobilities that lead elsewhere, to find the least such mobilities.
_STEPS = 8
# (N,) travels and sheets.
Place = tuple[Floats, Ints]
# Confidence level of the bound of a sampled landing.
CONFIDENCE = 0.95
# Above this ratio the fast cells take too many steps while the slow ones move.
_MOST_RATIO = 1e3


class Proof(Enum):
    """Proof that a landing holds for all mobilities within a ratio."""

    FREEDOM = "only one cell or one pair moves, and no other cell joins for any mobilities"
    ENERGY = "the available energy reaches no other stable equilibrium"
    ENCLOSURE = "all paths from the start were enclosed, and they lead to one equilibrium"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class OtherLanding(ByValue):
    """Alternative landing of a snap, with mobilities that lead there; N cells.

    Attributes:
        mobility: (N,) factors of the given mobilities, the least 1: the first of eight steps from
            equal factors to sampled ones that leads there.
        travel, sheet: (N,) travels at rest [m], and sheets of the cells' curves.
        state: the phases there, - in transit.
        fraction: fraction of the settled random samples that land there; 0 where only
            mobilities at the ends of the range lead there.
    """

    mobility: tuple[float, ...]
    travel: tuple[float, ...]
    sheet: tuple[int, ...]
    state: str
    fraction: float


@dataclass(frozen=True, slots=True, eq=False)
class Landing(ByValue):
    """Whether a snap lands in one place for all mobilities within a ratio.

    Attributes:
        event: the snap; where it passes through saddles, the first of those that follow at once.
        ratio: largest ratio of two factors of the given mobilities, >= 1.
        proof: the proof that it holds; None where it was only sampled.
        corners, samples: number of settled runs with mobilities at the ends of the range, and with
            random ones that are log-uniform within it; 0 where it is proved.
        elsewhere: all other landings, the most frequent first.
    """

    event: Event
    ratio: float
    proof: Proof | None
    corners: int
    samples: int
    elsewhere: tuple[OtherLanding, ...]

    @property
    def holds(self) -> bool:
        """Whether it is proved, or sampled without any other landing."""
        return self.proof is not None or (self.samples > 0 and not self.elsewhere)

    @property
    def bound(self) -> float:
        """Upper bound of the fraction of mobilities that lead elsewhere; 0 where it is proved.

        Mobilities are log-uniform within the ratio, the confidence is 95 %, and only the random
        samples count (Clopper and Pearson 1934, one-sided). 1 where none came to rest.
        """
        if self.proof is not None:
            return 0.0
        elsewhere = round(self.samples * math.fsum(place.fraction for place in self.elsewhere))
        if elsewhere >= self.samples:
            return 1.0
        if elsewhere == 0:
            return 1.0 - (1.0 - CONFIDENCE) ** (1.0 / self.samples)
        from scipy.special import betaincinv  # pyright: ignore[reportMissingTypeStubs]

        return float(betaincinv(elsewhere + 1, self.samples - elsewhere, CONFIDENCE))

    def __str__(self):
        if self.proof is not None:
            return f"holds for mobility ratios up to {self.ratio:g}: {self.proof.value}."
        tried = f"{self.samples} random samples"
        tried += f" and {self.corners} with extreme mobilities" if self.corners else ""
        if self.holds:
            return (
                f"holds in all of {tried}: for mobility ratios up to {self.ratio:g}, at most "
                f"{percent_at_most(self.bound)} of mobilities lead elsewhere (95 % confidence)."
            )
        if not self.samples:
            return (
                f"is undecided for mobility ratios up to {self.ratio:g}: the cells approach rest "
                f"too slowly."
            )
        places = ", ".join(
            f"{place.state} in {place.fraction:.0%}"
            if place.fraction > 0.0
            else f"{place.state} with extreme mobilities only"
            for place in self.elsewhere
        )
        return (
            f"depends on the mobilities: of {tried} with ratios up to {self.ratio:g}, some lead "
            f"elsewhere: {places}."
        )

    def __repr__(self):
        return f"Landing({self.event!r}: {self})"


def samples_for(bound: float) -> int:
    """Number of samples that must agree to bound the fraction that does not, at 95 % confidence."""
    fraction = check.finite("bound", bound, "1")
    if not 1e-3 <= fraction <= 0.5:
        raise InputError(
            f"bound = {fraction:g}: must be between 0.001 and 0.5; it is the largest fraction of "
            f"mobilities that may lead elsewhere although no sample did."
        )
    return math.ceil(math.log1p(-CONFIDENCE) / math.log1p(-fraction))


def checked_ratio(name: str, value: float) -> float:
    """A ratio of mobilities as a float; raises ValueError unless it is from 1 to a thousand."""
    ratio = check.finite(name, value, "1")
    if not 1.0 <= ratio <= _MOST_RATIO:
        raise InputError(
            f"{name} = {ratio:g}: must be between 1 and {_MOST_RATIO:g}; it is the mobility of the "
            f"fastest cell over that of the slowest."
        )
    return ratio


def landings(
    chain: Chain,
    problem: DrivenChain,
    snaps: Iterable[Snap],
    events: list[Event],
    tried: tuple[float, int, int],
) -> Iterator[Landing]:
    """Robustness of the landing of each snap for a (ratio, samples, seed)."""
    # `events` has snaps that follow at once one by one.
    ratio, samples, seed = tried
    for snap in snaps:
        passed, events = events[: snap.rows], events[snap.rows :]
        proof = _proof(problem, snap, ratio)
        if proof is not None:
            yield Landing(passed[0], ratio, proof, 0, 0, ())
            continue
        cells = sorted({cell for one in passed for cell in one.cells})
        corners = corners_of(np.array(cells), len(chain), ratio, seed)
        factors = factors_of(len(chain), ratio, samples, seed)
        yield Landing(passed[0], ratio, None, *_sampled(chain, problem, snap, corners, factors))


def _proof(problem: DrivenChain, snap: Snap, ratio: float) -> Proof | None:
    start, landing = snap.start, snap.travel
    if goes_one_way(problem, start, landing, ratio):
        return Proof.FREEDOM
    if not np.array_equal(snap.sheet, start.sheet):
        return None
    # The effort of the path does not count.
    fresh = problem._replace(effort=np.array([0, UNLIMITED]))
    if energy_holds(fresh, start, landing):
        return Proof.ENERGY
    return Proof.ENCLOSURE if enclosed(fresh, start, landing, ratio) else None


def _sampled(
    chain: Chain, problem: DrivenChain, snap: Snap, corners: Floats, factors: Floats
) -> tuple[int, int, tuple[OtherLanding, ...]]:
    """Number of corners and of samples that settle, and all other landings."""
    # Other landings count only if a fine flow confirms them; fractions are of samples.
    tried = np.concatenate([corners, factors])
    landed = land_all(problem, snap.start, tried, COARSE)
    places = [(snap.travel, snap.sheet)]
    at = np.full(len(tried), -1)
    for k in np.flatnonzero(landed.settled).tolist():
        here = landed.travel[k], landed.sheet[k]
        for place, there in enumerate(places):
            if same_place(chain, problem, snap, here, there):
                at[k] = place
                break
        else:
            at[k] = len(places)
            places.append(here)
    confirmed: list[tuple[int, Floats, Place]] = []
    parts = at[: len(corners)], at[len(corners) :]
    hits = [[int(np.sum(part == k)) for part in parts] for k in range(len(places))]
    extreme, random = hits[0]
    for k in range(1, len(places)):
        again = _most_equal_factors(chain, problem, snap, tried[np.argmax(at == k)], places[k])
        if again is not None:
            extreme, random = extreme + hits[k][0], random + hits[k][1]
            confirmed.append((hits[k][1], *again))
    elsewhere: list[OtherLanding] = []
    for count, mobility, place in sorted(confirmed, key=lambda one: -one[0]):
        where = tuple(place[0].tolist()), tuple(place[1].tolist()), state_of(chain, *place)
        fraction = count / random if random else 0.0
        elsewhere.append(OtherLanding(tuple(mobility.tolist()), *where, fraction))
    return extreme, random, tuple(elsewhere)


def _most_equal_factors(
    chain: Chain, problem: DrivenChain, snap: Snap, factors: Floats, place: Place
) -> tuple[Floats, Place] | None:
    """Most equal factors that lead to a place, the least 1, and the place that they lead to."""
    # Cells at rest get the least factor, unless it matters because they moved and came back.
    given = factors / np.min(factors)
    moves = (place[0] != snap.start.travel) | (place[1] != snap.start.sheet)
    plain = np.where(moves, given, 1.0)
    if moves.any():
        plain[moves] /= np.min(plain[moves])
    steps = np.arange(1, _STEPS + 1) / _STEPS
    tried = np.concatenate([plain ** steps[:, None], given[None]])
    landed = land_all(problem, snap.start, tried)
    for k in np.flatnonzero(landed.settled).tolist():
        again = landed.travel[k], landed.sheet[k]
        if same_place(chain, problem, snap, place, again):
            return tried[k], again
    return None


def same_place(chain: Chain, problem: DrivenChain, snap: Snap, here: Place, there: Place) -> bool:
    """Whether two landings are one; on a continuum of equilibria phases and stops decide."""
    if not np.array_equal(here[1], there[1]):
        return False
    slip = _ALIKE * problem.laws.full
    if np.all(np.abs(here[0] - there[0]) <= slip):
        return True
    stand_all_on(problem.laws, problem.sheets, problem.pieces, here[1])
    moved = (here[0] != snap.start.travel) | (there[0] != snap.start.travel)
    rubs = np.any(problem.laws.friction[moved] > 0.0)
    if not rubs and min(_constant(problem, here[0]), _constant(problem, there[0])) < 2:
        return False
    ends = problem.sheets.ends[:, [LOW, HIGH]]
    one, two = (np.abs(travel[:, None] - ends) <= slip[:, None] for travel in (here[0], there[0]))
    return np.array_equal(one, two) and state_of(chain, *here) == state_of(chain, *there)


def _constant(problem: DrivenChain, travel: Floats) -> int:
    """Number of cells at travels where their force is constant."""
    pieces = problem.pieces
    on = [find_piece(pieces, i, s, 0) for i, s in enumerate(travel.tolist())]
    return int(np.sum(pieces.sign[on] == 0))


def state_of(chain: Chain, travel: Floats, sheet: Ints) -> str:
    """The phases of a place, - in transit."""
    cells = zip(chain.stretches, sheet.tolist(), travel.tolist(), strict=True)
    return "".join(phase_at(own, on, s) for own, on, s in cells)
