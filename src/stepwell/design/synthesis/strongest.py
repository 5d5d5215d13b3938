"""Pairs of cells on a grid of holes whose snap sets the most energy free, for a jump."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from stepwell.base import (
    Bools,
    ByValue,
    Floats,
    InputError,
    Ints,
    amount,
    check,
    counted,
    number,
    to_unit,
)
from stepwell.design.synthesis.designed import Impossible
from stepwell.design.synthesis.region import PAPER_LEVER, BandType
from stepwell.mechanism import Cell, Chain, Linear, Load, geometry
from stepwell.sequences import Cycle, cycle
from stepwell.statics import Event, EventKind

# Travels at which forces and energies of a candidate are computed.
_POINTS = 201
_SHARES = np.linspace(0.0, 1.0, _POINTS)
# Places on the way of a snap at which a spring is compared with the latch.
_WAY = np.linspace(0.02, 1.0, 25)
_LIMIT = math.pi / 4
# Candidates that the engine looks at, the best of the closed form first.
_VERIFIED = 20


class Means(NamedTuple):
    """What is at hand for a snap: holes, stretch, the force of the actuator, and friction.

    With a `spread`, pairs are compared by energy times the probability that the latch moves last
    and stays last, for independent normal errors of both bands.
    """

    pitch: float = 0.005  # of the holes [m]
    depth: float = 0.020  # of the holes from the joints of a block, away from the other block [m]
    side: float = 0.015  # of the holes on either side of them [m]
    stretch: float = 5.0  # largest length of a band over its rest length
    force: float = math.inf  # of the actuator, either way [N]
    friction: float = 0.0  # against the travel of each cell [N]
    spread: float = 0.0  # standard deviation of the bands' forces over their mean


_USUAL = Means()


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StrongestSnap(ByValue):
    """The pair of cells whose snap sets the most energy free, less the lift of a load.

    Attributes:
        chain: latch first, then the spring cell; the block between them is the foot.
        released: by the springs in the snap [J].
        energy: that less the lift of the load [J].
        ratio: released over k S² [1].
        foot_travel: travel of the foot in the snap [m].
        peak_force: extreme force of the actuator, load and friction included [N].
        stretch: largest length of a band over its rest length.
        force_bound: energy of no pair within the force of the actuator, or within the peak force
            of this pair if no force is given [J]: 2 P S.
        stretch_bound: energy of no pair of this band within the allowed stretch [J].
        candidates: number of pairs that meet all conditions; all of them are compared.

    Source: theory page, "Energy of one snap".
    """

    chain: Chain
    released: float
    energy: float
    ratio: float
    foot_travel: float
    peak_force: float
    stretch: float
    force_bound: float
    stretch_bound: float
    candidates: int

    @property
    def bound(self) -> float:
        """Energy that no pair exceeds with these means, which is proved [J]."""
        return min(self.force_bound, self.stretch_bound)

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
    force: Floats  # (m, n) of the bands [N]
    energy: Floats  # (m, n) [J]
    falls: Bools  # (m,) whether the force falls all along
    counts: tuple[int, int, int, int]  # of anchors: all, in tension, within the stretch, falling


def strongest_snap(
    band: BandType,
    means: Means = _USUAL,
    *,
    lever: float = PAPER_LEVER,
    load: float = 0.0,
    unusual: bool = True,
) -> StrongestSnap:
    """Search all pairs of anchors on a grid of holes for the snap that frees the most energy.

    Both cells have the same band, in tension over the whole travel; the force of the latch falls,
    and the spring cell opens and closes completely. For these pairs the snap is known in closed
    form: all are compared, and the engine verifies the best.

    Args:
        band: of both cells, Hooke's law.
        means: holes, largest stretch, force of the actuator and friction.
        lever: length of the levers [m]; the cells turn by ±45°.
        load: weight that the latch carries and the foot lifts [N].
        unusual: False to refuse lengths that look like unit errors.

    Raises:
        Impossible: no pair snaps under these conditions; the text has the number of anchors that
            meet each condition.
        ValueError: a value out of range.
    """
    return next(strongest_snaps(band, means, lever=lever, load=load, unusual=unusual))


def strongest_snaps(
    band: BandType,
    means: Means = _USUAL,
    *,
    lever: float = PAPER_LEVER,
    load: float = 0.0,
    unusual: bool = True,
) -> Iterator[StrongestSnap]:
    """Up to 20 pairs with different latches, the best first; all else as for `strongest_snap`."""
    check.positive("lever", lever, "m")
    check.not_negative("load", load, "N")
    if not isinstance(band.law, Linear):
        raise InputError("band: must be of Hooke's law for this search.")
    if not means.force > load + means.friction:
        raise InputError(
            f"force = {amount(means.force, 'N')}: must be > {amount(load + means.friction, 'N')}, "
            f"the load and the friction that the actuator holds before the snap."
        )
    kinds = _kinds(band, means, lever)
    score, latch, spring, count = _best_pairs(kinds, means, lever, load)
    none = True
    for k in np.argsort(-score, kind="stable")[:_VERIFIED].tolist():
        cells = [
            Cell(
                band.between(*_anchors(kinds.d[i], means)),
                lever,
                friction=means.friction,
                name=which,
                unusual=unusual,
            )
            for i, which in zip((latch[k], spring[k]), ("latch", "spring"), strict=True)
        ]
        chain = Chain(cells, title="Pair of the strongest snap")
        carries = replace(cells[0], load=Load.constant(load) if load else None)
        done = cycle(replace(chain, cells=(carries, cells[1])))
        snaps = [e for e in done.events if e.kind is EventKind.SNAP and e.direction > 0]
        if len(snaps) == 1 and not done.degenerate:
            none = False
            yield _snap_of(chain, done, snaps[0], (band, means, load, count))
    if none:
        why = _why_none(kinds, means, lever, load)
        raise Impossible("strongest snap", why, proved=not len(score))


def _snap_of(
    chain: Chain, done: Cycle, snap: Event, given: tuple[BandType, Means, float, int]
) -> StrongestSnap:
    band, means, load, count = given
    moves = dict(zip(snap.cells, zip(snap.before, snap.after, strict=True), strict=True))
    full, way = chain.levers[0].full_travel, moves[0][1] - moves[0][0]
    stored = (chain.cells[i].energy_at(np.array(ends)) for i, ends in moves.items())
    released = math.fsum(float(before - after) for before, after in stored)
    most, reach = abs(done.path.peak_force), (means.stretch - 1.0) * band.rest_length
    allowed = means.force if math.isfinite(means.force) else most
    return StrongestSnap(
        chain,
        released,
        energy=released - load * way,
        ratio=released / (band.stiffness * full**2),
        foot_travel=way,
        peak_force=done.path.peak_force,
        stretch=max(cell.largest_stretch for cell in chain.levers),
        force_bound=2.0 * allowed * full,
        # Each band gets shorter by at most the travel, and ends at its rest length or above.
        stretch_bound=band.stiffness * (reach**2 - max(reach - full, 0.0) ** 2),
        candidates=count,
    )


def _why_none(kinds: _Kinds, means: Means, lever: float, load: float) -> str:
    every, taut, short, falling = kinds.counts
    pairs = _best_pairs(kinds, means._replace(force=math.inf), lever, load)[3]
    free = _best_pairs(kinds, means._replace(force=math.inf, friction=0.0), lever, 0.0)[3]
    why = (
        f"of {every} differences q - p on the holes, {taut} keep the band in tension, {short} of "
        f"these within {number(means.stretch, 4)} times its rest length, {falling} of these with "
        f"a falling force, as a latch needs"
    )
    if not free:
        return f"{why}, and no pair snaps; allow a longer stretch, or more holes"
    if not pairs:
        lifted = f"{amount(load, 'N', 3)} of load"
        without = f"{counted(free, 'pair')} without a load"
        return f"{why}; {without}, but none with {lifted}; take a stiffer band"
    limit = amount(means.force, "N", 4)
    return (
        f"{why}; {counted(pairs, 'pair')} with any force, but none within {limit} of the actuator; "
        f"take a softer band"
    )


def _anchors(d: Floats, means: Means) -> tuple[tuple[float, float], tuple[float, float]]:
    """p and q on holes with q - p = d, as near to the middle as possible."""
    steps = np.round(d / means.pitch).astype(int)
    inner = np.array([-(steps[0] // 2), -(steps[1] // 2)])
    p, q = means.pitch * inner, means.pitch * (inner + steps)
    return (float(p[0]), float(p[1])), (float(q[0]), float(q[1]))


def _kinds(band: BandType, means: Means, lever: float) -> _Kinds:
    across, along = (int(reach / means.pitch + 1e-9) for reach in (means.depth, means.side))
    x, y = np.arange(0, 2 * across + 1), np.arange(-2 * along, 2 * along + 1)
    d = means.pitch * np.array(np.meshgrid(x, y)).reshape(2, -1).T
    theta = np.arcsin((2.0 * _SHARES - 1.0) * math.sin(_LIMIT))
    least, most = geometry.stretch_range(d[:, 0], d[:, 1], lever, _LIMIT)
    rest, k = band.rest_length, band.stiffness
    taut = least > rest
    short = taut & (most <= means.stretch * rest)
    dx, dy = d[short, :1], d[short, 1:]
    sin, cos = np.sin(theta), np.cos(theta)
    length = geometry.band_length(sin, cos, dx, dy, lever)
    slope = geometry.length_slope(sin, cos, length, dx, dy)
    force = np.asarray(geometry.band_force(k * (length - rest), slope), float)
    falls = np.all(np.diff(force, axis=1) < 0.0, axis=1)
    energy = np.asarray(geometry.band_energy(0.5 * k * (length - rest), length - rest), float)
    counts = len(d), int(taut.sum()), int(short.sum()), int(falls.sum())
    return _Kinds(np.asarray(d[short], float), force, energy, falls, counts)


def _best_pairs(
    kinds: _Kinds, means: Means, lever: float, load: float
) -> tuple[Floats, Ints, Ints, int]:
    """Energy less the lift [J], latch and spring of the best pair of each latch; number of pairs.

    With a spread the energy is multiplied by the probability of the order. The latch carries the
    load [N], so its force is larger by it.
    """
    force, energy = kinds.force, kinds.energy
    rub, lift = 2.0 * means.friction, load * 2.0 * lever * math.sin(_LIMIT)
    score: list[float] = []
    latch: list[int] = []
    spring: list[int] = []
    count = 0
    top, least = force.max(axis=1), force.min(axis=1)
    held = (top <= means.force - means.friction) & (least >= means.friction - means.force)
    fits = kinds.falls & (top + load <= means.force - means.friction)
    fits &= least + load >= means.friction - means.force
    for j in np.flatnonzero(fits).tolist():
        carried = force[j] + load
        # The spring opens first, and comes back first while the latch opens.
        able = np.flatnonzero(held & (top < carried[0]) & (force[:, -1] > carried[-1] + rub))
        if not len(able):
            continue
        at = np.interp(force[able, -1] - rub, carried[::-1], _SHARES[::-1])
        before = np.interp(at, _SHARES, energy[j]) + energy[able, -1]
        place = at * (_POINTS - 1)
        low = np.minimum(place.astype(int), _POINTS - 2)
        rest = place - low
        back = (1.0 - rest) * energy[able, low] + rest * energy[able, low + 1]
        freed = before - energy[j, -1] - back - lift * (1.0 - at)
        freed[~_goes_on(kinds, able, at, carried + rub)] = 0.0
        rank = freed
        if means.spread > 0.0:
            for end in (0, -1):
                gap = abs(carried[end] - (top[able] if end == 0 else force[able, end]))
                rank = rank * ndtr(gap / means.spread / np.hypot(force[j, end], force[able, end]))
        best = int(np.argmax(rank))
        if not freed[best] > 0.0:
            continue
        count += int(np.sum(freed > 0.0))
        score.append(float(rank[best]))
        latch.append(j)
        spring.append(int(able[best]))
    return np.array(score), np.array(latch, int), np.array(spring, int), count


def _goes_on(kinds: _Kinds, able: Ints, begin: Floats, latch: Floats) -> Bools:
    """Whether each spring pulls more than the latch all the way from the beginning of the snap.

    `begin` is the share of the latch's travel at which it begins, for each of the `able` springs. A
    falling spring always does.
    """
    goes = np.ones(len(able), bool)
    for k in np.flatnonzero(~kinds.falls[able]).tolist():
        share = begin[k] + (1.0 - begin[k]) * _WAY
        pull = np.interp(1.0 - share + begin[k], _SHARES, kinds.force[able[k]])
        goes[k] = np.all(pull > np.interp(share, _SHARES, latch))
    return goes
