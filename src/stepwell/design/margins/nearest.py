"""The nearest displacement of one anchor that changes the sequence of a chain."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Ints, Progress, Vec2
from stepwell.concave import Neighbour, Simple, SortedChain, end_force, steepest
from stepwell.design.margins.search import Displacements, nearest_found
from stepwell.design.parameters import Parameter
from stepwell.design.plane import Method
from stepwell.design.switches import relay_cycle
from stepwell.kernels import entry, leaf, record
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle, cycles_of
from stepwell.statics import StaticsError, nominal

# A box is small enough for Newton's method where this many of its halves fit into the distance.
_FINE = 64.0
_DEEPEST = 60  # halvings
_STEPS = 40
_ROUNDING = 1e-12  # of k r
_NEARER = 1.0 - 1e-13  # smaller differences are rounding
_NUDGE = 1e-5  # of r, for the curvature


class Place(NamedTuple):
    """A displacement on the rim of the region that meets the conditions."""

    move: Floats  # (2,) of the anchor [m]
    distance: float  # its length [m]
    inward: Floats  # (2,) unit vector into the region


def nearest_place(
    cell: Simple, conditions: list[Neighbour], ways: Displacements, sign: int, within: float
) -> Place | None:
    """The nearest displacement within [m] that meets all conditions, to rounding; None for none.

    A bound on the slope of F excludes boxes of displacements without such a place, or without one
    nearer than the best one. The remaining boxes are halved, nearest first. In a small box the
    nearest place lies on one curve F = force, perpendicular to the displacement, or where two of
    them meet; Newton's method locates it. `sign` is +1 for anchor q, -1 for p: d = q - p.
    """
    axes = (sign * ways.frame).tobytes()
    distance, out = _kept(cell, tuple(conditions), axes, ways.one_way, float(within))
    return None if math.isinf(distance) else Place(sign * out[:2], distance, sign * out[2:])


# While one cell is edited, the searches of most others stay the same.
@lru_cache(maxsize=1024)
def _kept(
    cell: Simple, conditions: tuple[Neighbour, ...], axes: bytes, one_way: bool, within: float
) -> tuple[float, Floats]:
    """The result of `_nearest`."""
    out = np.empty(4)
    search = _Search(
        np.array([c.side for c in conditions], np.int64),
        np.array([c.other for c in conditions], float),
        np.array([c.up for c in conditions], np.int64),
        np.frombuffer(axes).reshape(2, -1).copy(),
        one_way,
        within,
    )
    distance = _nearest(cell, search, out)
    out.setflags(write=False)
    return distance, out


@record
class _Search(NamedTuple):
    side: Ints  # (m,) 0 for F0, 1 for F1
    force: Floats  # (m,) [N]
    up: Ints  # (m,) +1 to be above it, -1 below
    frame: Floats  # (2, n) axes of the displacements
    one_way: bool  # not against the first axis
    within: float  # [m]


@entry(1e-3, "search.side")
def _nearest(cell: Simple, search: _Search, out: Floats) -> float:
    """Distance [m] of the nearest d-displacement, (x, y) of it and inwards of it in out (4,)."""
    frame, within = search.frame, search.within
    n = frame.shape[1]
    best = np.inf
    # The origin is tested separately, since boxes around it would shrink without end.
    if _settled(cell, search, 0.0, 0.0, out):
        best = math.sqrt(out[0] * out[0] + out[1] * out[1])
    known = min(best, within)
    boxes = np.empty((3 * _DEEPEST + 4, 3))
    boxes[0] = 0.0, 0.0, within
    if search.one_way:
        boxes[0, 0], boxes[0, 2] = 0.5 * within, 0.5 * within
    waiting = 1
    while waiting > 0:
        waiting -= 1
        u, v, half = boxes[waiting]
        near_u, near_v = max(abs(u) - half, 0.0), max(abs(v) - half, 0.0) if n == 2 else 0.0
        if not math.sqrt(near_u * near_u + near_v * near_v) < known:
            continue
        x, y = frame[0, 0] * u, frame[1, 0] * u
        if n == 2:
            x += frame[0, 1] * v
            y += frame[1, 1] * v
        radius = math.sqrt(n) * half
        held, inside = _holds(cell, search, x, y, radius)
        if not held:
            continue
        away = math.sqrt(u * u + v * v)
        if inside and away < known:
            known = away
        if _FINE * half < known or half <= within * 0.5**_DEEPEST:
            place = np.empty(4)
            if _settled(cell, search, x, y, place):
                away = math.sqrt(place[0] * place[0] + place[1] * place[1])
                if away < best * _NEARER:
                    best = away
                    known = min(known, best)
                    out[:] = place
            continue
        waiting = _halve(boxes, waiting, u, v, half, n)
    return best


@leaf
def _halve(boxes, waiting: int, u: float, v: float, half: float, n: int) -> int:
    """Push the halves of a box in n directions on the stack; returns the new size."""
    # Halves away from the origin lie below those towards it.
    to_u, to_v = -math.copysign(0.5 * half, u), -math.copysign(0.5 * half, v)
    for i in range(4 if n == 2 else 2):
        boxes[waiting, 0] = u + (to_u if i % 2 else -to_u)
        boxes[waiting, 1] = (v + (to_v if i > 1 else -to_v)) if n == 2 else 0.0
        boxes[waiting, 2] = 0.5 * half
        waiting += 1
    return waiting


@leaf
def _holds(cell: Simple, search: _Search, x: float, y: float, radius: float) -> tuple[bool, bool]:
    """Whether a disc may contain a place that meets all conditions, and whether its middle does."""
    side, force, up = search.side, search.force, search.up
    held, inside = True, True
    for k in range(len(side)):
        value, _, _ = end_force(cell, side[k], cell.dx + x, cell.dy + y)
        lack = up[k] * (force[k] - value)
        inside = inside and lack < 0.0
        if lack > 0.0:
            bound = steepest(cell, side[k], cell.dx + x, cell.dy + y, radius)
            held = held and lack <= radius * bound
    return held, inside


@leaf
def _settled(cell: Simple, search: _Search, x: float, y: float, out: Floats) -> bool:
    """Fill out (4,) with the nearest place by Newton's method from (x, y)."""
    side, frame = search.side, search.frame
    best = np.inf
    for i in range(len(side)):
        # F0 has one value at a time, so two of its conditions never bind together; likewise F1.
        # Where two conditions bind, the way in lies between them, so pairs come before single ones.
        for j in range(len(side) - 1, i - 1, -1):
            if j > i and (side[i] == side[j] or frame.shape[1] == 1):
                continue
            is_met, at_x, at_y = _meeting_place(cell, search, i, j, x, y)
            away = math.sqrt(at_x * at_x + at_y * at_y)
            if not is_met or not away < best * _NEARER or away > search.within:
                continue
            if search.one_way and frame[0, 0] * at_x + frame[1, 0] * at_y < 0.0:
                continue
            meets, in_x, in_y = _inward(cell, search, i, j, at_x, at_y)
            length = math.sqrt(in_x * in_x + in_y * in_y)
            if meets and length > 0.0:
                best = away
                out[0], out[1], out[2], out[3] = at_x, at_y, in_x / length, in_y / length
    return best < np.inf


@leaf
def _inward(
    cell: Simple, search: _Search, i: int, j: int, x: float, y: float
) -> tuple[bool, float, float]:
    """Whether all conditions are met at (x, y), and the way in from the curves of i and j."""
    side, force, up, frame = search.side, search.force, search.up, search.frame
    in_x, in_y = 0.0, 0.0
    meets = True
    for k in range(len(side)):
        value, fx, fy = end_force(cell, side[k], cell.dx + x, cell.dy + y)
        most = _ROUNDING * cell.stiffness * cell.lever
        meets = meets and up[k] * (force[k] - value) <= most
        if k in (i, j):
            if frame.shape[1] == 1:
                along = fx * frame[0, 0] + fy * frame[1, 0]
                fx, fy = along * frame[0, 0], along * frame[1, 0]
            steep = math.sqrt(fx * fx + fy * fy)
            in_x += up[k] * fx / steep
            in_y += up[k] * fy / steep
    return meets, in_x, in_y


@leaf
def _meeting_place(
    cell: Simple, search: _Search, i: int, j: int, x: float, y: float
) -> tuple[bool, float, float]:
    """The shortest displacement near (x, y) that gives one critical force, or two at once.

    Two equations: F_i = force, and F_j = force. Without another j, the displacement is
    perpendicular to the curve, or stays on the line.
    """
    side, force, frame, r = search.side, search.force, search.frame, cell.lever
    for _ in range(_STEPS):
        value, fx, fy = end_force(cell, side[i], cell.dx + x, cell.dy + y)
        first = value - force[i]
        if j != i:
            value, gx, gy = end_force(cell, side[j], cell.dx + x, cell.dy + y)
            second = value - force[j]
        elif frame.shape[1] == 1:
            gx, gy = -frame[1, 0], frame[0, 0]
            second = gx * x + gy * y
        else:
            second = x * fy - y * fx
            h = _NUDGE * r
            _, ax, ay = end_force(cell, side[i], cell.dx + x + h, cell.dy + y)
            _, bx, by = end_force(cell, side[i], cell.dx + x - h, cell.dy + y)
            _, cx, cy = end_force(cell, side[i], cell.dx + x, cell.dy + y + h)
            _, ex, ey = end_force(cell, side[i], cell.dx + x, cell.dy + y - h)
            gx = fy + (x * (ay - by) - y * (ax - bx)) / (2.0 * h)
            gy = -fx + (x * (cy - ey) - y * (cx - ex)) / (2.0 * h)
        turn = fx * gy - fy * gx
        if turn == 0.0:
            return False, x, y
        step_x, step_y = (second * fy - first * gy) / turn, (first * gx - second * fx) / turn
        x += step_x
        y += step_y
        # Written so that a NaN fails it.
        if not (abs(x) < 1e3 * r and abs(y) < 1e3 * r):
            return False, x, y
        if max(abs(step_x), abs(step_y)) <= 1e-14 * r:
            return True, x, y
    return False, x, y


# Additional displacement beyond a change [m]: large enough to avoid a tie, small enough that
# nothing else changes. The smaller ones are for narrower regions.
_PAST = (1e-8, 1e-9, 1e-10)


class Nearest(NamedTuple):
    """The nearest displacement, and a slightly larger one."""

    distance: float  # its length [m]; infinite if none is within reach
    move: Vec2  # (dx, dy) of the anchor [m]; NaN for none
    past: Vec2  # where the chain reaches the target
    method: Method


def sequence(chain: Chain) -> Sequence:
    """Sequence of the chain, in closed form if it holds, else by the general engine."""
    forces = SortedChain.of(chain)
    if forces is None:
        relays = relay_cycle(chain)
        return cycle(chain).sequence if relays is None else Sequence.parse(relays)
    return Sequence.full_cycle(forces.loading, forces.unloading)


@dataclass(frozen=True, eq=False)
class Aim:
    """The target of a displacement of an anchor."""

    chain: Chain
    now: Sequence  # of the nominal chain
    anchor: Parameter
    target: Sequence | None  # None for any other than now

    def is_met(self, done: Sequence) -> bool:
        """Whether a sequence is the target."""
        return done != self.now if self.target is None else done == self.target

    def is_met_at(self, move: Floats) -> bool:
        """Whether the chain with its anchor displaced by (2,) [m] reaches the target."""
        # A design that cannot be built or simulated misses it.
        try:
            return self.is_met(sequence(self.anchor.displaced(self.chain, move)))
        except (ValueError, StaticsError):
            return False

    def is_met_untied(self, move: Floats) -> bool:
        """The same without a tie: at a tie, friction may decide otherwise."""
        return (
            self.is_met_at(move) and not cycle(self.anchor.displaced(self.chain, move)).degenerate
        )

    def is_met_at_each(self, moves: Floats) -> Bools:
        """The same for (m, 2) displacements [m] at once, if that is possible."""
        anchor, chain = self.anchor, self.chain
        designs = nominal(chain, len(moves))
        assert designs is not None
        anchor.put(designs, chain, np.array(anchor.value(chain)) + moves)
        cycles = cycles_of(lambda i: anchor.displaced(chain, moves[i]), len(moves), designs)
        # A design without a number misses the target.
        return np.array([*map(self.is_met, cycles.sequences), False])[np.maximum(cycles.number, -1)]


def nearest(
    aim: Aim, forces: SortedChain | None, ways: Displacements, progress: Progress = None
) -> Nearest:
    """The nearest displacement of an anchor with which the chain reaches the target.

    In closed form if the cells are proved concave for every displacement up to it; otherwise the
    result of the closed form is checked, and a nearer one is searched.
    """
    known, past, proved = None, None, False
    if forces is not None:
        known, proved = _in_closed_form(forces, aim.anchor, aim.target, ways)
    if known is not None:
        # If any other sequence counts, the closed form is a sufficient proof.
        sure = proved and aim.target is None
        past = next((at for at in _just_past(known) if sure or aim.is_met_at(at)), None)
    if not proved:
        within = ways.reach if known is None or past is None else known.distance
        displacement = _nearest_searched(aim, forces is None, ways, within, progress)
        if displacement is not None and float(np.linalg.norm(displacement)) < within:
            at, far = ways.frame @ displacement, float(np.linalg.norm(displacement))
            places = [at, *_just_past(Place(at, far, at / far))] if far else [at]
            past = next(filter(aim.is_met_untied, places), at)
            return Nearest(far, _vec(at), _vec(past), Method.SEARCH)
    return _assembled(known, past, Method.EXACT if proved else Method.SEARCH)


def _nearest_searched(
    aim: Aim, follow: bool, ways: Displacements, within: float, progress: Progress
) -> Floats | None:
    """The nearest displacement found by a search, which follows many designs at once."""
    at_once = follow and not aim.chain.elements and nominal(aim.chain, 0) is not None
    return nearest_found(
        lambda u: aim.is_met_at(ways.frame @ u),
        ways,
        within,
        aim.target is not None,
        progress,
        (lambda us: aim.is_met_at_each(us @ ways.frame.T)) if at_once else None,
    )


# As for `_kept`: a cell whose neighbours in force stay keeps its result.
@lru_cache(maxsize=1024)
def nearest_proved(
    cell: Simple, neighbours: tuple[Neighbour, ...], alone: bool, reach: float
) -> Nearest | None:
    """The nearest displacement of anchor q within reach [m] that changes the sequence.

    None if no closed form proves it; `alone` is whether the chain has no other cell.
    """
    ways = Displacements.of(None, False, reach)
    known, proved = _best(cell, [[one] for one in neighbours], ways, 1, alone)
    return _assembled(known, known and _just_past(known)[0], Method.EXACT) if proved else None


def _assembled(known: Place | None, past: Floats | None, method: Method) -> Nearest:
    if known is None or past is None:
        return Nearest(math.inf, (math.nan, math.nan), (math.nan, math.nan), method)
    return Nearest(known.distance, _vec(known.move), _vec(past), method)


def _just_past(known: Place) -> list[Floats]:
    return [known.move + far * known.inward for far in _PAST]


def _vec(move: Floats) -> Vec2:
    x, y = move.tolist()
    return x, y


def _in_closed_form(
    forces: SortedChain, anchor: Parameter, target: Sequence | None, ways: Displacements
) -> tuple[Place | None, bool]:
    """The nearest place, and whether the cell is proved concave all the way there."""
    assert anchor.cell is not None
    cell, sign = anchor.cell, 1 if anchor.part == "q" else -1
    regions = _regions(forces, cell, target)
    return _best(forces.cells[cell], regions, ways, sign, len(forces.cells) == 1)


def _best(
    cell: Simple, regions: list[list[Neighbour]], ways: Displacements, sign: int, alone: bool
) -> tuple[Place | None, bool]:
    """The nearest place in any of the regions of a cell, which may be `alone` in its chain."""
    best, far = None, ways.reach
    for conditions in regions:
        place = nearest_place(cell, conditions, ways, sign, far)
        if place is not None and (best is None or place.distance < far):
            best, far = place, place.distance
    # A single cell follows the actuator at any force.
    return best, alone or ways.proved(cell, sign, far)


def _regions(forces: SortedChain, cell: int, target: Sequence | None) -> list[list[Neighbour]]:
    """Conditions on the moved cell; the target is reached where all of one list hold."""
    if target is None:
        return [[neighbour] for neighbour in forces.neighbours(cell)]
    orders = target.orders
    if orders is None:
        return []
    for order, now in zip(orders, (forces.loading, forces.unloading), strict=True):
        if [i for i in order if i != cell] != [i for i in now if i != cell]:
            return []  # the order of the other cells is not that of the target
    # It must stay on its side of its neighbours in the target orders.
    return [[n._replace(up=-n.up) for n in forces.neighbours(cell, orders)]]
