"""Where something that holds ceases to hold."""

from collections.abc import Callable


def bisected(
    holds: Callable[[float], bool], good: float, bad: float, resolution: float
) -> tuple[float, float]:
    """The last place where it still holds, and the first where it does not any more.

    Args:
        holds: what to ask at a place between the two.
        good: a place where it holds.
        bad: one where it does not, above it or below.
        resolution: how near the two come, > 0; nearer than two neighbouring floats they cannot.

    Returns:
        The two places; of several changes between them, some one.
    """
    while abs(bad - good) > resolution:
        middle = (good + bad) / 2
        if middle in (good, bad):
            break
        if holds(middle):
            good = middle
        else:
            bad = middle
    return good, bad
