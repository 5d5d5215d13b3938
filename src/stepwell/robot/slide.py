"""Sliding of a robot on the floor over its moving feet, by least dissipation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats
from stepwell.robot.leg_cycles import LegCycle
from stepwell.robot.robot import Robot
from stepwell.robot.stance import feet_places, supports_load, touch

STEPS = 320  # of loading, and of unloading
NONE = 1e-5  # slides shorter than this fraction of a step count as none
ITERATIONS = 60


@dataclass(frozen=True)
class Slide:
    """A cycle on the floor, in n steps of the stroke, loading and then unloading."""

    twist: Floats  # (n, 3) forward, to the left [m], turn to the left [rad], in the body's frame
    push: Floats  # (n, legs) backward travel of each foot in stance under the body [m]
    gain: Floats  # (n, legs) advance of the body at each foot in stance [m]
    slip: Floats  # (n, legs) sliding distance of each foot in stance [m]
    load: Floats  # (n, legs) ground reaction force of each foot [N]

    def displacement(self) -> tuple[float, float, float]:
        """Displacement forward and to the left [m], and turn to the left [rad], of the cycle."""
        along, across, turn = self.twist.T
        yaw = np.cumsum(turn)
        ahead, aside = np.cos(yaw - turn / 2), np.sin(yaw - turn / 2)
        x, y = along @ ahead - across @ aside, along @ aside + across @ ahead
        return float(x), float(y), float(yaw[-1])


def slide(robot: Robot, cycles: Sequence[LegCycle]) -> Slide:
    """Motion of the body on the floor for given cycles of the legs.

    At every step the body makes the small motion with the least dissipation by friction under feet
    and supports. That is Coulomb's friction without inertia: feet stick where sliding would cost
    more.
    """
    edge, supports = touch(robot), np.asarray(robot.body.supports, float)
    halves: list[tuple[Floats, ...]] = []
    for half in (0, 1):
        ways = [cycle.halves[half] for cycle in cycles]
        begin, end = ways[0].stroke[[0, -1]]
        stroke = np.linspace(min(begin, end), max(begin, end), STEPS + 1)[:: -1 if half else 1]
        followed = [way.at(stroke)[0] for way in ways]
        middles, loads = zip(*(way.at((stroke[1:] + stroke[:-1]) / 2) for way in ways), strict=True)
        load = np.stack(loads, axis=1)
        back = -np.diff(feet_places(robot, followed)[..., 0], axis=0)
        # The fraction of a step in which each foot is in contact.
        last = np.stack([travel[:, -1] for travel in followed], axis=1)
        low, high = np.minimum(last[1:], last[:-1]), np.maximum(last[1:], last[:-1])
        part = np.where(high <= edge, 1.0, (edge - low) / np.where(high > low, high - low, 1.0))
        push = np.where((load > 0.0) & (low < edge), back * part, 0.0)
        held = supports_load(robot, middles, load)
        rubs = np.hstack([robot.floor.foot_friction * load, robot.support_friction * held])
        moves = np.hstack([-push, np.zeros_like(held)])
        standing = np.broadcast_to(supports, (STEPS, *supports.shape))
        points = np.concatenate([feet_places(robot, middles), standing], axis=1)
        halves.append((points, rubs, moves, push, load))
    points, rubs, moves, push, load = map(np.concatenate, zip(*halves, strict=True))
    twist, slid = _least(points, rubs, moves)
    across = np.array([leg.at[1] for leg in robot.legs])
    gain = np.where(load > 0.0, twist[:, :1] - twist[:, 2:] * across, 0.0)
    return Slide(twist, push, gain, np.where(load > 0.0, slid[:, : len(cycles)], 0.0), load)


def _least(points: Floats, rubs: Floats, moves: Floats) -> tuple[Floats, Floats]:
    """Twists (n, 3) that minimise Σ rub |velocity over the floor|, and those speeds (n, k)."""
    n, k, _ = points.shape
    # Velocity of a contact: (x, y) of the twist, turned about the origin, plus its own motion.
    maps = np.zeros((n, k, 2, 3))
    maps[..., 0, 0] = maps[..., 1, 1] = 1.0
    maps[..., 0, 2], maps[..., 1, 2] = -points[..., 1], points[..., 0]
    own = np.zeros((n, k, 2))
    own[..., 0] = moves
    floor = NONE * max(float(np.abs(moves).max(initial=0.0)), 1e-9)
    # Reweighted least squares: each square over the last size converges to the sum of sizes.
    speed = np.ones((n, k))
    twist = np.zeros((n, 3))
    scale = np.diag([1.0, 1.0, 1e-4]) * 1e-12
    for _ in range(ITERATIONS):
        weight = rubs / np.maximum(speed, floor)
        left = np.einsum("nk,nkij,nkil->njl", weight, maps, maps)
        right = -np.einsum("nk,nkij,nki->nj", weight, maps, own)
        size = np.trace(left, axis1=1, axis2=2)[:, None, None]
        twist = np.linalg.solve(left + scale * np.maximum(size, 1e-30), right[..., None])[..., 0]
        speed = np.linalg.norm(np.einsum("nkij,nj->nki", maps, twist) + own, axis=2)
    return twist, np.where(speed > 10 * floor, speed, 0.0)
