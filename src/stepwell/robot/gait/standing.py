"""What each foot and each support carries while the robot stands."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.robot.parts import Robot

# Travel [m] over which the weight passes from foot to supports: nothing beside a travel, and yet a
# slope that the engine follows like any other.
HANDOVER = 1e-6

# Heights of the body that differ by less than this [m] are the same way to stand.
SAME = 1e-9


def feet_load(robot: Robot, travels: list[Floats]) -> Floats:
    """Force of the floor on each foot at rest (legs,) [N], by the lever rule.

    The body sinks as low as feet and supports let it: of all triangles of contacts round the
    centre of mass it rests on the one that holds it lowest down, and where several do, on all
    of them alike. A foot no deeper than the supports carries nothing.

    Args:
        robot: any robot.
        travels: for each leg (cells,) travels [m].
    """
    feet = feet_places(robot, travels)
    lift = np.array([robot.foot.depth(0.0) - robot.foot.depth(s[-1]) for s in travels])
    proud = np.maximum(robot.foot.below - lift, 0.0)
    stands = np.array([stands_proud(robot, travel) for travel in travels])
    supports = np.asarray(robot.body.supports, float)
    points = np.concatenate([feet, supports])
    height = np.concatenate([-proud, np.zeros(len(supports))])
    usable = np.concatenate([stands, np.ones(len(supports), bool)])
    own = robot.foot.mass * robot.floor.gravity
    weight, middle = _body_weight(robot, travels, np.where(stands, 0.0, -own))
    share = _shares(points, height, usable, middle)[: len(feet)]
    return np.where(stands, weight * share + own, 0.0)


def supports_load(robot: Robot, travels: list[Floats], feet: Floats) -> Floats:
    """Force of the floor on each support (supports,) [N] while the feet carry `feet` [N]."""
    supports = np.asarray(robot.body.supports, float)
    own = robot.foot.mass * robot.floor.gravity
    weight, middle = _body_weight(robot, travels, feet - own)
    if weight <= 0.0:
        return np.zeros(len(supports))
    every = np.ones(len(supports), bool)
    return weight * _shares(supports, np.zeros(len(supports)), every, middle)


def stands_proud(robot: Robot, travel: Floats) -> bool:
    """Whether a foot stands deeper than the supports, so that the body leans on it."""
    return bool(travel[-1] <= max(robot.foot.contact_travel - HANDOVER, 0.0))


def feet_places(robot: Robot, travels: list[Floats]) -> Floats:
    """(legs, 2) of the feet in the body's frame [m]."""
    # A tip hangs midway between the block before the outermost one and that one.
    back = [travel[:-1].sum() + travel[-1] / 2 for travel in travels]
    return np.array([leg.at for leg in robot.legs]) - np.stack([back, np.zeros(len(back))], axis=1)


def _body_weight(robot: Robot, travels: list[Floats], lifted: Floats) -> tuple[float, Floats]:
    """What feet that lift the body by these forces (legs,) [N] leave of its weight, and where.

    Returns:
        Force [N], and (x, y) of the point [m] on which it acts.
    """
    mass, centre = _without_feet(robot, travels)
    whole = mass * robot.floor.gravity
    weight = whole - float(lifted.sum())
    if weight <= 0.0:
        return 0.0, centre
    return weight, (whole * centre - lifted @ feet_places(robot, travels)) / weight


def _without_feet(robot: Robot, travels: list[Floats]) -> tuple[float, Floats]:
    """Mass [kg] and (x, y) of the centre of mass [m] of all but the feet."""
    parts = [(robot.body.mass, robot.body.centre[0], robot.body.centre[1])]
    half = robot.foot.span / 2
    for leg, travel in zip(robot.legs, travels, strict=True):
        x, y = leg.at
        for i in range(len(travel) - 1):
            ahead = sum(robot.blocks.length for _ in range(i + 1, len(travel) - 1))
            parts.append((robot.blocks.mass, x + half + ahead - travel[: i + 1].sum(), y))
        parts.append((robot.blocks.mass, x - half - travel.sum(), y))
    last = float(np.mean([leg.at[0] for leg in robot.legs])) - half
    stroke = float(np.mean([travel.sum() for travel in travels]))
    across = float(np.mean([leg.at[1] for leg in robot.legs]))
    parts.append((robot.blocks.carriage, last - stroke, across))
    for antenna in robot.antennas:
        x, y = antenna.pivot
        reach = antenna.length / 2
        tip = (x + reach * np.cos(antenna.angle), y + reach * np.sin(antenna.angle))
        parts.append((antenna.mass, *tip))
    table = np.array(parts)
    mass = float(table[:, 0].sum())
    return mass, table[:, 0] @ table[:, 1:] / mass


def _shares(points: Floats, height: Floats, usable: Bools, middle: Floats) -> Floats:
    """(points,) share of the weight on each, 0 .. 1."""
    found: list[tuple[float, float, tuple[int, ...], Floats]] = []
    for three in combinations(np.flatnonzero(usable).tolist(), 3):
        corners = np.vstack([points[list(three)].T, np.ones(3)])
        if abs(np.linalg.det(corners)) < 1e-12:
            continue
        weights = np.asarray(np.linalg.solve(corners, np.append(middle, 1.0)), float)
        outside = float(np.maximum(-weights, 0.0).sum())
        found.append((outside, float(weights @ height[list(three)]), three, weights))
    out = np.zeros(len(points))
    # On an edge, rounding decides the side; outside of all, the nearest triangle carries.
    least = max(1e-9, min(outside for outside, _, _, _ in found) + 1e-9)
    found = [one for one in found if one[0] <= least]
    lowest = min(value for _, value, _, _ in found)
    for _, value, three, weights in found:
        if value < lowest + SAME:
            out[list(three)] += np.maximum(weights, 0.0)
    return out / out.sum()
