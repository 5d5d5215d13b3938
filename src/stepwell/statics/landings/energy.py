"""Whether a snap lands in one place whatever slows it down: anything else takes more energy."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import entry
from stepwell.statics.following import Problem, stand_all_on
from stepwell.statics.landings.only import MOST_MOVING, lands_only_at
from stepwell.statics.landings.purse import narrow
from stepwell.statics.landings.room import leads_on, whole_room
from stepwell.statics.landings.start import Start


@entry(2.0, "problem.mobility")
def energy_holds(problem: Problem, start: Start, landing: Floats) -> bool:
    """Whether the energy at the start suffices for no other place of rest than `landing`.

    Then the snap lands there for all mobilities, and with any masses and dampers.

    Args:
        problem: the chain and its actuator.
        start: where the snap begins, at rest.
        landing: (N,) travels where it landed [m], on the sheets of the start.

    Returns:
        True where it is proved; False where it is not, which says nothing.
    """
    if np.max(problem.laws.friction) > 0.0 or len(landing) > MOST_MOVING:
        return False
    stand_all_on(problem.laws, problem.sheets, problem.pieces, start.sheet)
    room = whole_room(problem, start)
    # Each time with shorter steps, as the room is smaller.
    for _ in range(3):
        narrow(problem, start, room)
    if leads_on(problem, room):
        return False
    return lands_only_at(problem, start, room, landing, np.inf)
