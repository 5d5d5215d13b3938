"""Critical forces and robustness of a cell with its anchor at any of the allowed places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.concave import TIED, Simple, certified, end_force_field, slopes_by_sizes
from stepwell.design.margins.robustness import SIDES, AnchorProof, extremes, farthest
from stepwell.design.plane import Box
from stepwell.design.synthesis.holes import UNLIMITED, Packs
from stepwell.design.synthesis.region import BandType, Region
from stepwell.design.tolerances.draws import CellTolerances, Tolerances
from stepwell.mechanism import Cell, Linear, geometry

# Samples of the force over the travel, and relative steps of the derivatives [1].
LOOKS = 129
_NUDGE = 1e-6


class Candidates(NamedTuple):
    """Candidates for a cell, each with its two critical forces."""

    q: Floats  # (m, 2) places of the anchor that is free [m]
    kind: Ints  # (m,) number of the band and lever
    force: Floats  # (m, 2) F0 and F1 [N]
    down: Floats  # (m, 2) deviation of each downwards ...
    up: Floats  # (m, 2) ... and upwards, as added by `Rule.combined`
    room: Floats  # (m,) limit of the cell by itself, in units of its gaps

    def take(self, rows: Ints | Bools) -> Candidates:
        """The candidates of some rows."""
        return Candidates._make(column[rows] for column in self)


def joined(parts: list[Candidates]) -> Candidates:
    """All candidates in one."""
    return Candidates._make(np.concatenate(columns) for columns in zip(*parts, strict=True))


def differences(table: Candidates) -> Floats:
    """Differences of F0 and F1 of candidate b from those of a, [end, a, b] [N]."""
    force = table.force.T
    return force[:, None, :] - force[:, :, None]


@dataclass(frozen=True, eq=False)
class Kind:
    """Equal bands on a lever, the limit in rad; `unusual` to accept unusual lengths.

    Without `cells` it is for every cell, without `tolerances` it has the largest ones of the rule.
    """

    band: BandType
    lever: float
    limit: float
    unusual: bool = False
    count: int = 1  # number of bands
    cells: frozenset[int] | None = None  # that it may be, 0 the innermost
    tolerances: CellTolerances | None = None

    @cached_property
    def cell(self) -> Simple:
        """The cell as plain numbers, without anchors."""
        nowhere = math.nan, math.nan
        sine = math.sin(self.limit)
        stiffness = self.count * self.band.stiffness
        return Simple(*nowhere, stiffness, self.band.rest_length, self.lever, sine)

    @property
    def bends(self) -> bool:
        """Whether the elastic law of the band is nonlinear; proofs hold for linear ones."""
        return not isinstance(self.band.law, Linear)

    def ends(self, d: Floats) -> tuple[Floats, Floats]:
        """End forces (m, 2) [N] at d (m, 2) [m] and their slopes by the anchor (m, 2, 2) [N/m]."""
        if not self.bends:
            out = np.array([end_force_field(self.cell, side, d) for side in SIDES])
            return out[:, :, 0].T, out[:, :, 1:].transpose(1, 0, 2)
        step = _NUDGE * self.lever
        moves = step * np.eye(2)
        slopes = [(self._forces(d + move) - self._forces(d - move)) / (2 * step) for move in moves]
        return self._forces(d), np.stack(slopes, axis=2)

    def falls(self, d: Floats) -> Bools:
        """Whether the band is taut with falling force at each of (m, 2) differences [m], (m,)."""
        force, length = self._at(np.linspace(-self.cell.sin_limit, self.cell.sin_limit, LOOKS), d)
        taut = np.all(length > self.band.rest_length, axis=1)
        return taut & np.all(np.diff(force, axis=1) < 0.0, axis=1)

    def taut(self, d: Floats) -> Bools:
        """Whether the band stays longer than at rest at each of (m, 2) differences [m], (m,)."""
        length = self._at(np.linspace(-self.cell.sin_limit, self.cell.sin_limit, LOOKS), d)[1]
        return np.all(length > self.band.rest_length, axis=1)

    def by_sizes(self, d: Floats) -> tuple[Floats, Floats]:
        """∂F/∂ℓ0 and ∂F/∂r [N/m] of F0 and F1, (m, 2) each."""
        if not self.bends:
            return slopes_by_sizes(self.cell, np.array(SIDES), d[:, :1], d[:, 1:])
        step, rest = _NUDGE * self.lever, self.band.rest_length
        longer, shorter = (
            replace(self, band=replace(self.band, rest_length=one))._forces(d)
            for one in (rest + step, max(rest - step, 0.0))
        )
        wide, narrow = (replace(self, lever=self.lever + one)._forces(d) for one in (step, -step))
        return (longer - shorter) / (step + min(step, rest)), (wide - narrow) / (2 * step)

    def _forces(self, d: Floats) -> Floats:
        return self._at(np.array([-self.cell.sin_limit, self.cell.sin_limit]), d)[0]

    def _at(self, sine: Floats, d: Floats) -> tuple[Floats, Floats]:
        """Force [N] and length [m], (m, k) each, at k sines of the angle."""
        cosine = np.sqrt(1.0 - sine**2)
        dx, dy = d[:, :1], d[:, 1:]
        length = geometry.band_length(sine, cosine, dx, dy, self.lever)
        first = geometry.length_slope(sine, cosine, length, dx, dy)
        tension = self.band.between((0.0, 0.0), (1.0, 0.0), self.count).tension(length)
        return np.asarray(geometry.band_force(tension, first)), length


class Site(NamedTuple):
    """Where a cell may be placed, and the numbers of the kinds that it may be."""

    region: Region
    kinds: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Rule:
    """Allowed cells, and the measure of robustness."""

    fixed: tuple[float, float]  # the anchor that stays [m]
    kinds: tuple[Kind, ...]
    tolerances: Tolerances
    most_force: float  # of the actuator [N]
    worst: bool  # measure the largest displacement of all anchors at once, not the tolerances
    looked_at: Box  # contains all places of the free anchor
    as_drawn: bool = False  # a band must be proved taut and concave at its nominal place only
    free: str = "q"  # which anchor is placed: "q", "p", or "both" with p = -q

    def cell(self, q: tuple[float, float], k: int) -> Cell:
        """The k-th kind with its free anchor at q [m]; ValueError if it cannot be built."""
        kind = self.kinds[k]
        mirrored = -q[0] + 0.0, -q[1] + 0.0  # no -0
        p, q = {"q": (self.fixed, q), "p": (q, self.fixed), "both": (mirrored, q)}[self.free]
        band = kind.band.between(p, q, kind.count)
        # Places of a search are not user input, so unit errors are not checked here.
        return replace(Cell(band, kind.lever, kind.limit, unusual=True), unusual=kind.unusual)

    def combined(self, a: Floats, b: Floats) -> Floats:
        """Combined deviation by which two critical forces may approach each other."""
        return a + b if self.worst else np.hypot(a, b)

    def everything(
        self, region: Region, q: Floats, radius: float = 0.0, kinds: tuple[int, ...] | None = None
    ) -> Candidates:
        """Candidates of every kind, or of some, at each of (m, 2) places, moved inside the region.

        Places are left out if the cell is not proved taut and concave, or exceeds the actuator's
        force. In the worst case, `radius` [m] is the displacement of `down` and `up`.
        """
        q = region.clamped(q)
        every = range(len(self.kinds)) if kinds is None else kinds
        return joined([self._of_kind(q, k, radius) for k in every])

    def these(self, q: Floats, kind: Ints, radius: float = 0.0) -> Candidates:
        """Candidates of (m,) kinds at (m, 2) places, one each, as in `everything`."""
        pairs = enumerate(kind.tolist())
        return joined([self._of_kind(q[i : i + 1], k, radius) for i, k in pairs])

    def sites(self, regions: Sequence[Region]) -> tuple[Site, ...]:
        """The region of every cell, and the kinds that the cell may be."""
        allowed = [
            tuple(
                k for k, kind in enumerate(self.kinds) if kind.cells is None or cell in kind.cells
            )
            for cell in range(len(regions))
        ]
        return tuple(map(Site, regions, allowed))

    def _of_kind(self, q: Floats, k: int, radius: float) -> Candidates:
        cell = self.kinds[k].cell
        q = q[self.allowed(q, k)]
        d = self.differences(q)
        force, slope = self.kinds[k].ends(d)
        if self.worst:
            down, up = extremes(cell, d, force, slope, radius)
            room = self._proofs[k].radius(d)
        else:
            down = up = _deviations(self.kinds[k], d, force, slope, self._deviating(k))
            room = np.full(len(d), math.inf)
        return Candidates(q, np.full(len(q), k), force, down, up, room)

    def allowed(self, q: Floats, k: int) -> Bools:
        """Whether the k-th kind is allowed at each of (m, 2) places: force limit, falling force."""
        kind, d = self.kinds[k], self.differences(q)
        weak = np.all(np.abs(kind.ends(d)[0]) <= self.most_force, axis=1)
        if kind.bends:
            return weak & kind.falls(d)
        if self.as_drawn:
            return weak & certified(kind.cell, d)
        # A longer rest length makes the proof harder, as any displacement does.
        own = self._tolerances(k)
        rest = kind.cell.rest * (1.0 + 4.0 * own.rest_length)
        return weak & certified(kind.cell._replace(rest=rest), d, 2.0 * own.anchor)

    def differences(self, q: Floats) -> Floats:
        """d = q - p [m] with the free anchor at (m, 2) places."""
        fixed = np.array(self.fixed)
        return {"q": q - fixed, "p": fixed - q, "both": 2.0 * q}[self.free]

    @cached_property
    def packs(self) -> Packs:
        """For each kind its type of band, and its number of bands; the available ones of a type."""
        types = list(dict.fromkeys(kind.band for kind in self.kinds))
        return Packs(
            np.array([types.index(kind.band) for kind in self.kinds]),
            np.array([kind.count for kind in self.kinds]),
            np.array([UNLIMITED if one.pack is None else one.pack for one in types]),
        )

    @property
    def limited(self) -> bool:
        """Whether the number of some type of band is limited."""
        return any(kind.band.pack is not None for kind in self.kinds)

    def within_packs(self, kinds: Ints) -> Bools:
        """Whether the packs hold the bands of the cells in each row of kinds (..., N)."""
        packs = self.packs
        return np.all(
            [
                np.sum(np.where(packs.band[kinds] == k, packs.uses[kinds], 0), axis=-1) <= room
                for k, room in enumerate(packs.room.tolist())
            ],
            axis=0,
        )

    def left(self, offered: Candidates, others: Ints) -> Candidates:
        """Candidates for a cell whose bands the packs still hold, with others of these kinds."""
        if not self.limited or not len(offered.q):
            return offered
        rows = [np.append(others, kind) for kind in range(len(self.kinds))]
        return offered.take(self.within_packs(np.array(rows))[offered.kind])

    @property
    def bends(self) -> bool:
        """Whether some elastic law is nonlinear: falling forces are then sampled, not proved."""
        return any(kind.bends for kind in self.kinds)

    @cached_property
    def _proofs(self) -> list[AnchorProof]:
        box = self.looked_at
        corners = self.differences(np.array([[box.left, box.bottom], [box.right, box.top]]))
        d = Box(*np.sort(corners, axis=0).T.ravel().tolist())
        return [AnchorProof(kind.cell, d) for kind in self.kinds]

    def _tolerances(self, k: int) -> CellTolerances:
        kind = self.kinds[k]
        own, spread = kind.tolerances or self.tolerances.most, kind.band.spread
        return own if spread is None else own._replace(stiffness=spread)

    def _deviating(self, k: int) -> CellTolerances:
        """Its tolerances, never all zero."""
        own = self._tolerances(k)
        if any(own):
            return own
        # Without tolerances all designs are equally robust; gaps are then measured in millimetres.
        # An exact cell next to others has nearly no deviation.
        exact = not any(any(self._tolerances(j)) for j in range(len(self.kinds)))
        return CellTolerances(anchor=0.001 if exact else 1e-6)

    def gaps(self, table: Candidates) -> Floats:
        """Robustness of candidate a next below b, [end, a, b]; -inf if it is not below.

        The gap between them over its deviation, or in the worst case the radius [m] up to which
        the order stays and both cells are proved.
        """
        apart = differences(table)
        tie = TIED * float(np.max(np.abs(table.force), initial=0.0))
        if self.worst:
            both = np.minimum(table.room, table.room[:, None])
            sure = np.minimum(self._radii(table, apart, tie), both)
        else:
            sure = apart / self.combined(table.up.T[:, :, None], table.down.T[:, None, :])
        return np.where(apart > tie, sure, -np.inf)

    def _radii(self, table: Candidates, apart: Floats, tie: float) -> Floats:
        # The reduction of a gap by the anchors is nearly proportional to the radius.
        above = np.where(apart > tie, apart, np.nan)
        radius = np.full_like(above, 1e-6)
        for _ in range(10):
            taken = self._taken(table, radius, 1) + self._taken(table, radius.swapaxes(1, 2), -1)
            radius *= above / taken
        return radius

    def _taken(self, table: Candidates, radius: Floats, sign: int) -> Floats:
        """Rise or fall of the critical forces of candidate a within radius[end, a, b]."""
        m = len(table.q)
        out = np.empty_like(radius)
        for k in np.unique(table.kind).tolist():
            rows = np.flatnonzero(table.kind == k)
            d = np.repeat(self.differences(table.q[rows]), m, axis=0)
            for end, side in enumerate(SIDES):
                reach = radius[end, rows].ravel()
                force = farthest(self.kinds[k].cell, side, d, reach, sign)[:, 0].reshape(-1, m)
                out[end, rows] = np.abs(force - table.force[rows, end, None])
        return out if sign > 0 else out.swapaxes(1, 2)


def _deviations(kind: Kind, d: Floats, force: Floats, slope: Floats, t: CellTolerances) -> Floats:
    """Standard deviations of F0 and F1 [N] to first order, (m, 2).

    A uniform point in a disc of radius a has the variance a²/4 along each axis, and d is the
    difference of two; a uniform value within ±w has w²/3, and one from 0 to w has w²/12.
    """
    by_rest, by_lever = kind.by_sizes(d)
    variance = (
        np.sum(slope * slope, axis=2) * t.anchor**2 / 2
        + (force * t.stiffness) ** 2
        + (by_rest * kind.band.rest_length * t.rest_length) ** 2
        + (by_lever * t.lever) ** 2 / 3
        + t.friction**2 / 12
    )
    return np.sqrt(variance)
