"""Phases: where a cell can stand under a prescribed force."""

from dataclasses import dataclass

from stepwell.base import ByValue, brief


@dataclass(frozen=True, slots=True, eq=False)
class Phase(ByValue):
    """A connected stretch of a cell's travel that is stable under a prescribed force.

    That is a stretch on which the force does not fall, stops included: the lever cells of Kamp et
    al. 2024 have two, their stops. A digit of a state is the number of a phase.

    Attributes:
        sheet: which sheet of the cell's curve it lies on; 0 but for curves that fold back.
        low, high: travels between which it lies [m]; infinite where the curve goes on for ever.
        force_low, force_high: the cell leaves it downwards at a force below the one and upwards at
            a force above the other [N]; infinite where it never does.
    """

    sheet: int
    low: float
    high: float
    force_low: float
    force_high: float

    def __repr__(self):
        return brief(self)


# Where a phase lies: its sheet, and the travels between which [m].
Stretch = tuple[int, float, float]


def phase_at(stretches: tuple[Stretch, ...], sheet: int, travel: float) -> str:
    """The digit of the phase that holds a place [m], or - in transit between two.

    Args:
        stretches: where the phases of the cell lie, in their order.
        sheet, travel: the place.
    """
    for digit, (own, low, high) in enumerate(stretches):
        if own == sheet and low <= travel <= high:
            return str(digit)
    return "-"
