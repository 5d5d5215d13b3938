"""How fast cells move for a given force, beside one another."""

from collections.abc import Iterable
from typing import Protocol

import numpy as np

from stepwell.base import Floats, InputError, check

# Least and largest mobility of a cell. Cells further apart than these are two mechanisms, a fast
# one and a slow one; a double could not follow both.
MOBILITIES = 1e-3, 1e3


class Mobile(Protocol):
    """A cell of any kind."""

    @property
    def mobility(self) -> float:
        """How fast it moves for a given force."""
        ...


def a_mobility(value: float) -> float:
    """`value` as a float; raises ValueError unless it lies within MOBILITIES."""
    number, (least, most) = check.finite("mobility", value, "1"), MOBILITIES
    if not least <= number <= most:
        raise InputError(
            f"mobility = {number:g}: must be between {check.short(least)} and {check.short(most)}; "
            f"only its ratio to that of the other cells counts."
        )
    return number


def mobilities_of(cells: Iterable[Mobile]) -> Floats:
    """(N,) mobilities of cells, the largest of them 1 [1]."""
    own = np.array([cell.mobility for cell in cells])
    return own / np.max(own)
