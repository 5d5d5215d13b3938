"""Mechanisms as a workshop would make them: parts drawn at random within their tolerances.

One sample is one row of random numbers, and one row makes one mechanism. With B bands and N
cells the columns are, inner first: 4 B for where the anchors are in their discs (p: area and
angle, then q), B for the stiffness, B for ℓ0, N for the levers, N for the friction. Parts
without a tolerance take their numbers too, so that a part keeps its numbers whichever
tolerances are given, and two designs compared with one seed are made with the same luck.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtr, ndtri

from stepwell.base import Floats
from stepwell.concave import in_disc
from stepwell.design.tolerances.tolerances import Tolerances
from stepwell.mechanism import Band, Chain

_CUT = 4.0  # standard deviations at which the normal distribution ends
_AT_ONCE = 2**18  # numbers in a chunk: they stay in the processor's cache


@dataclass(frozen=True, slots=True)
class Draws:
    """Random mechanisms after one drawing, the same ones for the same seed."""

    chain: Chain
    tolerances: Tolerances
    seed: int

    @property
    def bands(self) -> int:
        """B, of all cells."""
        return sum(len(cell.bands) for cell in self.chain.cells)

    @property
    def columns(self) -> int:
        """How many random numbers make one mechanism."""
        return 6 * self.bands + 2 * len(self.chain)

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
        random = np.random.Generator(np.random.PCG64(self.seed))
        for first in range(0, n, rows):
            piece = space[: min(rows, n - first)]
            # Row by row from one stream: more samples, or other pieces, keep the first ones.
            random.random(out=piece)
            yield self.shaped(piece)

    def shaped(self, even: Floats) -> Floats:
        """Numbers even over 0..1 made to draws in place: normal where a band's spread is."""
        if self.tolerances.stiffness > 0 or self.tolerances.rest_length > 0:
            normal = even[:, 4 * self.bands : 6 * self.bands]
            tail = ndtr(-_CUT)
            normal[:] = ndtri(tail + (1.0 - 2.0 * tail) * normal)
        return even

    def sample(self, number: int) -> Chain:
        """Mechanism `number` of all, from 0; the same as in `chunks`.

        Raises:
            ValueError: a mechanism that cannot be built.
        """
        stream = np.random.PCG64(self.seed)
        stream.advance(number * self.columns)
        return self.built(self.shaped(np.random.Generator(stream).random((1, self.columns)))[0])

    def built(self, draw: Floats) -> Chain:
        """The mechanism that one row of draws makes.

        Raises:
            ValueError: a mechanism that cannot be built.
        """
        t, b, n = self.tolerances, self.bands, len(self.chain)
        stiffness, rest = draw[4 * b : 5 * b], draw[5 * b : 6 * b]
        lever, friction = draw[6 * b : 6 * b + n], draw[6 * b + n :]

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

        cells, first = [], 0
        for i, cell in enumerate(self.chain.cells):
            bands = tuple(made(first + j, band) for j, band in enumerate(cell.bands))
            first += len(bands)
            cells.append(
                replace(
                    cell,
                    band=bands,
                    lever=cell.lever + t.lever * (2.0 * lever[i] - 1.0),
                    friction=cell.friction + t.friction * friction[i],
                )
            )
        return replace(self.chain, cells=tuple(cells))
