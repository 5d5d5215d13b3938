"""Whether a snap lands in one place for all mobilities within a ratio: all its ways enclosed."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import entry
from stepwell.statics.following import Problem, stand_all_on
from stepwell.statics.landings.only import MOST_MOVING, lands_only_at
from stepwell.statics.landings.purse import narrow
from stepwell.statics.landings.room import leads_on, room_of, whole_room
from stepwell.statics.landings.start import Start


@entry(2.0, "problem.mobility")
def enclosed(problem: Problem, start: Start, landing: Floats, ratio: float) -> bool:
    """Whether the snap lands at `landing` for all mobilities m_i x_i with max x / min x <= ratio.

    Args:
        problem: the chain and its actuator, with the given mobilities m.
        start: where the snap begins.
        landing: (N,) travels where it landed [m], on the sheets of the start.
        ratio: of the fastest to the slowest factor, >= 1.

    Returns:
        True where it is proved; False where it is not, which says nothing.
    """
    laws = problem.laws
    if problem.alpha == 0.0:
        # Under a force no cell feels another one: nothing is to be enclosed.
        return False
    stand_all_on(laws, problem.sheets, problem.pieces, start.sheet)
    room = room_of(problem, start, whole_room(problem, start))
    for _ in range(2):
        moving = np.flatnonzero(room.high > room.low)
        if not 0 < len(moving) <= MOST_MOVING or np.max(laws.friction[moving]) > 0.0:
            return False
        narrow(problem, start, room)
        room = room_of(problem, start, room)
    if leads_on(problem, room):
        return False
    return lands_only_at(problem, start, room, landing, ratio)
