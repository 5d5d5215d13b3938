"""Pairs of cells on a grid of holes whose snap sets the most energy free, for a jump."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Ints, amount, check, number, to_unit
from stepwell.design.synthesis.region import PAPER_LEVER, BandType
from stepwell.design.tolerances.draws import DEFAULT_TOLERANCES, Tolerances
from stepwell.design.tolerances.yields import Yield, yields
from stepwell.mechanism import Cell, Chain, Linear, geometry
from stepwell.sequences import cycle
from stepwell.statics import EventKind

# Travels at which forces and energies of a candidate are computed.
_POINTS = 201
_LIMIT = math.pi / 4
# Candidates that the engine looks at, the best of the closed form first.
_VERIFIED = 20


class Means(NamedTuple):
    """What is at hand for a snap: holes, stretch and the force of the actuator."""

    pitch: float = 0.005  # of the holes [m]
    depth: float = 0.020  # of the holes from the joints of a block, away from the other block [m]
    side: float = 0.015  # of the holes on either side of them [m]
    stretch: float = 5.0  # largest length of a band over its rest length
    force: float = math.inf  # of the actuator, either way [N]


_USUAL = Means()


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StrongestSnap(ByValue):
    """The pair of cells whose snap sets the most energy free, less the lift of a load.

    Attributes:
        chain: latch first, then the spring cell; the block between them is the foot.
        released: by the snap [J].
        ratio: that over k S² [1].
        foot_travel: travel of the foot in the snap [m].
        peak_force: extreme force of the actuator [N].
        stretch: largest length of a band over its rest length.
        bound: released by no pair of falling forces within this peak force [J]: 2 P S.
        candidates: number of pairs that meet all conditions.
        yield_: fraction of samples that keep the sequence.

    Source: theory page, "Energy of one snap".
    """

    chain: Chain
    released: float
    ratio: float
    foot_travel: float
    peak_force: float
    stretch: float
    bound: float
    candidates: int
    yield_: Yield = field(repr=False)

    def __str__(self):
        anchors = ", ".join(
            f"{name} ({number(to_unit(b.d[0], 'mm'))}, {number(to_unit(b.d[1], 'mm'))}) mm"
            for name, cell in zip(self.chain.names, self.chain.cells, strict=True)
            if isinstance(cell, Cell)
            for b in cell.bands
        )
        return (
            f"{amount(self.released, 'J', 4)}, {number(self.ratio, 3)} k S², over "
            f"{amount(self.foot_travel, 'm', 3)} of the foot; d = {anchors}; actuator "
            f"{amount(abs(self.peak_force), 'N', 3)}, bands stretched {number(self.stretch, 3)} "
            f"times"
        )

    def __repr__(self):
        return f"StrongestSnap({self})"


class _Kinds(NamedTuple):
    """Cells of each d = q - p that meets the conditions; m cells, n travels."""

    d: Floats  # (m, 2) [m]
    force: Floats  # (m, n) [N], falling
    energy: Floats  # (m, n) [J]


def strongest_snap(
    band: BandType,
    means: Means = _USUAL,
    *,
    lever: float = PAPER_LEVER,
    load: float = 0.0,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
) -> StrongestSnap:
    """Search all pairs of anchors on a grid of holes for the snap that frees the most energy.

    Both cells have the same band, taut and of falling force over the whole travel. For these cells
    the snap is known in closed form: all pairs are compared, and the engine verifies the best.

    Args:
        band: of both cells, Hooke's law.
        means: holes, largest stretch and force of the actuator.
        lever: length of the levers [m]; the cells turn by ±45°.
        load: weight that the latch carries and the foot lifts [N].
        tolerances: for the yield.

    Raises:
        ValueError: no pair snaps under these conditions; the text says what excludes most.
    """
    check.positive("lever", lever, "m")
    check.not_negative("load", load, "N")
    if not isinstance(band.law, Linear):
        raise InputError("band: must be of Hooke's law for this search.")
    kinds = _kinds(band, means, lever)
    lift = load * 2.0 * lever * math.sin(_LIMIT)
    score, latch, spring, count = _best_pairs(kinds, lift)
    name = "latch", "spring"
    for k in np.argsort(-score)[:_VERIFIED].tolist():
        cells = [
            Cell(band.between(*_anchors(kinds.d[i], means)), lever, name=which, unusual=True)
            for i, which in zip((latch[k], spring[k]), name, strict=True)
        ]
        chain = Chain(cells, title="Pair of the strongest snap")
        done = cycle(chain)
        snaps = [e for e in done.events if e.kind is EventKind.SNAP and e.direction > 0]
        if len(snaps) != 1 or done.degenerate:
            continue
        snap, full = snaps[0], chain.cells[0].full_travel
        moved = dict(zip(snap.cells, zip(snap.before, snap.after, strict=True), strict=True))[0]
        peak, most = done.path.peak_force, max(_stretch(cell) for cell in cells)
        counted = yields(chain, tolerances, samples=2000)
        ratio = snap.released / (band.stiffness * full**2)
        sizes = snap.released, ratio, moved[1] - moved[0], peak, most, 2.0 * abs(peak) * full
        return StrongestSnap(chain, *sizes, count, counted)
    raise InputError(_why_none(kinds, means))


def _why_none(kinds: _Kinds, means: Means) -> str:
    if len(kinds.d) < 2:
        return (
            f"means: {len(kinds.d)} of the anchors keep the band taut, below {means.stretch:g} "
            f"times its rest length, of falling force and within {amount(means.force, 'N')}. Allow "
            f"a longer stretch or a larger force, or take a weaker band."
        )
    return "means: no pair of anchors snaps. Allow a larger area of holes."


def _anchors(d: Floats, means: Means) -> tuple[tuple[float, float], tuple[float, float]]:
    """p and q on holes with q - p = d, as near to the middle as possible."""
    steps = np.round(d / means.pitch).astype(int)
    inner = np.array([-(steps[0] // 2), -(steps[1] // 2)])
    p, q = means.pitch * inner, means.pitch * (inner + steps)
    return (float(p[0]), float(p[1])), (float(q[0]), float(q[1]))


def _stretch(cell: Cell) -> float:
    angles = np.linspace(-cell.limit, cell.limit, _POINTS)
    return max(float(np.max(b.length(angles, cell.lever))) / b.rest_length for b in cell.bands)


def _kinds(band: BandType, means: Means, lever: float) -> _Kinds:
    across, along = (int(reach / means.pitch + 1e-9) for reach in (means.depth, means.side))
    x, y = np.arange(0, 2 * across + 1), np.arange(-2 * along, 2 * along + 1)
    d = means.pitch * np.array(np.meshgrid(x, y)).reshape(2, -1).T
    travel = np.linspace(0.0, 1.0, _POINTS)
    theta = np.arcsin((2.0 * travel - 1.0) * math.sin(_LIMIT))
    dx, dy = d[:, :1], d[:, 1:]
    sin, cos = np.sin(theta), np.cos(theta)
    length = geometry.band_length(sin, cos, dx, dy, lever)
    rest, k = band.rest_length, band.stiffness
    slope = geometry.length_slope(sin, cos, length, dx, dy)
    force = geometry.band_force(k * (length - rest), slope)
    fits = np.min(length, axis=1) > rest
    fits &= np.max(length, axis=1) <= means.stretch * rest
    fits &= np.all(np.diff(force, axis=1) < 0.0, axis=1)
    fits &= np.max(np.abs(force), axis=1) <= means.force
    extension = length[fits] - rest
    energy = np.asarray(geometry.band_energy(0.5 * k * extension, extension), float)
    return _Kinds(np.asarray(d[fits], float), force[fits], energy)


def _best_pairs(kinds: _Kinds, lift: float) -> tuple[Floats, Ints, Ints, int]:
    """Energy less the lift [J], latch and spring of the best pair of each latch; number of pairs.

    `lift` is the energy that lifts the load by the full travel.
    """
    force, energy, share = kinds.force, kinds.energy, np.linspace(0.0, 1.0, _POINTS)
    score: list[float] = []
    latch: list[int] = []
    spring: list[int] = []
    count = 0
    for j in range(len(force)):
        # The spring opens first, and comes back first while the latch opens.
        able = np.flatnonzero((force[:, 0] < force[j, 0]) & (force[:, -1] > force[j, -1]))
        able = able[force[able, -1] < force[j, 0]]
        if not len(able):
            continue
        at = np.interp(force[able, -1], force[j, ::-1], share[::-1])
        before = np.interp(at, share, energy[j]) + energy[able, -1]
        place = at * (_POINTS - 1)
        low = np.minimum(place.astype(int), _POINTS - 2)
        rest = place - low
        back = (1.0 - rest) * energy[able, low] + rest * energy[able, low + 1]
        freed = before - energy[j, -1] - back - lift * (1.0 - at)
        best = int(np.argmax(freed))
        count += len(able)
        score.append(float(freed[best]))
        latch.append(j)
        spring.append(int(able[best]))
    return np.array(score), np.array(latch, int), np.array(spring, int), count
