"""Proof by freedom: one cell or one pair moves, and no mobilities call another one."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import UNLIMITED, entry
from stepwell.statics.following import LANDED, STOPPED, Problem, State, along_line
from stepwell.statics.landings.start import Start, room_for, stand_before

# Landings this share of the travel apart are one.
_ALIKE = 1e-9


def goes_one_way(problem: Problem, start: Start, landing: Floats, ratio: float) -> bool:
    """Whether a snap runs along one line to its landing for all mobilities within a ratio.

    Args:
        problem: the chain.
        start: where the snap begins.
        landing: (N,) travels where it lands [m].
        ratio: of the fastest to the slowest beside the given ones, >= 1.
    """
    own = problem._replace(mobility=problem.mobility.copy(), effort=np.array([0, UNLIMITED]))
    return _goes_one_way(own, start, room_for(len(landing)), landing, ratio)


@entry()
def _goes_one_way(
    problem: Problem, start: Start, state: State, landing: Floats, ratio: float
) -> bool:
    """The same, with room for a state and with mobilities to be written to.

    Under a force no cell feels another one, so nothing hangs on mobilities. A cell behind a spring
    and a pair at a fixed stroke go one way, and λ decides whether another cell joins: behind a
    spring it is what the spring says; at a fixed stroke it lies between what one of the pair pulls
    and what the other resists, the nearer to the one the more mobile that one is. So it is enough
    to look at the leader `ratio` times faster and `ratio` times slower: in between λ is in between.
    """
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
