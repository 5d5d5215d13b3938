"""Whether a chain can come to rest in one place only: others are out of reach, or cost too much."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import kernel
from stepwell.statics.following import Problem
from stepwell.statics.landings.purse import energy_of
from stepwell.statics.landings.rests import places_of_rest
from stepwell.statics.landings.room import Room
from stepwell.statics.landings.start import Start
from stepwell.statics.landings.ways import boxes_of, grid_of, keeps_off

# A landing is the same within this share of the travels.
SAME = 1e-6
# A place known no better than this may store more than its middle does.
_KNOWN = 1e-7
_MOST_PLACES = 64
# So many cells may move: of more, a grid would be too coarse to tell anything.
MOST_MOVING = 10
# Boxes of the grids, one after the other.
_COARSE, _FINE = 1500, 6000


@kernel
def lands_only_at(
    problem: Problem, start: Start, room: Room, landing: Floats, ratio: float
) -> bool:
    """Whether of all places of rest in a room the landing alone is reached.

    For all mobilities within `ratio`; inf asks for energy alone.
    """
    laws, n = problem.laws, len(landing)
    places = np.empty((_MOST_PLACES, 2, n))
    found = places_of_rest(problem, room, start, places)
    here, others = False, 0
    for c in range(found):
        low, high = places[c, 0], places[c, 1]
        same, known = True, True
        for i in range(n):
            near = SAME * laws.full[i]
            same = same and low[i] >= landing[i] - near and high[i] <= landing[i] + near
            known = known and high[i] - low[i] <= _KNOWN * laws.full[i]
        if same:
            here = True
            continue
        if known:
            # Where there is more energy than at the start the chain does not come.
            more = 10.0 * _KNOWN * problem.scale * np.max(laws.full)
            if energy_of(problem, start, 0.5 * (low + high)) > more:
                continue
        places[others] = places[c]
        others += 1
    if found < 0 or not here:
        return False
    if others == 0:
        return True
    for most in (_COARSE, _FINE):
        grid = grid_of(problem, room, start, most)
        if boxes_of(grid) > 4 * most:
            continue
        if keeps_off(problem, room, start, grid, places[:others], ratio):
            return True
    return False
