"""Steel extension springs of round wire that have the rate, length and load of a band."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from stepwell.base import ByValue, from_unit, to_unit
from stepwell.mechanism import Band, Cell

# Shear modulus [Pa] and density [kg/m³] of spring wire, EN 10270-1.
SHEAR, DENSITY = 81.5e9, 7850.0
# Preferred wires [m] of EN 10270-1, and mean diameters of coils over that of the wire.
WIRES = tuple(
    from_unit(mm, "mm")
    for mm in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.6, 1.8, 2.0, 2.25, 2.5)
)
RATIOS = 4.0, 20.0
_STEP = from_unit(0.5, "mm")  # of mean diameters
# Shear stress over tensile strength that cold coiled extension springs bear, EN 13906-2.
ALLOWED = 0.45
# Length of a loop over the inner diameter of the coils.
LOOP = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class WireSpring(ByValue):
    """A steel extension spring without initial tension; a computed one, no catalogue part.

    Attributes:
        wire: diameter of the wire [m].
        coil: mean diameter of the coils [m].
        coils: number of active coils, not rounded.
        rate: k [N/m].
        body_length: of coils and two short loops [m]; longer loops make it the rest length.
        load: at the largest length [N].
        stress: there, with the curvature of the wire [Pa].
        allowed: largest permitted stress [Pa].
        mass: with both loops [kg].

    Source: EN 13906-2 and EN 10270-1 (wire SH), simplified: Wahl's factor, loops of one turn.
    """

    wire: float
    coil: float
    coils: float
    rate: float
    body_length: float
    load: float
    stress: float
    allowed: float
    mass: float


def wire_springs(band: Band, longest: float) -> tuple[WireSpring, ...]:
    """Springs with the stiffness and rest length of a band that bear its largest length.

    For each preferred wire the coil of least stress whose body and loops fit into the rest length.

    Args:
        band: of Hooke's law.
        longest: largest length [m].

    Returns:
        From the thinnest wire to the thickest; empty if no wire can do it.
    """
    return tuple(
        one
        for one in (_of_wire(wire, band, longest) for wire in WIRES)
        if one is not None and one.stress <= one.allowed
    )


def hopper_springs(cells: tuple[Cell, ...]) -> tuple[WireSpring, ...]:
    """Springs for the most stretched band of cells that have bands of one kind."""
    reach = [(b.lengths(c.lever, c.limit)[1], b) for c in cells for b in c.bands]
    longest, band = max(reach, key=lambda one: one[1].stiffness * (one[0] - one[1].rest_length))
    return wire_springs(band, longest)


def _of_wire(wire: float, band: Band, longest: float) -> WireSpring | None:
    """The largest coil, and so the least stress, that fits; None if none does."""
    fits = [one for one in _coils(wire, band, longest) if one.body_length <= band.rest_length]
    return min(fits, key=lambda one: one.stress, default=None)


def _coils(wire: float, band: Band, longest: float) -> Iterator[WireSpring]:
    strength = from_unit(2220.0 - 820.0 * math.log10(to_unit(wire, "mm")), "MPa")
    load, low, high = float(band.tension(longest)), *RATIOS
    for step in range(math.ceil(low * wire / _STEP), math.floor(high * wire / _STEP) + 1):
        coil = _STEP * step
        index = coil / wire
        coils = SHEAR * wire**4 / (8.0 * coil**3 * band.stiffness)
        if coils < 3.0:
            continue
        curved = (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index
        length = (coils + 1.0) * wire + 2.0 * LOOP * (coil - wire)
        yield WireSpring(
            wire,
            coil,
            coils,
            band.stiffness,
            length,
            load,
            stress=curved * 8.0 * load * coil / (math.pi * wire**3),
            allowed=ALLOWED * strength,
            mass=DENSITY * math.pi / 4.0 * wire**2 * math.pi * coil * (coils + 2.0),
        )
