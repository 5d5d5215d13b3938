"""Closed form of the gaits of a robot with two legs of two cells: which cell moves first."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.mechanism import Law, geometry, value
from stepwell.robot.robot import Robot
from stepwell.robot.stance import Leaning, Stance, touch

# Angles between the stops at which forces must fall, and at which a band must return an anchor.
_LOOKS = 33


class Bands(NamedTuple):
    """Equal bands on cells: arrays that broadcast, of any shape."""

    dx: Any  # x of q - p [m]
    dy: Any  # y of q - p [m]
    stiffness: Any  # of all bands of a cell together [N/m]
    rest: Any  # rest length [m]
    law: Law  # common to all

    def displaced(self, x: Any, y: Any) -> Bands:
        """The same bands with the anchor p displaced by (x, y) [m]."""
        return self._replace(dx=self.dx - x, dy=self.dy - y)

    def tension(self, length: Any) -> Floats:
        """Tension [N] at lengths [m]; zero where slack."""
        extension = np.asarray(length - self.rest)
        tension = self.stiffness * value(self.law.pieces(), extension)
        return np.where(extension > 0.0, tension, 0.0)

    def force(self, theta: float, lever: float) -> Floats:
        """Force along travel [N] at a lever angle θ [rad] (Kamp et al. 2024, Eqs. 1 and 2)."""
        sin, cos = np.sin(theta), np.cos(theta)
        length = geometry.band_length(sin, cos, self.dx, self.dy, lever)
        first = geometry.length_slope(sin, cos, length, self.dx, self.dy)
        return geometry.band_force(self.tension(length), first)

    def pull(self, theta: float, lever: float, moves: Any) -> Floats:
        """Force [N] by which the band returns its anchor p against a displacement (x, y) `moves`.

        It acts along the displacement, positive towards rest. The displacement (..., 2) [m] is
        the full one of an antenna.
        """
        sin, cos = np.sin(theta), np.cos(theta)
        length = geometry.band_length(sin, cos, self.dx, self.dy, lever)
        x, y = geometry.band_direction(sin, cos, length, self.dx, self.dy, lever)
        way = np.asarray(moves)
        along = (x * way[..., 0] + y * way[..., 1]) / np.hypot(way[..., 0], way[..., 1])
        return -self.tension(length) * along


class LegForces(NamedTuple):
    """Forces that decide the gait of a leg [N]; arrays that broadcast."""

    inner_0: Any  # of the inner cell at 0
    inner_1: Any  # of the inner cell at 1
    outer_0: Any  # of the outer cell at 0, of its band alone
    lifted: Any  # of the outer cell where its foot loses contact
    outer_1: Any  # of the outer cell at 1, with the weight of its foot

    @property
    def lack(self) -> Any:
        """Force missing to open the outer cell before the inner one [N]."""
        return self.outer_0 - self.inner_0


class GaitRules:
    """The order in which the cells of a robot's legs move, from forces at their stops.

    While loading, the inner cell moves first if its F0 is below L, the force that opens the outer
    cell under the weight on its foot: the larger of the force at the stop and of the force where
    the foot loses contact. While unloading, the inner cell moves first if its F1 is above U, that
    of the outer cell with the foot's own weight. The weight on each foot follows from `Leaning`.
    Inner first both times steps forward, outer first both times backward.

    It holds for cells whose force falls along travel, and a rigid drive.
    """

    def __init__(self, robot: Robot):
        cell, foot = robot.legs[0].chain.levers[-1], robot.foot
        self._edge = edge = touch(robot)
        self.lever, self.limit = cell.lever, cell.limit
        self.touching = float(cell.angle(edge))
        self.travel, places = cell.full_travel, [leg.at[1] for leg in robot.legs]
        self.track = max(places) - min(places)
        self.leaning = Leaning.of(robot)
        self.own = foot.mass * robot.floor.gravity
        self.arms = float(foot.lever(edge)), float(foot.lever(cell.full_travel))
        self.rail = robot.blocks.rails(2)[0]
        nothing = np.zeros(1)
        self._stance = Stance(robot, nothing, nothing, np.array([2.0]))

    @classmethod
    def at_depth(cls, robot: Robot, below: float) -> GaitRules:
        """The rules of a robot with its feet at another preload depth [m]."""
        return cls(replace(robot, foot=replace(robot.foot, below=below)))

    def forces(self, inner: Bands, outer: Bands) -> LegForces:
        """Forces of legs with these bands [N]."""
        lifted, last = self.arms
        return LegForces(
            inner.force(-self.limit, self.lever),
            inner.force(self.limit, self.lever),
            outer.force(-self.limit, self.lever),
            outer.force(self.touching, self.lever) + self.own * lifted,
            outer.force(self.limit, self.lever) + self.own * last,
        )

    def gaps(self, legs: tuple[LegForces, LegForces]) -> tuple[tuple[Floats, Floats], ...]:
        """For each leg L - F0 and F1 - U [N]: positive where the inner cell moves first.

        The first of each pair is for loading, the second for unloading.
        """
        lacks = np.stack(np.broadcast_arrays(*(leg.lack for leg in legs)), axis=-1)
        weight = np.moveaxis(self.leaning.force(lacks), -1, 0)
        return tuple(self._gaps(*each) for each in zip(legs, weight, strict=True))

    def limits(self, leg: LegForces, side: int) -> tuple[Floats, Floats, Floats]:
        """Gaps of one leg whatever the other leg is: L - F0 at the least and most weight, F1 - U.

        The weight on its foot is between these two for every other leg, and L falls as it rises.
        `side` is 0 for the left leg, 1 for the right one.
        """
        ends = self.leaning.least[side], self.leaning.most[side]
        (light, unloading), (heavy, _) = (self._gaps(leg, np.array(one)) for one in ends)
        return light, heavy, unloading

    def _gaps(self, leg: LegForces, weight: Floats) -> tuple[Floats, Floats]:
        # `Stance.push` is the force by which the floor opens the outer cell as loading begins.
        opens = leg.outer_0 - self._stance.push(weight, 0.0, 0.0, 1)
        loading = np.maximum(leg.lifted, opens) - (leg.inner_0 + self.rail)
        return loading, leg.inner_1 - self.rail - leg.outer_1

    def step(self, inner: Bands, outer: Bands) -> Floats:
        """Part of a forward step after the foot grips [1], if both feet carry the same weight.

        The foot slides as the inner cell moves, until the force of that cell has fallen to the
        force at which the weight closes the outer cell; from there on the foot drives the body.
        """
        angles = np.linspace(-self.limit, self.limit, _LOOKS)
        opens = outer.force(self.touching, self.lever)
        weight = self.leaning.even[:1]
        grips = opens - float(self._stance.push(weight, self._edge, 0.0, 1)[0])
        forces = [inner.force(angle, self.lever) for angle in angles]
        forces = np.stack(np.broadcast_arrays(*forces, grips)[:-1])
        # Forces fall along travel: the foot grips between the last one above `grips` and the next.
        after = np.clip((forces > grips).sum(axis=0), 1, _LOOKS - 1)
        above, below = (np.take_along_axis(forces, (after - k)[None], axis=0)[0] for k in (1, 0))
        # Rubber with a plateau has equal forces; then the foot grips at once.
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.nan_to_num(np.clip((above - grips) / (above - below), 0.0, 1.0))
        sines = np.sin(angles)
        at = sines[after - 1] + part * (sines[after] - sines[after - 1])
        return np.asarray((1.0 - at / math.sin(self.limit)) / 2.0)

    def turn(self, left: Any, right: Any) -> Any:
        """Turn in a cycle [rad], to the left, of two legs that step forward by unequal parts.

        `left` and `right` are the parts of `step`; the longer step turns the robot away.
        """
        return (right - left) * self.travel / self.track

    def falling(self, bands: Bands) -> Bools:
        """Whether the force of cells falls along all of their travel, as the rules assume."""
        angles = np.linspace(-self.limit, self.limit, _LOOKS)
        forces = np.stack([bands.force(angle, self.lever) for angle in angles])
        return np.asarray((np.diff(forces, axis=0) < 0.0).all(axis=0))

    def returned(self, bands: Bands, moves: Any) -> Bools:
        """Whether a band returns its anchor p from displacements (..., 2) [m], at every angle."""
        angles = np.linspace(-self.limit, self.limit, _LOOKS)
        least = [bands.pull(angle, self.lever, moves) for angle in angles]
        return np.asarray((np.array(least) > 0.0).all(axis=0))
