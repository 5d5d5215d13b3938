"""Search for the nearest displacement of an anchor that reaches a target."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats, InputError, Progress, bisected, notify, to_unit
from stepwell.concave import Simple, concave_disc, concave_line


@dataclass(frozen=True, eq=False)
class Displacements:
    """Allowed displacements of an anchor: frame @ u for all u no longer than the reach."""

    frame: Floats  # (2, n) orthonormal; n = 2 for the plane, 1 for a line
    one_way: bool  # on a line, whether only u >= 0 counts
    reach: float  # [m]

    @classmethod
    def of(cls, along: Sequence[float] | None, one_way: bool, reach: float) -> "Displacements":
        """The plane where `along` is None, else the line that way; ValueError for neither."""
        if not 0 < reach < math.inf:
            raise InputError(f"reach = {reach} m: must be > 0 and finite.")
        if along is None:
            if one_way:
                raise InputError("one_way = True needs a direction: give along = (dx, dy).")
            return cls(np.eye(2), False, reach)
        direction = np.array(along, float)
        length = float(np.linalg.norm(direction))
        if direction.shape != (2,) or not 0 < length < math.inf:
            raise InputError(
                f"along = {along!r}: must be a direction (dx, dy) other than (0, 0), of any "
                f"length; (-1, 0) pushes the anchor inwards."
            )
        return cls(direction[:, None] / length, one_way, reach)

    @property
    def dimensions(self) -> int:
        """1 on a line, 2 in the plane."""
        return self.frame.shape[1]

    def proved(self, cell: Simple, sign: int, distance: float) -> bool:
        """Whether the cell is proved concave and taut at every displacement up to a distance."""
        if self.dimensions == 2:
            return concave_disc(cell, distance)
        start = 0.0 if self.one_way else -distance
        return concave_line(cell, sign * self.frame[:, 0], start, distance)


Does = Callable[[Floats], bool]

# Rings around the start for regions beyond a boundary: each half as wide as the next, the widest
# is the reach.
_DOUBLINGS = 9
_DIRECTIONS = 12
# Rings for regions that may be small, and steps along a line: number of equal steps to the reach.
_STEPS = {1: 200, 2: 20}
_HALVES = 6  # of the first step
# One more ring just beyond the nearest place tests whether another side is nearer.
_AROUND = 48
_BEYOND = 1.03
_SETTLED = 0.99  # a smaller reduction needs no further ring
_RESOLUTION = 1e-7  # m, where bisection stops
_SMALLEST_TURN = 1e-3  # of the ray, to either side
_TIE = 1e-9  # of the distance, rounding of two equal ones


def resolution(ways: Displacements, small: bool) -> str:
    """Resolution of `nearest_found`, in words."""
    fine = f"then bisection to {to_unit(_RESOLUTION, 'mm'):g} mm"
    if ways.dimensions == 2 and not small:
        return (
            f"evaluated at {_DIRECTIONS} places on each of {_DOUBLINGS + 1} rings, each twice as "
            f"wide as the one before, and at {_AROUND} around the nearest; changes between these "
            f"places are missed; {fine}"
        )
    pitch = ways.reach / _STEPS[ways.dimensions]
    where = "on rings" if ways.dimensions == 2 else "on the line"
    return (
        f"evaluated at places {where} every {to_unit(pitch, 'mm'):.3g} mm, closer near the start; "
        f"regions between these places are missed; {fine}"
    )


def nearest_found(
    does: Does,
    ways: Displacements,
    within: float,
    small: bool,
    progress: Progress = None,
    all_do: Callable[[Floats], Bools] | None = None,
) -> Floats | None:
    """The nearest u (n,) found with `does(u)`; None if there is none nearer than `within`.

    Rings around the start are evaluated, the narrowest first, and closer if the region may be
    small. From each arc of the first ring with hits, bisection leads back towards the start. In the
    plane the ray is then turned while that shortens it, and a ring of more places around the result
    tests other sides. `all_do` evaluates many displacements (m, n) at once, if that is faster.
    """

    def asked(ring: Floats) -> Bools:
        return np.array([does(u) for u in ring]) if all_do is None else all_do(ring)

    rings = [r for r in _rings(ways, small) if r[0] < within] + [(within, _AROUND)]
    total, done = sum(count for _, count in rings), 0
    best: Floats | None = None
    for number, (radius, count) in enumerate(rings):
        ring = _ring(ways, radius, count, number % 2)
        notify(progress, min(done, total), total)
        best = _nearest_behind(does, ring, asked(ring), None)
        done += len(ring)
        if best is not None:
            break
    while best is not None and ways.dimensions == 2:
        before = float(np.linalg.norm(best))
        ring = _ring(ways, min(_BEYOND * before, within), _AROUND, 0)
        best = _nearest_behind(does, ring, asked(ring), best)
        assert best is not None
        if float(np.linalg.norm(best)) > _SETTLED * before:
            break
    return best


def _rings(ways: Displacements, small: bool) -> list[tuple[float, int]]:
    """Radius [m] of every ring, narrowest first, and its number of places."""
    if ways.dimensions == 2 and not small:
        return [(ways.reach * 0.5**k, _DIRECTIONS) for k in range(_DOUBLINGS, -1, -1)]
    steps = _STEPS[ways.dimensions]
    pitch = ways.reach / steps
    close, far = range(_HALVES, 0, -1), range(1, steps + 1)
    rings = [(pitch * 0.5**k, _DIRECTIONS) for k in close]
    return rings + [(k * pitch, max(_DIRECTIONS, math.ceil(2 * math.pi * k))) for k in far]


def _ring(ways: Displacements, radius: float, count: int, turned: int) -> Floats:
    """(m, n) places at one distance; a turned ring has its places between those of the others."""
    if ways.dimensions == 1:
        return np.array([[radius]] if ways.one_way else [[radius], [-radius]])
    angle = 2 * math.pi / count * (np.arange(count) + 0.5 * turned)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _nearest_behind(does: Does, ring: Floats, hits: Bools, best: Floats | None) -> Floats | None:
    """The nearest place behind the hits of a ring, or `best` if that is nearer."""
    plane = ring.shape[1] == 2
    for arc in _arcs(hits) if plane else np.flatnonzero(hits)[:, None].tolist():
        u = ring[arc[len(arc) // 2]]
        if plane and best is not None and np.argmax(ring @ best) in arc:
            # The side of the best may run into another one that is nearer.
            length = float(np.linalg.norm(best)) - _RESOLUTION
            rays = [u * (length / np.linalg.norm(u)) for u in ring[arc]]
            shorter = [u for u in rays if length > 0 and does(u)]
            if not shorter:
                continue
            u = shorter[len(shorter) // 2]
        nearest = _shortest(does, u, len(ring)) if plane else _back(does, u, 0.0, _RESOLUTION)
        # Of sides that are equally near, as in a symmetric cell, the first of the ring is taken.
        if best is None or np.linalg.norm(nearest) < (1 - _TIE) * np.linalg.norm(best):
            best = nearest
    return best


def _arcs(hits: Bools) -> list[list[int]]:
    """Numbers of neighbouring hits around a ring, arc by arc."""
    around = np.roll(np.arange(len(hits)), -int(np.argmin(hits)))
    arcs = np.split(around, np.flatnonzero(np.diff(hits[around])) + 1)
    return [arc.tolist() for arc in arcs if hits[arc[0]]]


def _back(does: Does, u: Floats, low: float, resolution: float) -> Floats:
    """The first hit on the ray to u, beyond `low` [m]; u is a hit."""
    away = float(np.linalg.norm(u))
    along = u / away
    halvings = math.ceil(math.log2(max(1.0, (away - low) / resolution)))
    return bisected(lambda away: not does(away * along), low, away, halvings)[1] * along


def _shortest(does: Does, u: Floats, count: int) -> Floats:
    """The nearest place behind the hit u, one of `count` on a ring.

    The ray is turned to either side, by smaller and smaller steps, while that shortens it. The step
    gives the accuracy needed: turned by φ from the nearest place of a straight boundary, the ray is
    longer by the fraction φ²/2.
    """
    step = math.pi / count
    known = float(np.linalg.norm(u)) * step**2 / 4
    best = _back(does, u, 0.0, known)
    while True:
        away, heading = float(np.linalg.norm(best)), math.atan2(best[1], best[0])
        for angle in (heading - step, heading + step):
            u = (away - known) * np.array([math.cos(angle), math.sin(angle)])
            if away > known and does(u):
                best = _back(does, u, max(0.0, away * (1 - 2 * step)), known)
                break
        else:
            if step < _SMALLEST_TURN or away < _RESOLUTION:
                return best
            step /= 2
            finer = max(_RESOLUTION, away * step**2 / 4)
            best, known = _back(does, best, max(0.0, away - known), finer), finer
