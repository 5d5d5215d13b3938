"""Full cycles read from text, and the orders in which they move the cells."""

from itertools import pairwise

from stepwell.sequences import Sequence

Orders = tuple[tuple[int, ...], tuple[int, ...]]


def parsed(text: str) -> Sequence:
    """States with ">" between them, such as 00>10>11>01>00, as a sequence; all as long."""
    states = text.replace(" ", "").split(">")
    flips = tuple(
        tuple(i for i, (was, now) in enumerate(zip(a, b, strict=True)) if was != now)
        for a, b in pairwise(states)
    )
    return Sequence(states[0], flips)


def orders_of(sequence: Sequence) -> Orders | None:
    """Cells in order of loading and of unloading; None where they do not go one by one."""
    cells = len(sequence.first)
    order = tuple(cell for flip in sequence.flips for cell in flip)
    if len(sequence.flips) != 2 * cells or len(order) != 2 * cells:
        return None
    loading, unloading = order[:cells], order[cells:]
    if len(set(loading)) < cells or len(set(unloading)) < cells:
        return None
    return loading, unloading
