"""Where something that holds ceases to hold."""

from collections.abc import Callable


def bisected(
    holds: Callable[[float], bool], good: float, bad: float, halvings: int
) -> tuple[float, float]:
    """The last place found where it still holds, and the first where it does not any more.

    Args:
        holds: what to ask at a place between the two.
        good: a place where it holds.
        bad: one where it does not, above it or below.
        halvings: of the stretch between them.

    Returns:
        The two places; of several changes between them, some one.
    """
    for _ in range(halvings):
        middle = (good + bad) / 2
        if holds(middle):
            good = middle
        else:
            bad = middle
    return good, bad
