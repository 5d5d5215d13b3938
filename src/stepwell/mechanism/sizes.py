"""Detection of unit errors: sizes so unlikely that another unit was probably meant.

A unit error is a factor of a thousand (mm for m, N/mm for N/m, mN for N), or of 57 (rad for deg).
The ranges below are the widest that still detect one in ordinary mechanisms.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell.base import InputError, Measure, to_unit
from stepwell.mechanism.band import Cubic, Table
from stepwell.mechanism.element import Element

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from stepwell.mechanism.band import Band
    from stepwell.mechanism.cell import Cell
    from stepwell.mechanism.chain import Chain

LEVERS = 1e-4, 2.0  # [m]
LENGTHS = 1 / 200, 50.0  # any length over the lever
SPRINGS = 0.05, 2e4  # k of a band [N/m]
FORCES = 50.0  # largest load and friction, over the cell's own force
TRAVELS = 1.0  # of an element [m]
PULLS = 1e4  # of an element [N]
LEAST_LIMIT = math.radians(2.0)  # θc [rad]
STEP = 1000.0  # between two units that are taken for each other

Size = float | tuple[float, ...]


class Slip(NamedTuple):
    """An unlikely size and the probable value, both in SI, with the comparison in `why`.

    Attributes:
        name: the field that holds it; "tension" is the largest of a table, "extension" its last.
        meant: probable value; None if no unit error explains the size.
        band: number of the band in the cell, from 0; None for other fields.
    """

    name: str
    value: Size
    meant: Size | None
    unit: str
    why: str
    band: int | None = None

    def __str__(self):
        probably = f" Did you mean {_shown(self.meant)} {self.unit}?" if self.meant else ""
        if isinstance(self.meant, float) and self.unit == "rad":
            turned = math.degrees(self.meant)
            probably = f" Did you mean {_shown(self.meant)} rad ({turned:.4g}°)?"
        return f"{self.name} = {_shown(self.value)} {self.unit}: {self.why}.{probably}"


class SlipError(InputError):
    """Error for sizes that look like unit errors, with the way to accept them."""

    def __init__(self, slips: tuple[Slip, ...], way: str):
        self.slips, self.way = slips, way
        super().__init__("\n".join([*map(str, slips[:-1]), f"{slips[-1]} {way}".rstrip()]))


def meant(value: Size, low: float, high: float) -> Size | None:
    """`value`, or the vector, a thousand times larger or smaller, if low <= its size <= high."""
    size = _size(value)
    for grown in (STEP, 1 / STEP):
        if low <= size * grown <= high * (1 + 1e-9):
            return _scaled(value, grown)
    return None


def length(name: str, value: Size, lever: float, band: int | None = None) -> Iterator[Slip]:
    """The slip of a length [m], or of a vector; zero is no slip."""
    low, high = LENGTHS[0] * lever, LENGTHS[1] * lever
    size = _size(value)
    if size and not low <= size <= high:
        why = f"is {_ratio(size / lever)} a lever of {to_unit(lever, 'mm'):.4g} mm"
        yield Slip(name, value, meant(value, low, high), "m", why, band)


def far(name: str, value: Size, lever: float) -> Iterator[Slip]:
    """The slip of a length that may be small: of a grid, a search, a displacement."""
    if _size(value) > lever:
        yield from length(name, value, lever)


def above(name: str, value: float, most: float) -> Iterator[Slip]:
    """The slip of a tolerance or a reach [m] that is above a length of the mechanism."""
    if value > most:
        why = f"is above {to_unit(most, 'mm'):.4g} mm"
        yield Slip(name, value, meant(value, 0.0, most), "m", why)


def lever_of(name: str, lever: float) -> Iterator[Slip]:
    """The slip of a lever [m]."""
    low, high = LEVERS
    if not low <= lever <= high:
        why = f"levers are from {to_unit(low, 'mm'):g} mm to {high:g} m long"
        yield Slip(name, lever, meant(lever, low, high), "m", why)


def spring(name: str, stiffness: float, band: int | None = None) -> Iterator[Slip]:
    """The slip of the stiffness of a band [N/m]."""
    low, high = SPRINGS
    if not low <= stiffness <= high:
        why = f"bands have from {low:g} to {high:g} N/m"
        yield Slip(name, stiffness, meant(stiffness, low, high), "N/m", why, band)


def force(name: str, value: float, own: float) -> Iterator[Slip]:
    """The slip of a force [N] compared with the forces of the bands."""
    if abs(value) > FORCES * own:
        why = f"is {_ratio(abs(value) / own)} what the bands pull with, about {own:.3g} N"
        yield Slip(name, value, meant(value, 0.0, FORCES * own), "N", why)


def of_element(element: Element) -> Iterator[Slip]:
    """Slips of the travel [m] and the largest force [N] of an element's curve, scales aside."""
    if element.measure is not Measure.TRAVEL:
        return
    travel = element.full_travel / element.travel_scale
    pull = element.largest_force / element.force_scale
    if travel > TRAVELS * (1 + 1e-9):
        why = f"is the length of the curve, and elements move by up to {TRAVELS:g} m"
        yield Slip("travel", travel, meant(travel, 0.0, TRAVELS), "m", why)
    if pull > PULLS * (1 + 1e-9):
        why = f"is the largest of the curve, and elements have up to {PULLS:g} N"
        yield Slip("force", pull, meant(pull, 0.0, PULLS), "N", why)


def own_force(cell: Cell, lever: float) -> float:
    """Approximate force of the bands of a cell [N] on levers of that length: Σ k r."""
    return sum(band.stiffness for band in cell.bands) * lever


def slips(cell: Cell) -> tuple[Slip, ...]:
    """All sizes of a cell that look like unit errors."""
    return tuple(_slips(cell))


def drives(chain: Chain, turning_points: ArrayLike) -> tuple[Slip, ...]:
    """Slips of actuator positions [m], or forces [N], that are probably in another unit."""
    if chain.measure is not Measure.TRAVEL:
        return ()
    points = np.ravel(np.asarray(turning_points, float))
    most, unit = chain.full_stroke, "m"
    if np.max(np.abs(points), initial=0.0) > most:
        # A soft open end continues far past its curve.
        most = max(most, *map(abs, chain.stroke_range))
    # A little out of a rigid actuator's reach is no slip, and refused where the chain is followed.
    noticed = 10 * most
    if not math.isinf(chain.actuator_stiffness):
        if chain.unusual:
            return ()
        own = max(_pull(cell) for cell in chain.cells)
        most = most + own / chain.actuator_stiffness if chain.actuator_stiffness else own
        noticed, unit = FORCES * most, "m" if chain.actuator_stiffness else "N"
    why = f"is far past what moves the whole chain, about {most:.4g} {unit}"
    return tuple(
        Slip(f"turning_points[{i}]", drive, likely, unit, why)
        for i, drive in enumerate(points.tolist())
        if abs(drive) > noticed and (likely := meant(drive, 0.0, 10 * most)) is not None
    )


def _pull(cell: Cell | Element) -> float:
    """Approximate force of a cell [N]."""
    if isinstance(cell, Element):
        return cell.largest_force
    return max(own_force(cell, cell.lever), abs(cell.force_0), abs(cell.force_1))


def _slips(cell: Cell) -> Iterator[Slip]:
    lever = cell.lever
    for slip in lever_of("lever", lever):
        yield slip
        # One slip is reported once: the rest is compared with the probable lever.
        lever = slip.meant if isinstance(slip.meant, float) else lever
    if cell.limit < LEAST_LIMIT:
        turned = math.degrees(cell.limit)
        why = f"is {turned:.4g}°, and cells turn by 2° or more to either side"
        likely = LEAST_LIMIT <= turned <= math.pi / 2
        yield Slip("limit", cell.limit, turned if likely else None, "rad", why)
    soft = False
    for index, band in enumerate(cell.bands):
        for slip in _of_band(band, lever, index):
            soft = soft or slip.name in ("stiffness", "tension")
            yield slip
    if not soft:
        yield from force("friction", cell.friction, own_force(cell, lever))
    if cell.load is not None:
        if len(cell.load.travel) > 1:  # The travel of a constant load has no effect.
            farthest = max(cell.load.travel, key=abs)
            yield from length("load.travel", farthest, lever)
        if not soft:
            largest = max(cell.load.force, key=abs)
            yield from force("load.force", largest, own_force(cell, lever))


def _of_band(band: Band, lever: float, index: int) -> Iterator[Slip]:
    yield from _of_anchors(band, lever, index)
    yield from length("rest_length", band.rest_length, lever, index)
    if isinstance(band.law, Table):
        yield from _of_table(band, band.law, lever, index)
    else:
        yield from spring("stiffness", band.stiffness, index)
    if isinstance(band.law, Cubic):
        bends = (("a2", band.law.a2, "1/m", 1), ("a3", band.law.a3, "1/m²", 2))
        for name, value, unit, power in bends:
            most = (LENGTHS[1] / lever) ** power
            if abs(value) > most:
                likely = value / STEP**power
                why = f"bends a band far within a lever of {to_unit(lever, 'mm'):.4g} mm"
                yield Slip(name, value, likely if abs(likely) <= most else None, unit, why, index)


def _of_anchors(band: Band, lever: float, index: int) -> Iterator[Slip]:
    """Slips of p and q: a motion depends on d = q - p, so one of both may be small or zero."""
    odd = {name: [*length(name, getattr(band, name), lever)] for name in ("p", "q")}
    if any(length("d", band.d, lever)) or all(odd.values()):
        yield from (slip._replace(band=index) for slips in odd.values() for slip in slips)


def _of_table(band: Band, law: Table, lever: float, index: int) -> Iterator[Slip]:
    stretched = list(length("extension", law.extension[-1], lever, index))
    yield from stretched
    most = max(range(len(law.shape)), key=law.shape.__getitem__)
    far, pull = law.extension[most], band.stiffness * law.shape[most]
    if pull and not stretched:  # with extensions in another unit, the stiffness is meaningless
        for slip in spring("tension", pull / far, index):
            likely = None if slip.meant is None else pull * _size(slip.meant) / (pull / far)
            why = f"at {to_unit(far, 'mm'):.4g} mm it makes {pull / far:.3g} N/m, and {slip.why}"
            yield slip._replace(value=pull, meant=likely, unit="N", why=why)


def _size(value: Size) -> float:
    return math.hypot(*value) if isinstance(value, tuple) else abs(value)


def _scaled(value: Size, grown: float) -> Size:
    if isinstance(value, tuple):
        return tuple(_grown(part, grown) for part in value)
    return _grown(value, grown)


def _grown(value: float, grown: float) -> float:
    # Divided where it shrinks: 40 / 1000 is 0.04, and 40 times 0.001 is its neighbour.
    return value * grown if grown > 1 else value / (1 / grown)


def _shown(value: Size) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(f'{part:.6g}' for part in value)})"
    return f"{value:.6g}"


def _ratio(ratio: float) -> str:
    return f"{ratio:.0f} times" if ratio >= 1 else f"{ratio:.2g} of"
