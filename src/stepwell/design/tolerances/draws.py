"""Manufacturing tolerances of a nominal design, and random samples within them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from stepwell import base, concave
from stepwell.design.parameters import WAY
from stepwell.design.switches import switching_forces
from stepwell.mechanism import MOBILITIES, Band, Cell, Chain, Element, SlipError, geometry, sizes
from stepwell.statics import Designs, batch, nominal

_UNITS = {
    "anchor": "m",
    "stiffness": "1",
    "rest_length": "1",
    "lever": "m",
    "friction": "N",
    "travel": "1",
}
EachCell = float | tuple[float, ...]
"""A number for all cells, or one per cell, inner cell first."""


class CellTolerances(NamedTuple):
    """Tolerances of one cell, as for `Tolerances`: anchor and lever [m], friction [N], rest [1]."""

    anchor: float = 0.0
    stiffness: float = 0.0
    rest_length: float = 0.0
    lever: float = 0.0
    friction: float = 0.0
    travel: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Tolerances(base.ByValue):
    """Tolerances of the parts of a mechanism, all independent.

    Each is one number for all cells, or one per cell, inner cell first; `mobility` is one number.
    An element has `stiffness`, `friction` and `travel`. Its `error_band` is not a tolerance: it is
    the uncertainty of one measured curve, not the variation between copies.

    Args:
        anchor: radius of a uniform distribution of every anchor p and q over a disc [m].
        stiffness: relative standard deviation of each band's k, normal, cut at four; for an
            element, of one factor of all its forces [1].
        rest_length: the same for ℓ0 [1].
        lever: half-width of a uniform distribution of every cell's lever [m].
        friction: largest added friction of every cell, uniform from 0 [N].
        travel: relative standard deviation of all travels of an element, normal, cut at four [1].
        mobility: largest ratio of the mobilities of two nominally equal cells, log-uniform; 1 for
            the nominal mobilities [1].

    Raises:
        ValueError: a value that is negative or not finite, a standard deviation of a quarter or
            more, which would allow bands without stiffness, a `mobility` below 1, or different
            numbers of cells.
    """

    anchor: EachCell = 0.0
    stiffness: EachCell = 0.0
    rest_length: EachCell = 0.0
    lever: EachCell = 0.0
    friction: EachCell = 0.0
    travel: EachCell = 0.0
    mobility: float = 1.0

    def __post_init__(self):
        for name, unit in _UNITS.items():
            object.__setattr__(self, name, _checked(name, unit, getattr(self, name)))
        if np.ndim(self.mobility):
            raise base.InputError(
                f"mobility = {self.mobility!r}: must be one number, the ratio of any two cells."
            )
        object.__setattr__(self, "mobility", float(self.mobility))
        if not 1.0 <= self.mobility < math.inf:
            raise base.InputError(f"mobility = {self.mobility} [a ratio]: must be >= 1 and finite.")
        given = {name: len(value) for name, value in self._by_cell.items()}
        if len({*given.values()}) > 1:
            shown = ", ".join(f"{count} of {name}" for name, count in given.items())
            raise base.InputError(f"tolerances by cell: {shown}: must be one for each cell.")

    @property
    def _by_cell(self) -> dict[str, tuple[float, ...]]:
        fields = {name: getattr(self, name) for name in _UNITS}
        return {name: value for name, value in fields.items() if isinstance(value, tuple)}

    @property
    def cells(self) -> int:
        """Number of cells with values of their own; 0 if every value holds for all cells."""
        return max(map(len, self._by_cell.values()), default=0)

    @property
    def most(self) -> CellTolerances:
        """The largest tolerance of each kind."""
        return CellTolerances(*(np.max(getattr(self, name)).item() for name in _UNITS))

    def each(self, cells: int) -> tuple[CellTolerances, ...]:
        """The tolerances of every cell; InputError if given for another number of cells."""
        for name, value in self._by_cell.items():
            if len(value) != cells:
                raise base.InputError(
                    f"{name} has {len(value)} tolerances for {cells} cells: must be one for all, "
                    f"or one for each, inner cell first."
                )
        columns = [np.broadcast_to(getattr(self, name), cells).tolist() for name in _UNITS]
        return tuple(CellTolerances(*row) for row in zip(*columns, strict=True))

    def of_cells(self, cells: slice) -> "Tolerances":
        """Those of some cells of a chain."""
        changed: dict[str, Any] = {name: value[cells] for name, value in self._by_cell.items()}
        return replace(self, **changed)

    def scaled(self, factor: float, *names: str, most: float = math.inf) -> "Tolerances":
        """The same with some of them multiplied by a factor, up to `most`."""
        changed: dict[str, Any] = {
            name: np.minimum(np.multiply(factor, getattr(self, name)), most).tolist()
            for name in names
        }
        return replace(self, **changed)

    def __str__(self):
        values = [
            _shown("anchors ±", self.anchor, "mm"),
            _shown("stiffness ±", self.stiffness, "%"),
            _shown("rest length ±", self.rest_length, "%"),
            _shown("levers ±", self.lever, "mm"),
            _shown("friction up to ", self.friction, "N"),
            _shown("travel ±", self.travel, "%"),
            f"mobility ratio up to {self.mobility:.4g}" * (self.mobility > 1),
        ]
        return ", ".join(filter(None, values)) or "no tolerance"

    def __repr__(self):
        most = self.most
        travel = f", travel {_number(self.travel)}" if most.travel else ""
        if self.mobility > 1:
            travel += f", mobility ratios up to {self.mobility:.4g}"
        return (
            f"Tolerances(anchors ±{_number(self.anchor, 'mm')} mm, stiffness "
            f"{_number(self.stiffness)}, rest length {_number(self.rest_length)}, levers "
            f"±{_number(self.lever, 'mm')} mm, friction +{_number(self.friction)} N{travel})"
        )


def _checked(name: str, unit: str, given: Any) -> EachCell:
    """A tolerance, or one per cell; InputError for a value that is not allowed."""
    values = tuple(given) if np.ndim(given) else (given,)
    if not values:
        raise base.InputError(f"{name} = {given!r}: must be one number, or one per cell.")
    numbers: list[float] = []
    for number, value in enumerate(values, 1):
        what = f"{name} of cell {number}" if np.ndim(given) else name
        try:
            value = float(value)
        except (TypeError, ValueError):
            raise base.InputError(
                f"{what} = {value!r}: must be one number, or one per cell."
            ) from None
        if not 0.0 <= value < math.inf:
            raise base.InputError(f"{what} = {value} [{unit}]: must be >= 0 and finite.")
        if unit == "1" and value >= 0.25:
            raise base.InputError(
                f"{what} = {value}: must be < 0.25; it is a fraction, so 5 % is 0.05."
            )
        numbers.append(value)
    return tuple(numbers) if np.ndim(given) else numbers[0]


_SIGNS = {"mm": ("mm", 4), "%": ("percent", 3), "N": ("N", 3), "": ("1", 3)}


def _number(value: EachCell, sign: str = "") -> str:
    """A tolerance, or those of all cells, in a unit."""
    unit, digits = _SIGNS[sign]
    each = value if isinstance(value, tuple) else (value,)
    return " / ".join(f"{base.to_unit(one, unit):.{digits}g}" for one in each)


def _shown(head: str, value: EachCell, sign: str) -> str:
    return f"{head}{_number(value, sign)} {sign}" * bool(np.any(value))


DEFAULT_TOLERANCES = Tolerances(anchor=base.USUAL_ANCHOR, stiffness=base.USUAL_STIFFNESS)
"""Tolerances of careful workshop practice with rubber bands."""


def refuse_slips(tolerances: Tolerances, travel: float, force: float, way: str = WAY) -> None:
    """Raise SlipError for tolerances above the travel [m] or friction far above the force [N]."""
    most = tolerances.most
    slips = (
        *sizes.above("anchor", most.anchor, travel),
        *sizes.above("lever", most.lever, travel),
        *sizes.force("friction", most.friction, force),
    )
    if slips:
        raise SlipError(slips, way)


def validate(tolerances: Tolerances, chain: Chain) -> None:
    """Raise InputError for tolerances impossible for this chain, SlipError for unit errors."""
    tolerances.each(len(chain))
    (least, most), wide = MOBILITIES, math.sqrt(tolerances.mobility)
    for name, cell in zip(chain.names, chain.cells, strict=True):
        room = min(cell.mobility / least, most / cell.mobility)
        if wide > room:
            raise base.InputError(
                f"mobility = {tolerances.mobility:g}: the mobility of {name}, {cell.mobility:g}, "
                f"must stay between {least:g} and {most:g}: use at most {room**2:.4g}."
            )
    cells = levers_of(chain)
    if cells and not chain.unusual:
        travel = max(cell.full_travel for cell in cells)
        refuse_slips(tolerances, travel, max(sizes.own_force(c, c.lever) for c in cells))


def refuse_reach(chain: Chain, reach: float) -> None:
    """Raise SlipError for a displacement [m] far beyond the levers, except the default."""
    lever = max((cell.lever for cell in levers_of(chain)), default=math.inf)
    slips = tuple(sizes.far("reach", reach, lever)) if reach > base.REACH else ()
    if slips and not chain.unusual:
        raise SlipError(slips, WAY)


def levers_of(chain: Chain) -> list[Cell]:
    """The cells of a chain that have levers and bands."""
    return [cell for cell in chain.cells if isinstance(cell, Cell)]


def frictionless(tolerances: Tolerances, chain: Chain) -> str:
    """Note on samples without friction; "" with friction."""
    if tolerances.most.friction or any(cell.friction for cell in chain.cells):
        return ""
    least = float(np.min(np.abs(switching_forces(chain)), initial=math.inf))
    if chain.elements:
        unit, factor = base.display_unit(chain.measure.force_unit)
        smallest = f"switching {chain.measure.force} {least * factor:.3g} {unit}"
    else:
        smallest = f"critical force {base.to_unit(least, 'mN'):.3g} mN"
    return f"no friction (smallest {smallest}: set friction if yours is comparable)"


_CUT = 4.0  # standard deviations at which the normal distribution ends
_AT_ONCE = 2**18  # numbers in a chunk, which fits into the processor's cache


class SampledPart(NamedTuple):
    """An independent parameter: its cell, its tolerance, and the columns of its numbers."""

    cell: int  # 0 the innermost
    what: str  # "d" (all anchors of its bands), or a parameter of a cell or an element
    tolerance: str  # the field of `Tolerances`
    columns: list[int]  # of the draws


@dataclass(frozen=True, eq=False)
class Draws(base.ByValue):
    """Random samples of a nominal design, the same ones for the same seed.

    The tolerance of the part `known`, if any, is reduced to the fraction `left`.
    """

    chain: Chain
    tolerances: Tolerances
    seed: int
    known: str = ""
    left: float = 1.0

    @property
    def parts(self) -> dict[str, SampledPart]:
        """Every part that has a tolerance, by its name, such as "outer.d"."""
        b, n = self.bands, len(self.chain)
        parts: dict[str, SampledPart] = {}
        names, first, scale = self.chain.names, 0, self.scales
        for i, cell in enumerate(self.chain.cells):
            name = names[i] if names.count(names[i]) == 1 else i + 1
            if isinstance(cell, Element):
                own = ("force_scale", "stiffness", [scale]), ("travel_scale", "travel", [scale + 1])
                scale += 2
            else:
                bands = range(first, first + len(cell.bands))
                first = bands.stop
                own = (
                    ("d", "anchor", [4 * band + k for band in bands for k in range(4)]),
                    ("stiffness", "stiffness", [4 * b + band for band in bands]),
                    ("rest_length", "rest_length", [5 * b + band for band in bands]),
                    ("lever", "lever", [6 * b + i]),
                )
            for what, tolerance, columns in (*own, ("friction", "friction", [6 * b + n + i])):
                if getattr(self.each[i], tolerance) > 0:
                    parts[f"{name}.{what}"] = SampledPart(i, what, tolerance, columns)
        return parts

    @property
    def bands(self) -> int:
        """B, the number of bands of all cells."""
        return sum(len(cell.bands) for cell in levers_of(self.chain))

    @property
    def columns(self) -> int:
        """Number of random numbers of one sample."""
        return self.mobilities + len(self.chain)

    @property
    def scales(self) -> int:
        """The first column of the elements: a factor of forces and one of travels for each."""
        return 6 * self.bands + 2 * len(self.chain)

    @property
    def mobilities(self) -> int:
        """The first column of the mobilities, one per cell."""
        return self.scales + 2 * len(self.chain.elements)

    @cached_property
    def each(self) -> tuple[CellTolerances, ...]:
        """The tolerances of every cell."""
        return self.tolerances.each(len(self.chain))

    @cached_property
    def spread(self) -> base.Floats:
        """(N, 6) tolerances of every cell, the fields of `CellTolerances`."""
        return np.array(self.each)

    def chunks(self, n: int) -> Iterator[base.Floats]:
        """The first n samples in pieces (m, columns), each overwriting the one before."""
        rows = max(64, min(n, _AT_ONCE // self.columns))
        space, streams = np.empty((rows, self.columns)), self._streams(0)
        for first in range(0, n, rows):
            yield self._filled(space[: min(rows, n - first)], streams)

    def _streams(self, number: int) -> list[np.random.Generator]:
        streams: list[np.random.Generator] = []
        for seed, columns in (self.seed, self.mobilities), ((self.seed, 1), len(self.chain)):
            stream = np.random.PCG64(seed)
            stream.advance(number * columns)
            streams.append(np.random.Generator(stream))
        return streams

    def _filled(self, rows: base.Floats, streams: list[np.random.Generator]) -> base.Floats:
        # Row by row from one stream: the first samples do not depend on the number or the pieces.
        halves = np.hsplit(rows, [self.mobilities])
        for columns, random in zip(halves, streams, strict=True):
            columns[:] = random.random(columns.shape)
        return self.shaped(rows)

    def shaped(self, even: base.Floats) -> base.Floats:
        """Uniform numbers in 0..1 converted to draws in place: normal for k, ℓ0 and elements."""
        from scipy.special import ndtr, ndtri

        most, tail = self.tolerances.most, ndtr(-_CUT)
        if most.stiffness > 0 or most.rest_length > 0 or most.travel > 0:
            bands, elements = (4 * self.bands, 6 * self.bands), (self.scales, self.mobilities)
            for first, last in (bands, elements):
                normal = even[:, first:last]
                normal[:] = ndtri(tail + (1.0 - 2.0 * tail) * normal)
        if self.known:
            self._narrow(even)
        return even

    def _narrow(self, drawn: base.Floats) -> None:
        _, _, tolerance, columns = self.parts[self.known]
        if tolerance == "anchor":
            # The first of two numbers is an area.
            drawn[:, columns[::2]] *= self.left**2
        elif tolerance in ("lever", "friction"):
            drawn[:, columns] = 0.5 + self.left * (drawn[:, columns] - 0.5)
        else:
            drawn[:, columns] *= self.left

    def switching_forces(self, drawn: base.Floats) -> base.Floats:
        """(m, T, 2) as `switches.switching_forces`, for (m, columns) draws of elements."""
        n, spread = len(self.chain), CellTolerances(*self.spread.T)
        steps = np.array([len(phases) - 1 for phases in self.chain.phases])
        rub = np.array([cell.friction for cell in self.chain.cells])
        forces = switching_forces(self.chain) - np.repeat(rub, steps)[:, None] * [1.0, -1.0]
        scale = 1.0 + spread.stiffness * drawn[:, self.scales : self.mobilities : 2]
        rub = rub + spread.friction * drawn[:, self.scales - n : self.scales]
        scale, rub = (np.repeat(part, steps, axis=1)[:, :, None] for part in (scale, rub))
        return scale * forces + rub * [1.0, -1.0]

    def sample(self, number: int) -> Chain:
        """Sample `number`, from 0, as in `chunks`; ValueError if it cannot be built."""
        return self.built(self._filled(np.empty((1, self.columns)), self._streams(number))[0])

    def designs(self, drawn: base.Floats) -> Designs | None:
        """Samples of (m, columns) draws as numbers, equal to those `built` one by one.

        None for elements, whose curves have to be built, and for long chains.
        """
        b, n = self.bands, len(self.chain)
        designs = None if self.chain.elements else nominal(self.chain, len(drawn))
        if designs is None:
            return None
        where = np.empty((len(drawn), 2 * b, 2))
        t: Any = CellTolerances(*self.spread.T)
        owner = np.repeat(np.arange(n), [len(cell.bands) for cell in levers_of(self.chain)])
        radii = np.repeat(t.anchor[owner], 2)
        concave.in_discs(radii, np.ascontiguousarray(drawn[:, : 4 * b]), where)
        drawing = [band for cell in levers_of(self.chain) for band in cell.bands]
        p, q = (np.array([getattr(band, end) for band in drawing]) for end in "pq")
        bands, cells = designs.bands, designs.cells
        bands[:, :, :2] = (q + where[:, 1::2]) - (p + where[:, ::2])
        bands[:, :, 2] *= 1.0 + t.stiffness[owner] * drawn[:, 4 * b : 5 * b]
        bands[:, :, 3] *= 1.0 + t.rest_length[owner] * drawn[:, 5 * b : 6 * b]
        lever, rub = np.split(drawn[:, 6 * b : 6 * b + 2 * n], 2, axis=1)
        cells[:, :, batch.LEVER] += t.lever * (2.0 * lever - 1.0)
        sine = cells[:, :, batch.SIN_LIMIT]
        cells[:, :, batch.FULL] = geometry.travel_of(sine, cells[:, :, batch.LEVER], sine)
        cells[:, :, batch.FRICTION] += t.friction * rub
        faster = self.tolerances.mobility ** (drawn[:, self.mobilities :] - 0.5)
        cells[:, :, batch.MOBILITY] *= faster
        return designs

    def built(self, draw: base.Floats) -> Chain:
        """The sample of one row of draws; ValueError if it cannot be built."""
        b, n = self.bands, len(self.chain)
        stiffness, rest = draw[4 * b : 5 * b], draw[5 * b : 6 * b]
        lever, friction = draw[6 * b : 6 * b + n], draw[6 * b + n :]
        scales = iter(draw[self.scales : self.mobilities].reshape(-1, 2).tolist())
        # Log-uniform, symmetric about the nominal value.
        faster = self.tolerances.mobility ** (draw[self.mobilities :] - 0.5)

        def sampled_band(number: int, band: Band, t: CellTolerances) -> Band:
            where = draw[4 * number : 4 * number + 4].tolist()
            (px, py), (qx, qy) = (concave.in_disc(t.anchor, *one) for one in (where[:2], where[2:]))
            return replace(
                band,
                p=(band.p[0] + px, band.p[1] + py),
                q=(band.q[0] + qx, band.q[1] + qy),
                stiffness=band.stiffness * (1.0 + t.stiffness * stiffness[number]),
                rest_length=band.rest_length * (1.0 + t.rest_length * rest[number]),
            )

        cells: list[Cell | Element] = []
        first = 0
        for i, (cell, t) in enumerate(zip(self.chain.cells, self.each, strict=True)):
            rub, mobility = cell.friction + t.friction * friction[i], cell.mobility * faster[i]
            if isinstance(cell, Element):
                force, travel = next(scales)
                changed = {
                    "force_scale": cell.force_scale * (1.0 + t.stiffness * force),
                    "travel_scale": cell.travel_scale * (1.0 + t.travel * travel),
                }
            else:
                bands = tuple(sampled_band(first + j, band, t) for j, band in enumerate(cell.bands))
                first += len(bands)
                longer = cell.lever + t.lever * (2.0 * lever[i] - 1.0)
                changed = {"band": bands, "lever": longer}
            cells.append(replace(cell, **changed, friction=rub, mobility=mobility))
        return replace(self.chain, cells=tuple(cells))
