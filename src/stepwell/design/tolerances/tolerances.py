"""How far a built mechanism may be from its drawing."""

import math
from dataclasses import dataclass, fields

import numpy as np

from stepwell.base import ByValue, InputError, told_in, usual
from stepwell.design.orders import switching_forces
from stepwell.design.parameters import WAY
from stepwell.mechanism import MOBILITIES, Cell, Chain, SlipError, sizes

_UNITS = {
    "anchor": "m",
    "stiffness": "1",
    "rest_length": "1",
    "lever": "m",
    "friction": "N",
    "travel": "1",
    "mobility": "a ratio",
}


@dataclass(frozen=True, slots=True, eq=False)
class Tolerances(ByValue):
    """How far the parts of a built mechanism may be from the drawing, each by itself.

    Of an element there are `stiffness`, `friction` and `travel`. Its `error_band` is no tolerance:
    it says how well one curve is known, not how much its copies differ.

    Args:
        anchor: every anchor p and q lies anywhere within this radius, evenly over the disc [m].
        stiffness: standard deviation of each band's k over its mean, normal, cut at four; of an
            element, of all its forces alike [1].
        rest_length: the same of ℓ0 [1].
        lever: every cell's lever is up to this much longer or shorter, evenly [m].
        friction: every cell's friction is up to this much more than drawn, evenly [N].
        travel: standard deviation of all travels of an element alike, normal, cut at four [1].
        mobility: two cells that are drawn equally mobile are up to so many times apart: each is
            drawn evenly on a scale of logarithms; 1 leaves them as drawn [1].

    Raises:
        ValueError: a value that is negative or not finite, a spread of a quarter or more, which
            would allow bands of no stiffness, or a `mobility` below 1.
    """

    anchor: float = 0.0
    stiffness: float = 0.0
    rest_length: float = 0.0
    lever: float = 0.0
    friction: float = 0.0
    travel: float = 0.0
    mobility: float = 1.0

    def __post_init__(self):
        for field in fields(self):
            value, least = float(getattr(self, field.name)), float(field.name == "mobility")
            if not least <= value < math.inf:
                unit = _UNITS[field.name]
                raise InputError(
                    f"{field.name} = {value} [{unit}]: must be >= {least:g} and finite."
                )
            if _UNITS[field.name] == "1" and value >= 0.25:
                raise InputError(
                    f"{field.name} = {value}: must be < 0.25; it is a fraction, so 5 % is 0.05."
                )
            object.__setattr__(self, field.name, value)

    def __repr__(self):
        travel = f", travel {self.travel:.3g}" if self.travel else ""
        if self.mobility > 1:
            travel += f", mobilities up to {self.mobility:.4g} times apart"
        return (
            f"Tolerances(anchors ±{self.anchor * 1e3:.4g} mm, stiffness {self.stiffness:.3g}, "
            f"rest length {self.rest_length:.3g}, levers ±{self.lever * 1e3:.4g} mm, friction "
            f"+{self.friction:.3g} N{travel})"
        )


USUAL = Tolerances(anchor=usual.ANCHOR, stiffness=usual.STIFFNESS)
"""What a careful workshop with a bag of rubber bands can do."""


def refuse_slips(tolerances: Tolerances, travel: float, force: float, way: str = WAY) -> None:
    """Raise SlipError for tolerances above the travel, or a friction far above the forces.

    Args:
        tolerances: how far the parts may be from a drawing.
        travel: the longest of its cells [m].
        force: about what the bands of its strongest cell pull with [N].
        way: how the odd true case is told.
    """
    found = [
        slip
        for name in ("anchor", "lever")
        for slip in sizes.above(name, getattr(tolerances, name), travel)
    ]
    found += sizes.force("friction", tolerances.friction, force)
    if found:
        raise SlipError(tuple(found), way)


def meet(tolerances: Tolerances, chain: Chain) -> None:
    """Refuse tolerances that this chain cannot have.

    Raises:
        SlipError: they are probably in another unit.
        ValueError: mobilities beyond those that a cell can have.
    """
    (least, most), wide = MOBILITIES, math.sqrt(tolerances.mobility)
    for name, cell in zip(chain.names, chain.cells, strict=True):
        room = min(cell.mobility / least, most / cell.mobility)
        if wide > room:
            raise InputError(
                f"mobility = {tolerances.mobility:g}: {name} is drawn with {cell.mobility:g}, and "
                f"must stay between {least:g} and {most:g}: {room**2:.4g} at most."
            )
    cells = levers_of(chain)
    if cells and not chain.unusual:
        travel = max(cell.full_travel for cell in cells)
        refuse_slips(tolerances, travel, max(sizes.own_force(c, c.lever) for c in cells))


def refuse_reach(chain: Chain, reach: float) -> None:
    """Raise SlipError for a displacement [m] far beyond the levers, if no default."""
    lever = max((cell.lever for cell in levers_of(chain)), default=math.inf)
    found = tuple(sizes.far("reach", reach, lever)) if reach > usual.REACH else ()
    if found and not chain.unusual:
        raise SlipError(found, WAY)


def levers_of(chain: Chain) -> list[Cell]:
    """Those of its cells that have levers and bands."""
    return [cell for cell in chain.cells if isinstance(cell, Cell)]


def frictionless(tolerances: Tolerances, chain: Chain) -> str:
    """What to know of mechanisms without friction; "" where there is some."""
    if tolerances.friction or any(cell.friction for cell in chain.cells):
        return ""
    least = float(np.min(np.abs(switching_forces(chain)), initial=math.inf))
    if chain.elements:
        unit, factor = told_in(chain.measure.force_unit)
        beside = f"switching forces of {least * factor:.3g} {unit}"
    else:
        beside = f"forces F0 and F1 of {least * 1e3:.3g} mN"
    return (
        f"without any friction, beside {beside} and more: give "
        f"the cells or the tolerances some if yours has it"
    )
