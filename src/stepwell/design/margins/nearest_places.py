"""The nearest displacement of an anchor at which its cell meets conditions on F0 and F1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.concave import Simple, end_force, sift
from stepwell.design.margins.displacements import Ways

Floats = NDArray[np.float64]

_LEVELS = 17
# The boxes are small enough where this many of them fit into the distance; how many are looked
# at more closely.
_FINE = 256
_CLOSER = 64
_ROUNDING = 1e-12  # of k r
_NUDGE = 1e-5  # of r, for the curvature


class Condition(NamedTuple):
    """What an end force of the moved cell has to be."""

    side: int  # -1 for F0, +1 for F1
    force: float  # [N]
    up: int  # +1 where it has to be above, -1 where it has to be below


@dataclass(frozen=True, eq=False)
class Place:
    """A displacement on the rim of the region in which the conditions are met.

    Attributes:
        u: (n,) in the coordinates of the ways [m].
        distance: its length [m].
        inward: (n,) unit vector that leads into the region.
    """

    u: Floats
    distance: float
    inward: Floats


def nearest_places(
    cell: Simple, conditions: Sequence[Condition], ways: Ways, sign: int
) -> list[Place]:
    """Candidates for the nearest displacement that meets all conditions, nearest first.

    Boxes are thrown out where a bound on the slope of F proves that they hold no such
    displacement, or none nearer than one already met; what is left is halved. In the few small
    boxes that remain the nearest point lies on one curve F = force, squarely to the
    displacement, or where two of them meet: Newton's method does the last bit.

    Args:
        cell: as it is; the forces are those of the closed form.
        conditions: one or more.
        ways: where the anchor may go.
        sign: +1 where the anchor is q, -1 where it is p.

    Returns:
        Places on the rim; empty where there is none within reach.
    """
    frame = sign * ways.frame
    boxes, half = _sifted(cell, conditions, ways, frame)
    # One box for every few that lie together.
    _, first = np.unique(np.floor(boxes / (8 * half)), axis=0, return_index=True)
    starts = boxes[np.sort(first)]
    starts = starts[np.argsort(np.linalg.norm(starts, axis=1), kind="stable")][:_CLOSER]
    found: list[Place] = []
    # F0 has one value at a time, so two of its conditions never bind together; likewise F1.
    together = [c for c in combinations(conditions, 2) if c[0].side != c[1].side]
    active: list[tuple[Condition, ...]] = [(c,) for c in conditions]
    if ways.dimensions == 2:
        active += together
    for start in starts:
        for binding in active:
            place = _settled(cell, binding, frame, start)
            if place is not None and _meets(cell, conditions, ways, frame, place):
                found.append(place)
    return sorted(found, key=lambda place: place.distance)


def _sifted(
    cell: Simple, conditions: Sequence[Condition], ways: Ways, frame: Floats
) -> tuple[Floats, float]:
    """Boxes (m, n) that may hold the nearest displacement, and half their side [m]."""
    side = np.array([c.side for c in conditions], np.int64)
    force = np.array([c.force for c in conditions], float)
    up = np.array([c.up for c in conditions], np.int64)
    middle, half = ways.box
    n = ways.dimensions
    boxes, best = middle[None], ways.reach
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * n), axis=-1).reshape(-1, n)
    for level in range(_LEVELS):
        if level > 0:
            boxes = (boxes[:, None] + half * corners).reshape(-1, n)
            half /= 2
        boxes = boxes[_near(boxes, half) <= best]
        held, inside = np.empty(len(boxes), np.bool_), np.empty(len(boxes), np.bool_)
        d = np.array([cell.dx, cell.dy]) + boxes @ frame.T
        sift(cell, d, math.sqrt(n) * half, side, force, up, held, inside)
        best = min(best, float(np.min(np.linalg.norm(boxes[inside], axis=1), initial=math.inf)))
        boxes = boxes[held]
        boxes = boxes[_near(boxes, half) <= best]
        if len(boxes) == 0 or _FINE * half < best:
            break
    return boxes, half


def _near(boxes: Floats, half: float) -> Floats:
    """Smallest distance [m] from the origin to each box."""
    return np.linalg.norm(np.maximum(np.abs(boxes) - half, 0.0), axis=1)


def _settled(
    cell: Simple, binding: tuple[Condition, ...], frame: Floats, start: Floats
) -> Place | None:
    """The shortest u near `start` with all binding forces met, by Newton's method.

    Solves u = Σ λ ∂F/∂u and F = force together; with as many forces as coordinates only the
    second matters.
    """
    n, m = frame.shape[1], len(binding)
    u = start.copy()
    gap, slope = _looked(cell, binding, frame, u)
    multiplier = np.linalg.lstsq(slope.T, u, rcond=None)[0]
    for _ in range(40):
        bend = np.zeros((n, n))
        for i in range(n):
            nudge = np.zeros(n)
            nudge[i] = _NUDGE * cell.lever
            _, beyond = _looked(cell, binding, frame, u + nudge)
            _, before = _looked(cell, binding, frame, u - nudge)
            bend[i] = multiplier @ (beyond - before) / (2 * nudge[i])
        matrix = np.block([[np.eye(n) - bend, -slope.T], [slope, np.zeros((m, m))]])
        miss = np.concatenate([u - slope.T @ multiplier, gap])
        try:
            step = np.linalg.solve(matrix, -miss)
        except np.linalg.LinAlgError:
            return None
        u, multiplier = u + step[:n], multiplier + step[n:]
        if not np.all(np.abs(u) < 1e3 * cell.lever):
            return None
        gap, slope = _looked(cell, binding, frame, u)
        if np.max(np.abs(step[:n])) <= 1e-14 * cell.lever:
            break
    else:
        return None
    inward = np.zeros(n)
    for condition, along in zip(binding, slope, strict=True):
        inward += condition.up * along / np.linalg.norm(along)
    length = float(np.linalg.norm(inward))
    if length == 0:
        return None
    return Place(u, float(np.linalg.norm(u)), inward / length)


def _looked(
    cell: Simple, binding: tuple[Condition, ...], frame: Floats, u: Floats
) -> tuple[Floats, Floats]:
    """(F - force)/k [m] and its slope by u, (m,) and (m, n)."""
    dx, dy = np.array([cell.dx, cell.dy]) + frame @ u
    looks = np.array([end_force(cell, c.side, dx, dy) for c in binding])
    gap = looks[:, 0] - np.array([c.force for c in binding])
    return gap / cell.stiffness, looks[:, 1:] @ frame / cell.stiffness


def _meets(
    cell: Simple, conditions: Sequence[Condition], ways: Ways, frame: Floats, place: Place
) -> bool:
    if place.distance > ways.reach or (ways.one_way and place.u[0] < 0):
        return False
    dx, dy = np.array([cell.dx, cell.dy]) + frame @ place.u
    most = _ROUNDING * cell.stiffness * cell.lever
    return all(c.up * (c.force - end_force(cell, c.side, dx, dy)[0]) <= most for c in conditions)
