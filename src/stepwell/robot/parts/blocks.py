"""The moving blocks of a leg: their masses, and what damps them."""

from __future__ import annotations

from dataclasses import dataclass

from stepwell.base import ByValue, check


@dataclass(frozen=True, slots=True, eq=False)
class Blocks(ByValue):
    """What every block of every leg weighs and how it is damped.

    Args:
        mass: of each block that moves [kg], > 0.
        carriage: of the actuator's moving part, which joins the outermost blocks [kg], > 0.
        damping: of each cell's travel [N s/m], > 0; it stands for the loss in the rubber and
            the joints.
        width, length: outline that meets walls and other legs [m], > 0.

    Raises:
        ValueError: a value out of range.
    """

    mass: float = 0.006
    carriage: float = 0.010
    damping: float = 1.0
    width: float = 0.030
    length: float = 0.020

    def __post_init__(self):
        units = {"mass": "kg", "carriage": "kg", "damping": "N s/m", "width": "m", "length": "m"}
        for name, unit in units.items():
            object.__setattr__(self, name, check.positive(name, getattr(self, name), unit))
