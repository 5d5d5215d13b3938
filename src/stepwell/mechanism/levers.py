"""Angles, band lengths, tensions and energies of all lever cells of a chain at many travels."""

from collections.abc import Callable, Sequence

import numpy as np

from stepwell.base import Bools, Floats, grouped
from stepwell.mechanism import cubics, geometry
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.element import Element


class Levers:
    """The lever cells among `cells` at (n, N) travels [m], by one operation for all of them.

    The numbers are those of every `Cell` alone; for many cells they take a third of the time.

    Attributes:
        number: (L,) which cells have levers.
        angle: (n, L) lever angles θ [rad].
        slack: (n, B) whether each band is slack, bands cell by cell.

    Raises:
        ValueError: a travel past a stop.
    """

    def __init__(self, cells: Sequence[Cell | Element], travel: Floats):
        self.number = [i for i, cell in enumerate(cells) if isinstance(cell, Cell)]
        self._cells = [cell for cell in cells if isinstance(cell, Cell)]
        self._bands = [band for cell in self._cells for band in cell.bands]
        owners = [k for k, cell in enumerate(self._cells) for _ in cell.bands]
        self._owner = np.array(owners, int)
        sizes = [(c.lever, c.limit, c.sin_limit, c.full_travel) for c in self._cells]
        lever, limit, sin_limit, full = np.reshape(sizes, (-1, 4)).T
        own = travel[:, self.number]
        for k in np.flatnonzero(~np.all(geometry.between_stops(own, full), axis=0)).tolist():
            self._cells[k].angle(own[:, k])  # raises
        self.angle = geometry.angle_at(own, lever, limit, sin_limit)

        bands = [(*b.d, b.stiffness, b.rest_length, b.two_sided) for b in self._bands]
        dx, dy, self._stiffness, rest, two_sided = np.reshape(bands, (-1, 5)).T
        theta = self.angle[:, self._owner]
        length = geometry.band_length(np.sin(theta), np.cos(theta), dx, dy, lever[self._owner])
        self._extension = length - rest
        self._pulls = (self._extension > 0) | (two_sided > 0)
        self.slack: Bools = (length <= rest) & (two_sided == 0)

    def tension(self) -> Floats:
        """(n, B) tension of every band [N]; zero where slack."""
        return np.where(self._pulls, self._stiffness * self._shapes(cubics.value), 0.0)

    def energy(self) -> Floats:
        """(n, L) potential energy of bands and load of every cell [J]."""
        shapes = self._shapes(cubics.integral)
        stored = np.where(self._pulls, geometry.band_energy(self._stiffness, shapes), 0.0)
        energy = np.zeros_like(self.angle)
        for band, cell in enumerate(self._owner.tolist()):
            energy[:, cell] += stored[:, band]
        for k, cell in enumerate(self._cells):
            if cell.load is not None:
                travel = cell.travel(self.angle[:, k])
                energy[:, k] += cubics.integral(cell.load.pieces(), travel)
        return energy

    def _shapes(self, curve: Callable[[Floats, Floats], Floats]) -> Floats:
        """(n, B) the curve of the law of every band at its extension."""
        shapes = np.empty_like(self._extension)
        # Most bands share one law: the same object, for comparing values would take longer.
        laws = grouped((id(band.law), b) for b, band in enumerate(self._bands))
        for bands in laws.values():
            every = slice(None) if len(laws) == 1 else bands
            pieces = self._bands[bands[0]].law.pieces()
            shapes[:, every] = curve(pieces, self._extension[:, every])
        return shapes
