"""Mechanisms as a workshop would make them: parts drawn at random within their tolerances.

One sample is one row of random numbers, and one row makes one mechanism. With B bands and N
cells the columns are, inner first: 4 B for where the anchors are in their discs (p: area and
angle, then q), B for the stiffness, B for ℓ0, N for the levers, N for the friction, and for each
element one for its forces and one for its travels; at last, from a stream of their own, N for
the mobilities. Parts without a tolerance take their numbers too, so that a part keeps its numbers
whichever tolerances are given, and two designs compared with one seed are made with the same luck.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.concave import in_disc, in_discs
from stepwell.design.orders import switching_forces
from stepwell.design.tolerances.tolerances import Tolerances, levers_of
from stepwell.mechanism import Band, Cell, Chain, Element, travel_of
from stepwell.statics import FRICTION, FULL, LEVER, MOBILITY, SIN_LIMIT, Designs, nominal

_CUT = 4.0  # standard deviations at which the normal distribution ends
_AT_ONCE = 2**18  # numbers in a chunk: they stay in the processor's cache


class Part(NamedTuple):
    """What varies by itself: its cell, the tolerance that it has, and the columns of its numbers.

    Attributes:
        cell: 0 the innermost.
        what: "d" (all anchors of its bands), or what else of a cell or an element.
        tolerance: the field of `Tolerances`.
        columns: of the draws.
    """

    cell: int
    what: str
    tolerance: str
    columns: list[int]


@dataclass(frozen=True, slots=True, eq=False)
class Draws(ByValue):
    """Random mechanisms after one drawing, the same ones for the same seed.

    Attributes:
        known: a part of which only the share `left` of its tolerance is left; "" for none.
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
        found: dict[str, Part] = {}
        names, first, scale = self.chain.names, 0, self.scales
        for i, cell in enumerate(self.chain.cells):
            name = names[i] if names.count(names[i]) == 1 else i + 1
            friction = ("friction", "friction", [6 * b + n + i])
            if isinstance(cell, Element):
                parts = [
                    ("force_scale", "stiffness", [scale]),
                    ("travel_scale", "travel", [scale + 1]),
                ]
                scale += 2
            else:
                bands = range(first, first + len(cell.bands))
                first = bands.stop
                parts = [
                    ("d", "anchor", [4 * band + k for band in bands for k in range(4)]),
                    ("stiffness", "stiffness", [4 * b + band for band in bands]),
                    ("rest_length", "rest_length", [5 * b + band for band in bands]),
                    ("lever", "lever", [6 * b + i]),
                ]
            for what, tolerance, columns in (*parts, friction):
                if getattr(t, tolerance) > 0:
                    found[f"{name}.{what}"] = Part(i, what, tolerance, columns)
        return found

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
    def spread(self) -> Floats:
        """(5,) the tolerances as the kernels take them."""
        t = self.tolerances
        return np.array([t.anchor, t.stiffness, t.rest_length, t.lever, t.friction])

    def chunks(self, n: int) -> Iterator[Floats]:
        """The first n samples, piece by piece, (m, columns).

        Every piece is written over the one before.
        """
        rows = max(64, min(n, _AT_ONCE // self.columns))
        space = np.empty((rows, self.columns))
        streams = self._streams(0)
        for first in range(0, n, rows):
            piece = space[: min(rows, n - first)]
            self._fill(piece, streams)
            yield self.shaped(piece)

    def _streams(self, number: int) -> list[np.random.Generator]:
        """The two streams of random numbers, before those of mechanism `number`."""
        found: list[np.random.Generator] = []
        for seed, columns in (self.seed, self.mobilities), ((self.seed, 1), len(self.chain)):
            stream = np.random.PCG64(seed)
            stream.advance(number * columns)
            found.append(np.random.Generator(stream))
        return found

    def _fill(self, rows: Floats, streams: list[np.random.Generator]) -> None:
        # Row by row from one stream: more samples, or other pieces, keep the first ones.
        halves = np.hsplit(rows, [self.mobilities])
        for columns, random in zip(halves, streams, strict=True):
            columns[:] = random.random(columns.shape)

    def shaped(self, even: Floats) -> Floats:
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

    def _narrow(self, drawn: Floats) -> None:
        """Leave of the spread of the part that is known its share."""
        _, _, tolerance, columns = self.parts[self.known]
        if tolerance == "anchor":
            # The first of two numbers is an area.
            drawn[:, columns[::2]] *= self.left**2
        elif tolerance in ("lever", "friction"):
            drawn[:, columns] = 0.5 + self.left * (drawn[:, columns] - 0.5)
        else:
            drawn[:, columns] *= self.left

    def switching_forces(self, drawn: Floats) -> Floats:
        """(m, T, 2) as `orders.switching_forces`, of (m, columns) draws of a chain of elements."""
        t, n = self.tolerances, len(self.chain)
        steps = np.array([len(phases) - 1 for phases in self.chain.phases])
        rub = np.array([cell.friction for cell in self.chain.cells])
        forces = switching_forces(self.chain) - np.repeat(rub, steps)[:, None] * [1.0, -1.0]
        scale = 1.0 + t.stiffness * drawn[:, self.scales : self.mobilities : 2]
        rub = rub + t.friction * drawn[:, self.scales - n : self.scales]
        return np.repeat(scale, steps, axis=1)[:, :, None] * forces + np.repeat(rub, steps, axis=1)[
            :, :, None
        ] * [1.0, -1.0]

    def sample(self, number: int) -> Chain:
        """Mechanism `number` of all, from 0; the same as in `chunks`.

        Raises:
            ValueError: a mechanism that cannot be built.
        """
        row = np.empty((1, self.columns))
        self._fill(row, self._streams(number))
        return self.built(self.shaped(row)[0])

    def designs(self, drawn: Floats) -> Designs | None:
        """The mechanisms of (m, columns) draws as numbers, the same that are `built` one by one.

        None for elements, whose curves have to be built, and for long chains.
        """
        t, b, n = self.tolerances, self.bands, len(self.chain)
        designs = None if self.chain.elements else nominal(self.chain, len(drawn))
        if designs is None:
            return None
        where = np.empty((len(drawn), 2 * b, 2))
        in_discs(t.anchor, np.ascontiguousarray(drawn[:, : 4 * b]), where)
        drawing = [band for cell in levers_of(self.chain) for band in cell.bands]
        p, q = (np.array([getattr(band, end) for band in drawing]) for end in "pq")
        bands, cells = designs.bands, designs.cells
        bands[:, :, :2] = (q + where[:, 1::2]) - (p + where[:, ::2])
        bands[:, :, 2] *= 1.0 + t.stiffness * drawn[:, 4 * b : 5 * b]
        bands[:, :, 3] *= 1.0 + t.rest_length * drawn[:, 5 * b : 6 * b]
        lever, rub = np.split(drawn[:, 6 * b : 6 * b + 2 * n], 2, axis=1)
        cells[:, :, LEVER] += t.lever * (2.0 * lever - 1.0)
        sine = cells[:, :, SIN_LIMIT]
        cells[:, :, FULL] = travel_of(sine, cells[:, :, LEVER], sine)
        cells[:, :, FRICTION] += t.friction * rub
        cells[:, :, MOBILITY] *= t.mobility ** (drawn[:, self.mobilities :] - 0.5)
        return designs

    def built(self, draw: Floats) -> Chain:
        """The mechanism that one row of draws makes.

        Raises:
            ValueError: a mechanism that cannot be built.
        """
        t, b, n = self.tolerances, self.bands, len(self.chain)
        stiffness, rest = draw[4 * b : 5 * b], draw[5 * b : 6 * b]
        lever, friction = draw[6 * b : 6 * b + n], draw[6 * b + n :]
        scales = iter(draw[self.scales : self.mobilities].reshape(-1, 2).tolist())
        # Evenly on a scale of logarithms, as far up as down.
        faster = t.mobility ** (draw[self.mobilities :] - 0.5)

        def made(number: int, band: Band) -> Band:
            where = draw[4 * number : 4 * number + 4].tolist()
            px, py = in_disc(t.anchor, where[0], where[1])
            qx, qy = in_disc(t.anchor, where[2], where[3])
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
                scale = cell.force_scale * (1.0 + t.stiffness * force)
                size = cell.travel_scale * (1.0 + t.travel * travel)
                made_so = {"force_scale": scale, "travel_scale": size}
                cells.append(replace(cell, **made_so, friction=rub, mobility=mobility))
                continue
            bands = tuple(made(first + j, band) for j, band in enumerate(cell.bands))
            first += len(bands)
            longer = cell.lever + t.lever * (2.0 * lever[i] - 1.0)
            cells.append(replace(cell, band=bands, lever=longer, friction=rub, mobility=mobility))
        return replace(self.chain, cells=tuple(cells))
