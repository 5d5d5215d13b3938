"""How a robot slides on the floor while its feet move under it: least dissipation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats
from stepwell.robot.robot import Robot
from stepwell.robot.rounds import Round
from stepwell.robot.stance import feet_places, supports_load, touch

STEPS = 320  # into which each way, out and back, is cut
# Slides shorter than this share of a step count as none.
NONE = 1e-5
ROUNDS = 60


@dataclass(frozen=True)
class Slide:
    """A cycle on the floor, in steps of the stroke, out and then back. n steps.

    Attributes:
        twist: (n, 3) forward, to the left [m] and rotation to the left [rad], each step in the
            frame of the body at its start.
        push: (n, legs) how far each standing foot goes back under the body [m].
        gain: (n, legs) how far the body goes forward over each standing foot's place [m].
        slip: (n, legs) how far each standing foot slides on the floor [m].
        load: (n, legs) force of the floor on each foot [N].
    """

    twist: Floats
    push: Floats
    gain: Floats
    slip: Floats
    load: Floats

    def displacement(self) -> tuple[float, float, float]:
        """Forward, to the left [m] and to the left [rad], from the start of the cycle."""
        x = y = yaw = 0.0
        for along, across, turn in self.twist:
            middle = yaw + turn / 2
            x += along * np.cos(middle) - across * np.sin(middle)
            y += along * np.sin(middle) + across * np.cos(middle)
            yaw += turn
        return float(x), float(y), float(yaw)


def slide(robot: Robot, rounds: Sequence[Round]) -> Slide:
    """What the legs' motion does to the body on the floor.

    At every step the body takes, of all small motions, the one in which friction under feet
    and supports takes least: that is Coulomb's friction without inertia, with feet that stick
    where that costs less than dragging them.

    Args:
        robot, rounds: the robot, and the round of each of its legs.
    """
    edge = touch(robot)
    rows: list[tuple[Floats, ...]] = []
    supports = np.asarray(robot.body.supports, float)
    for half in (0, 1):
        ways = [one.halves[half] for one in rounds]
        begin, end = ways[0].stroke[[0, -1]]
        stroke = np.linspace(min(begin, end), max(begin, end), STEPS + 1)[:: -1 if half else 1]
        followed = [way.at(stroke) for way in ways]
        middles = [way.at((stroke[1:] + stroke[:-1]) / 2) for way in ways]
        for k in range(STEPS):
            before, after = ([s[j] for s, _ in followed] for j in (k, k + 1))
            middle = [s[k] for s, _ in middles]
            load = np.array([carried[k] for _, carried in middles])
            back = feet_places(robot, before)[:, 0] - feet_places(robot, after)[:, 0]
            inside = [
                _standing_share(a[-1], b[-1], edge) for a, b in zip(before, after, strict=True)
            ]
            push = np.where(load > 0.0, back * np.array(inside), 0.0)
            held = supports_load(robot, middle, load)
            grip = robot.floor.foot_friction * load
            rubs = np.concatenate([grip, robot.support_friction * held])
            moves = np.concatenate([-push, np.zeros(len(held))])
            points = np.concatenate([feet_places(robot, middle), supports])
            rows.append((points, rubs, moves, push, load))
    points, rubs, moves, push, load = map(np.array, zip(*rows, strict=True))
    twist, slid = _least(points, rubs, moves)
    across = np.array([leg.at[1] for leg in robot.legs])
    gain = np.where(load > 0.0, twist[:, :1] - twist[:, 2:] * across, 0.0)
    return Slide(twist, push, gain, np.where(load > 0.0, slid[:, : len(rounds)], 0.0), load)


def _standing_share(a: float, b: float, edge: float) -> float:
    """Share of a step from travel a to b of the last cell [m] in which the foot touches."""
    if min(a, b) >= edge:
        return 0.0
    return 1.0 if max(a, b) <= edge else (edge - min(a, b)) / abs(b - a)


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
    # Reweighted least squares: each term over its last size is the sum of sizes in the end.
    speed = np.ones((n, k))
    twist = np.zeros((n, 3))
    scale = np.diag([1.0, 1.0, 1e-4]) * 1e-12
    for _ in range(ROUNDS):
        weight = rubs / np.maximum(speed, floor)
        left = np.einsum("nk,nkij,nkil->njl", weight, maps, maps)
        right = -np.einsum("nk,nkij,nki->nj", weight, maps, own)
        size = np.trace(left, axis1=1, axis2=2)[:, None, None]
        twist = np.linalg.solve(left + scale * np.maximum(size, 1e-30), right[..., None])[..., 0]
        speed = np.linalg.norm(np.einsum("nkij,nj->nki", maps, twist) + own, axis=2)
    return twist, np.where(speed > 10 * floor, speed, 0.0)
