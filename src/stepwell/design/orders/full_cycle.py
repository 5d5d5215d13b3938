"""Full cycles as text and as two orders of cells."""

from itertools import pairwise

import numpy as np

from stepwell.base import InputError, Ints
from stepwell.sequences import Sequence


def checked_cycle(wanted: str, cells: int, name: str = "wanted") -> str:
    """A full cycle of so many cells without its spaces; messages call it `name`.

    Raises:
        ValueError: a text that is none.
    """
    states = wanted.replace(" ", "").split(">")
    example = f"for example {short(str(Sequence.full_cycle(range(cells), range(cells))))!r}"
    for state in states:
        if len(state) != cells or not set(state) <= {"0", "1"}:
            raise InputError(
                f"{name} = {short(wanted)!r}: state {short(state)!r} must be {cells} characters 0 "
                f"or 1, one a cell, inner first, with > between states; {example}."
            )
    if states[0] != "0" * cells or states[-1] != "0" * cells or "1" * cells not in states:
        raise InputError(
            f"{name} = {short(wanted)!r}: a full cycle begins and ends with all cells at 0 and "
            f"passes the state with all at 1; {example}."
        )
    if any(a == b for a, b in pairwise(states)):
        raise InputError(
            f"{name} = {short(wanted)!r}: the same state twice in a row; name it once a visit, "
            f"{example}."
        )
    return ">".join(states)


def orders_of(wanted: str) -> Ints | None:
    """(2, N) the cells in order of loading and of unloading; None unless each moves once a way."""
    found = Sequence.parse(wanted).orders
    return None if found is None else np.array(found)


def numbered_cycle(number: int, cells: int) -> str:
    """The cycle whose two orders are the digits of a number in base `cells`."""
    digits = [number // cells**place % cells for place in reversed(range(2 * cells))]
    return str(Sequence.full_cycle(digits[:cells], digits[cells:]))


def short(sequence: str) -> str:
    """A sequence that fits on a line."""
    return sequence if len(sequence) <= 80 else f"{sequence[:60]}..."
