"""What a run may cost, counted in forces looked at."""

from stepwell.kernels import kernel
from stepwell.statics._law import Ints

# What the present leg has cost; how much it may cost at most; how many legs are done. Whoever
# lowers the second while a run goes on, from another thread, stops it.
SPENT, MOST, LEGS = 0, 1, 2


@kernel
def overspent(effort: Ints, looks: int) -> bool:
    """Count more looks; whether they are now too many."""
    effort[SPENT] += looks
    return effort[SPENT] > effort[MOST]
