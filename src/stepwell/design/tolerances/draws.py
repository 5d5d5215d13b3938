"""Manufacturing tolerances of a nominal design, and random samples within them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

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
    "mobility": "a ratio",
}


@dataclass(frozen=True, slots=True, eq=False)
class Tolerances(base.ByValue):
    """Tolerances of the parts of a mechanism, all independent.

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
            more, which would allow bands without stiffness, or a `mobility` below 1.
    """

    anchor: float = 0.0
    stiffness: float = 0.0
    rest_length: float = 0.0
    lever: float = 0.0
    friction: float = 0.0
    travel: float = 0.0
    mobility: float = 1.0

    def __post_init__(self):
        for name, unit in _UNITS.items():
            value, low = float(getattr(self, name)), float(name == "mobility")
            if not low <= value < math.inf:
                raise base.InputError(f"{name} = {value} [{unit}]: must be >= {low:g} and finite.")
            if unit == "1" and value >= 0.25:
                raise base.InputError(
                    f"{name} = {value}: must be < 0.25; it is a fraction, so 5 % is 0.05."
                )
            object.__setattr__(self, name, value)

    def __str__(self):
        values = [
            f"anchors ±{base.to_unit(self.anchor, 'mm'):.4g} mm" * (self.anchor > 0),
            f"stiffness ±{100 * self.stiffness:.3g} %" * (self.stiffness > 0),
            f"rest length ±{100 * self.rest_length:.3g} %" * (self.rest_length > 0),
            f"levers ±{base.to_unit(self.lever, 'mm'):.4g} mm" * (self.lever > 0),
            f"friction up to {self.friction:.3g} N" * (self.friction > 0),
            f"travel ±{100 * self.travel:.3g} %" * (self.travel > 0),
            f"mobility ratio up to {self.mobility:.4g}" * (self.mobility > 1),
        ]
        return ", ".join(filter(None, values)) or "no tolerance"

    def __repr__(self):
        travel = f", travel {self.travel:.3g}" if self.travel else ""
        if self.mobility > 1:
            travel += f", mobility ratios up to {self.mobility:.4g}"
        return (
            f"Tolerances(anchors ±{base.to_unit(self.anchor, 'mm'):.4g} mm, stiffness "
            f"{self.stiffness:.3g}, rest length {self.rest_length:.3g}, levers "
            f"±{base.to_unit(self.lever, 'mm'):.4g} mm, friction +{self.friction:.3g} N{travel})"
        )


DEFAULT_TOLERANCES = Tolerances(anchor=base.USUAL_ANCHOR, stiffness=base.USUAL_STIFFNESS)
"""Tolerances of careful workshop practice with rubber bands."""


def refuse_slips(tolerances: Tolerances, travel: float, force: float, way: str = WAY) -> None:
    """Raise SlipError for tolerances above the travel [m] or friction far above the force [N]."""
    slips = (
        *sizes.above("anchor", tolerances.anchor, travel),
        *sizes.above("lever", tolerances.lever, travel),
        *sizes.force("friction", tolerances.friction, force),
    )
    if slips:
        raise SlipError(slips, way)


def validate(tolerances: Tolerances, chain: Chain) -> None:
    """Raise InputError for tolerances impossible for this chain, SlipError for unit errors."""
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
    if tolerances.friction or any(cell.friction for cell in chain.cells):
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


@dataclass(frozen=True, slots=True, eq=False)
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
        b, n, t = self.bands, len(self.chain), self.tolerances
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
                if getattr(t, tolerance) > 0:
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

    @property
    def spread(self) -> base.Floats:
        """(5,) the tolerances as the kernels take them."""
        t = self.tolerances
        return np.array([t.anchor, t.stiffness, t.rest_length, t.lever, t.friction])

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

        t, tail = self.tolerances, ndtr(-_CUT)
        if t.stiffness > 0 or t.rest_length > 0 or t.travel > 0:
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
        t, n = self.tolerances, len(self.chain)
        steps = np.array([len(phases) - 1 for phases in self.chain.phases])
        rub = np.array([cell.friction for cell in self.chain.cells])
        forces = switching_forces(self.chain) - np.repeat(rub, steps)[:, None] * [1.0, -1.0]
        scale = 1.0 + t.stiffness * drawn[:, self.scales : self.mobilities : 2]
        rub = rub + t.friction * drawn[:, self.scales - n : self.scales]
        scale, rub = (np.repeat(part, steps, axis=1)[:, :, None] for part in (scale, rub))
        return scale * forces + rub * [1.0, -1.0]

    def sample(self, number: int) -> Chain:
        """Sample `number`, from 0, as in `chunks`; ValueError if it cannot be built."""
        return self.built(self._filled(np.empty((1, self.columns)), self._streams(number))[0])

    def designs(self, drawn: base.Floats) -> Designs | None:
        """Samples of (m, columns) draws as numbers, equal to those `built` one by one.

        None for elements, whose curves have to be built, and for long chains.
        """
        t, b, n = self.tolerances, self.bands, len(self.chain)
        designs = None if self.chain.elements else nominal(self.chain, len(drawn))
        if designs is None:
            return None
        where = np.empty((len(drawn), 2 * b, 2))
        concave.in_discs(t.anchor, np.ascontiguousarray(drawn[:, : 4 * b]), where)
        drawing = [band for cell in levers_of(self.chain) for band in cell.bands]
        p, q = (np.array([getattr(band, end) for band in drawing]) for end in "pq")
        bands, cells = designs.bands, designs.cells
        bands[:, :, :2] = (q + where[:, 1::2]) - (p + where[:, ::2])
        bands[:, :, 2] *= 1.0 + t.stiffness * drawn[:, 4 * b : 5 * b]
        bands[:, :, 3] *= 1.0 + t.rest_length * drawn[:, 5 * b : 6 * b]
        lever, rub = np.split(drawn[:, 6 * b : 6 * b + 2 * n], 2, axis=1)
        cells[:, :, batch.LEVER] += t.lever * (2.0 * lever - 1.0)
        sine = cells[:, :, batch.SIN_LIMIT]
        cells[:, :, batch.FULL] = geometry.travel_of(sine, cells[:, :, batch.LEVER], sine)
        cells[:, :, batch.FRICTION] += t.friction * rub
        cells[:, :, batch.MOBILITY] *= t.mobility ** (drawn[:, self.mobilities :] - 0.5)
        return designs

    def built(self, draw: base.Floats) -> Chain:
        """The sample of one row of draws; ValueError if it cannot be built."""
        t, b, n = self.tolerances, self.bands, len(self.chain)
        stiffness, rest = draw[4 * b : 5 * b], draw[5 * b : 6 * b]
        lever, friction = draw[6 * b : 6 * b + n], draw[6 * b + n :]
        scales = iter(draw[self.scales : self.mobilities].reshape(-1, 2).tolist())
        # Log-uniform, symmetric about the nominal value.
        faster = t.mobility ** (draw[self.mobilities :] - 0.5)

        def sampled_band(number: int, band: Band) -> Band:
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
        for i, cell in enumerate(self.chain.cells):
            rub, mobility = cell.friction + t.friction * friction[i], cell.mobility * faster[i]
            if isinstance(cell, Element):
                force, travel = next(scales)
                changed = {
                    "force_scale": cell.force_scale * (1.0 + t.stiffness * force),
                    "travel_scale": cell.travel_scale * (1.0 + t.travel * travel),
                }
            else:
                bands = tuple(sampled_band(first + j, band) for j, band in enumerate(cell.bands))
                first += len(bands)
                longer = cell.lever + t.lever * (2.0 * lever[i] - 1.0)
                changed = {"band": bands, "lever": longer}
            cells.append(replace(cell, **changed, friction=rub, mobility=mobility))
        return replace(self.chain, cells=tuple(cells))
