"""Landings of a snap with sampled mobilities, each computed by the engine."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.kernels import entry, kernel, watched
from stepwell.statics.following.pieces import sheets_of
from stepwell.statics.following.smooth import LOST, choose
from stepwell.statics.following.snap import FINE, snap
from stepwell.statics.following.state import GOES, GOES_ON, SENSE, TRIGGER, DrivenChain, State
from stepwell.statics.landings.start import Start, empty_state, stand_before

# Largest number of saddles in one snap.
_SADDLES = 20
# Largest number of samples with mobilities at the ends of their range.
_MOST_CORNERS = 32
# Larger work runs in another thread, so that Ctrl-C works.
_MANY = 2000


class Landings(NamedTuple):
    """Landings of a snap with other mobilities; n samples, N cells."""

    travel: Floats  # (n, N) [m]
    sheet: Ints  # (n, N)
    settled: Ints  # (n,) 1 where it came to rest


def land_all(
    problem: DrivenChain, start: Start, factors: Floats, accuracy: float = FINE
) -> Landings:
    """Landings of a snap with its mobilities times each row of (n, N) factors."""
    count, n = factors.shape
    sheet, settled = np.zeros((count, n), np.int64), np.zeros(count, np.int64)
    landings = Landings(np.empty((count, n)), sheet, settled)
    state, own = empty_state(n), problem._replace(mobility=problem.mobility.copy())

    def land(effort: Ints) -> int:
        limited = own._replace(effort=effort)
        return _land_all(limited, start, state, factors, accuracy, landings)

    watched(land, long=factors.size > _MANY)
    return landings


@entry(3e-2, "factors")
def _land_all(
    problem: DrivenChain,
    start: Start,
    state: State,
    factors: Floats,
    accuracy: float,
    landings: Landings,
) -> int:
    given, rests = problem.mobility.copy(), 0
    for k in range(len(factors)):
        mobility = given * factors[k]
        problem.mobility[:] = mobility / np.max(mobility)
        stand_before(problem, start, state)
        settled = _land(problem, state, start.direction, accuracy)
        landings.travel[k], landings.sheet[k] = state.travel, sheets_of(problem.sheets)
        landings.settled[k] = 1 if settled else 0
        rests += landings.settled[k]
    return rests


@kernel
def _land(problem: DrivenChain, state: State, direction: int, accuracy: float) -> bool:
    """Compute a snap, and further ones while the chain is at a saddle; whether it settles."""
    goes = problem.spare.whole[GOES]
    for _ in range(_SADDLES):
        state.log.used[:] = 0
        if snap(problem, state, direction, accuracy) != GOES_ON:
            return False
        choice, leader = choose(problem, state, direction, goes)
        if choice != LOST:
            return True
        state.next_snap[TRIGGER], state.next_snap[SENSE] = leader, direction
    return False


def corners_of(cells: Ints, count: int, ratio: float, seed: int) -> Floats:
    """(n, N) factors of the mobilities at the ends of their range: 1 or `ratio` for each cell."""
    # All 2^N - 2 for up to five cells. Else each of `cells` fast alone and slow alone, the most
    # important samples, and random ones up to a total of 32.
    if 2**count <= _MOST_CORNERS:
        numbers = range(1, 2**count - 1)
        every = np.array([[bool(n >> k & 1) for k in range(count)] for n in numbers], bool)
        return np.where(every.reshape(-1, count), ratio, 1.0)
    alone: Bools = np.arange(count) == cells[:, None]
    some = np.random.default_rng(seed).random((_MOST_CORNERS, count)) < 0.5
    fast: Bools = np.concatenate([alone, ~alone, some])[:_MOST_CORNERS]
    return np.where(fast, ratio, 1.0)


def factors_of(count: int, ratio: float, samples: int, seed: int) -> Floats:
    """(samples, N) factors of the mobilities at random, log-uniform from 1 to `ratio`."""
    return ratio ** np.random.default_rng(seed).random((samples, count))
