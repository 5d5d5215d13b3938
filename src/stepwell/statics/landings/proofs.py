"""Proofs that a snap has one landing: by one degree of freedom, by energy, by enclosure."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import UNLIMITED, entry, kernel
from stepwell.statics.following.landing import LANDED, STOPPED
from stepwell.statics.following.pieces import stand_all_on
from stepwell.statics.following.snap import along_line
from stepwell.statics.following.state import DrivenChain, State
from stepwell.statics.landings import reachable_box as reachable
from stepwell.statics.landings.reachability import boxes_of, grid_of, keeps_off
from stepwell.statics.landings.reachable_box import ReachableBox
from stepwell.statics.landings.rests import places_of_rest
from stepwell.statics.landings.start import Start, empty_state, stand_before

# Landings closer than this fraction of the travel are one.
_ALIKE = 1e-9


def goes_one_way(problem: DrivenChain, start: Start, landing: Floats, ratio: float) -> bool:
    """Whether a snap runs along one line to its landing for all mobilities within a ratio."""
    own = problem._replace(mobility=problem.mobility.copy(), effort=np.array([0, UNLIMITED]))
    return _goes_one_way(own, start, empty_state(len(landing)), landing, ratio)


@entry()
def _goes_one_way(
    problem: DrivenChain, start: Start, state: State, landing: Floats, ratio: float
) -> bool:
    """`goes_one_way`, with memory for a state and for mobilities."""
    # Under a force the cells do not interact. Else only λ decides whether another cell joins: that
    # of a spring, or one between the pull of one cell of the pair and the resistance of the other,
    # nearer to that of the more mobile one. So two cases are enough, a leader `ratio` times faster
    # and slower: λ of all other cases is in between.
    if problem.alpha == 0.0:
        return True
    given, full = problem.mobility[start.leader], problem.laws.full
    rubbed = np.zeros(len(landing))
    for times in (ratio, 1.0 / ratio):
        problem.mobility[start.leader] = given * times
        stand_before(problem, start, state)
        outcome, close = along_line(problem, state, start.direction, rubbed)
        if close or (outcome != LANDED and outcome != STOPPED):
            return False
        for i in range(len(landing)):
            if abs(state.travel[i] - landing[i]) > _ALIKE * full[i]:
                return False
    return True


# Landings within this fraction of the travels are the same.
SAME = 1e-6
# A place known with a larger error may store more energy than its middle.
_KNOWN = 1e-7
_MOST_PLACES = 64
# Largest number of moving cells; with more a grid would be too coarse for a proof.
MOST_MOVING = 10
# Boxes of the grids, one after the other.
_COARSE, _FINE = 1500, 6000


@kernel
def lands_only_at(
    problem: DrivenChain, start: Start, box: ReachableBox, landing: Floats, ratio: float
) -> bool:
    """Whether a landing alone is reached for mobilities within `ratio`; inf: by energy alone."""
    laws, n = problem.laws, len(landing)
    places = np.empty((_MOST_PLACES, 2, n))
    rests = places_of_rest(problem, box, start, places)
    here, others, more = False, 0, 10.0 * _KNOWN * problem.scale * np.max(laws.full)
    for c in range(rests):
        low, high = places[c, 0], places[c, 1]
        same, known = True, True
        for i in range(n):
            near = SAME * laws.full[i]
            same = same and low[i] >= landing[i] - near and high[i] <= landing[i] + near
            known = known and high[i] - low[i] <= _KNOWN * laws.full[i]
        here = here or same
        # The chain cannot reach a place with more energy than the start.
        if same or (known and reachable.energy_of(problem, start, 0.5 * (low + high)) > more):
            continue
        places[others] = places[c]
        others += 1
    if rests < 0 or not here:
        return False
    if others == 0:
        return True
    for most in (_COARSE, _FINE):
        grid = grid_of(problem, box, start, most)
        small = boxes_of(grid) <= 4 * most
        if small and keeps_off(problem, box, start, grid, places[:others], ratio):
            return True
    return False


@entry(0.05, "problem.mobility")
def energy_holds(problem: DrivenChain, start: Start, landing: Floats) -> bool:
    """Proof that the energy suffices for no other stable equilibrium than the landing."""
    # Then the snap lands there for all mobilities, and with any masses and dampers.
    if np.max(problem.laws.friction) > 0.0 or len(landing) > MOST_MOVING:
        return False
    stand_all_on(problem.laws, problem.sheets, problem.pieces, start.sheet)
    box = reachable.full_box(problem, start)
    # Each time with shorter steps, as the box is smaller.
    for _ in range(3):
        reachable.narrow(problem, start, box)
    if reachable.leads_on(problem, box):
        return False
    return lands_only_at(problem, start, box, landing, np.inf)


@entry(0.3, "problem.mobility")
def enclosed(problem: DrivenChain, start: Start, landing: Floats, ratio: float) -> bool:
    """Proof that all factors of mobilities with max x / min x <= ratio lead to a landing."""
    laws = problem.laws
    if problem.alpha == 0.0:
        # Under a force the cells do not interact: nothing is to be enclosed.
        return False
    stand_all_on(laws, problem.sheets, problem.pieces, start.sheet)
    box = reachable.narrowed_box(problem, start, reachable.full_box(problem, start))
    for _ in range(2):
        moving = np.flatnonzero(box.high > box.low)
        if not 0 < len(moving) <= MOST_MOVING or np.max(laws.friction[moving]) > 0.0:
            return False
        reachable.narrow(problem, start, box)
        box = reachable.narrowed_box(problem, start, box)
    if reachable.leads_on(problem, box):
        return False
    return lands_only_at(problem, start, box, landing, ratio)
