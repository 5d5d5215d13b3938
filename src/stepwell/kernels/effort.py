"""What a run may cost, counted in forces looked at."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from stepwell.kernels.fingerprint import kernel
from stepwell.kernels.threads import beside

Ints = NDArray[np.int64]
R = TypeVar("R")


# What the present stroke has cost; how much it may cost at most. Whoever lowers the second while
# a run goes on, from another thread, stops it.
SPENT, MOST = 0, 1


UNLIMITED = int(np.iinfo(np.int64).max)


def watched(run: Callable[[Ints], R], *, long: bool = True, most: int = UNLIMITED) -> R:
    """What run(effort) returns; beside this thread where it may be long, for Ctrl-C's sake."""
    effort = np.array([0, most])
    if not long:
        return run(effort)
    return beside(lambda: run(effort), lambda: end_early(effort))


def end_early(effort: Ints) -> None:
    """Make the kernels that spend this effort return soon."""
    effort[MOST] = -1


@kernel
def overspent(effort: Ints, looks: int) -> bool:
    """Count more looks; whether they are now too many."""
    effort[SPENT] += looks
    return effort[SPENT] > effort[MOST]
