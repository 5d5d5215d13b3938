"""How far a built mechanism may be from its drawing, and mechanisms drawn at random within."""

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
        mobility: two cells drawn equally mobile are up to so many times apart: each is drawn evenly
            on a scale of logarithms; 1 leaves them as drawn [1].

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
        for name, unit in _UNITS.items():
            value, low = float(getattr(self, name)), float(name == "mobility")
            if not low <= value < math.inf:
                raise base.InputError(f"{name} = {value} [{unit}]: must be >= {low:g} and finite.")
            if unit == "1" and value >= 0.25:
                raise base.InputError(
                    f"{name} = {value}: must be < 0.25; it is a fraction, so 5 % is 0.05."
                )
            object.__setattr__(self, name, value)

    def __repr__(self):
        travel = f", travel {self.travel:.3g}" if self.travel else ""
        if self.mobility > 1:
            travel += f", mobilities up to {self.mobility:.4g} times apart"
        return (
            f"Tolerances(anchors ±{base.to_unit(self.anchor, 'mm'):.4g} mm, stiffness "
            f"{self.stiffness:.3g}, rest length {self.rest_length:.3g}, levers "
            f"±{base.to_unit(self.lever, 'mm'):.4g} mm, friction +{self.friction:.3g} N{travel})"
        )


USUAL = Tolerances(anchor=base.USUAL_ANCHOR, stiffness=base.USUAL_STIFFNESS)
"""What a careful workshop with a bag of rubber bands can do."""


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
    """Refuse tolerances that this chain cannot have, or that are probably in another unit."""
    (least, most), wide = MOBILITIES, math.sqrt(tolerances.mobility)
    for name, cell in zip(chain.names, chain.cells, strict=True):
        room = min(cell.mobility / least, most / cell.mobility)
        if wide > room:
            raise base.InputError(
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
    slips = tuple(sizes.far("reach", reach, lever)) if reach > base.REACH else ()
    if slips and not chain.unusual:
        raise SlipError(slips, WAY)


def levers_of(chain: Chain) -> list[Cell]:
    """Those of its cells that have levers and bands."""
    return [cell for cell in chain.cells if isinstance(cell, Cell)]


def frictionless(tolerances: Tolerances, chain: Chain) -> str:
    """What to know of mechanisms without friction; "" where there is some."""
    if tolerances.friction or any(cell.friction for cell in chain.cells):
        return ""
    least = float(np.min(np.abs(switching_forces(chain)), initial=math.inf))
    if chain.elements:
        unit, factor = base.display_unit(chain.measure.force_unit)
        beside = f"switching forces of {least * factor:.3g} {unit}"
    else:
        beside = f"forces F0 and F1 of {base.to_unit(least, 'mN'):.3g} mN"
    return (
        f"without any friction, beside {beside} and more: give "
        f"the cells or the tolerances some if yours has it"
    )


_CUT = 4.0  # standard deviations at which the normal distribution ends
_AT_ONCE = 2**18  # numbers in a chunk: they stay in the processor's cache


class Part(NamedTuple):
    """What varies by itself: its cell, its tolerance, and the columns of its numbers."""

    cell: int  # 0 the innermost
    what: str  # "d" (all anchors of its bands), or what else of a cell or an element
    tolerance: str  # the field of `Tolerances`
    columns: list[int]  # of the draws


@dataclass(frozen=True, slots=True, eq=False)
class Draws(base.ByValue):
    """Random mechanisms after one drawing, the same ones for the same seed.

    Of a part that is `known`, if any, only the share `left` of its tolerance is left.
    """

    chain: Chain
    tolerances: Tolerances
    seed: int
    known: str = ""
    left: float = 1.0

    @property
    def parts(self) -> dict[str, Part]:
        """Every part that has a tolerance, by its name, such as "outer.d"."""
        b, n, t = self.bands, len(self.chain), self.tolerances
        parts: dict[str, Part] = {}
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
                    parts[f"{name}.{what}"] = Part(i, what, tolerance, columns)
        return parts

    @property
    def bands(self) -> int:
        """B, of all cells."""
        return sum(len(cell.bands) for cell in levers_of(self.chain))

    @property
    def columns(self) -> int:
        """How many random numbers make one mechanism."""
        return self.mobilities + len(self.chain)

    @property
    def scales(self) -> int:
        """The first column of the elements: of each its forces and its travels."""
        return 6 * self.bands + 2 * len(self.chain)

    @property
    def mobilities(self) -> int:
        """The first column of the mobilities, one a cell."""
        return self.scales + 2 * len(self.chain.elements)

    @property
    def spread(self) -> base.Floats:
        """(5,) the tolerances as the kernels take them."""
        t = self.tolerances
        return np.array([t.anchor, t.stiffness, t.rest_length, t.lever, t.friction])

    def chunks(self, n: int) -> Iterator[base.Floats]:
        """The first n samples in pieces (m, columns), each written over the one before."""
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
        # Row by row from one stream: more samples, or other pieces, keep the first ones.
        halves = np.hsplit(rows, [self.mobilities])
        for columns, random in zip(halves, streams, strict=True):
            columns[:] = random.random(columns.shape)
        return self.shaped(rows)

    def shaped(self, even: base.Floats) -> base.Floats:
        """Numbers even over 0..1 made to draws in place: normal where a band's spread is."""
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
        """(m, T, 2) as `orders.switching_forces`, of (m, columns) draws of a chain of elements."""
        t, n = self.tolerances, len(self.chain)
        steps = np.array([len(phases) - 1 for phases in self.chain.phases])
        rub = np.array([cell.friction for cell in self.chain.cells])
        forces = switching_forces(self.chain) - np.repeat(rub, steps)[:, None] * [1.0, -1.0]
        scale = 1.0 + t.stiffness * drawn[:, self.scales : self.mobilities : 2]
        rub = rub + t.friction * drawn[:, self.scales - n : self.scales]
        scale, rub = (np.repeat(part, steps, axis=1)[:, :, None] for part in (scale, rub))
        return scale * forces + rub * [1.0, -1.0]

    def sample(self, number: int) -> Chain:
        """Mechanism `number` of all, from 0, as in `chunks`; ValueError if it cannot be built."""
        return self.built(self._filled(np.empty((1, self.columns)), self._streams(number))[0])

    def designs(self, drawn: base.Floats) -> Designs | None:
        """The mechanisms of (m, columns) draws as numbers, the same that are `built` one by one.

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
        """The mechanism that one row of draws makes; ValueError if it cannot be built."""
        t, b, n = self.tolerances, self.bands, len(self.chain)
        stiffness, rest = draw[4 * b : 5 * b], draw[5 * b : 6 * b]
        lever, friction = draw[6 * b : 6 * b + n], draw[6 * b + n :]
        scales = iter(draw[self.scales : self.mobilities].reshape(-1, 2).tolist())
        # Evenly on a scale of logarithms, as far up as down.
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
