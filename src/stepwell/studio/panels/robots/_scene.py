"""The parts of a robot as its simulation has them, and where they are at every sample."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stepwell.base import Floats
from stepwell.robot import Arena, Robot
from stepwell.simulation import HEIGHT, mujoco, obstacle_names, spec

_MM = 1e3
_SHAPES = {
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "ball",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "rod",
}


class Scene:
    """A robot to be drawn: parts that keep their shape, each on a body that moves.

    Args:
        robot: any that can be simulated.
        arena: where it starts.

    Raises:
        ValueError: a robot that the simulator has no terms for.
        ExtraError: MuJoCo is not installed.
    """

    def __init__(self, robot: Robot, arena: Arena | None = None):
        self._robot = robot
        self._model = spec(robot, arena).compile()
        self._data = mujoco.MjData(self._model)
        around = {"world", *(obstacle_names(arena) if arena is not None else ())}
        model = self._model
        names = [model.body(i).name for i in range(model.nbody)]
        self._bodies = [i for i, name in enumerate(names) if name not in around]
        self._owners = {
            f"{leg.name}.{name}.band": (k, i)
            for k, leg in enumerate(robot.legs)
            for i, name in enumerate(leg.chain.names)
        }

    @property
    def start(self) -> Floats:
        """(1, nq) joint positions of the robot that stands at the start with every cell at 0."""
        return np.asarray(self._model.key_qpos[:1])

    def told(self) -> dict[str, Any]:
        """What of the robot and around it keeps its shape, and the names of legs and antennas."""
        robot = self._robot
        return {
            "parts": self.parts(),
            "lines": self.lines(),
            "wall_mm": HEIGHT * _MM,
            "legs": [{"name": leg.name, "cells": list(leg.chain.names)} for leg in robot.legs],
            "antennas": [
                {
                    "name": one.name,
                    "side": one.side,
                    "swing_deg": math.degrees(one.swing),
                    "most_mm": math.hypot(*one.moves) * _MM if one.connected else 0.0,
                }
                for one in robot.antennas
            ],
            "period_s": robot.drive.period,
        }

    def parts(self) -> list[dict[str, Any]]:
        """Boxes, balls and rods with their sizes, the place of each on its body, its colour."""
        model = self._model
        return [
            {
                "shape": _SHAPES[int(model.geom_type[i])],
                "body": self._bodies.index(int(model.geom_bodyid[i])),
                # A box's half edges; a ball's radius; a rod's radius and half its length.
                "size_mm": _list(model.geom_size[i] * _MM),
                "at_mm": _list(model.geom_pos[i] * _MM),
                "turn": _list(model.geom_quat[i]),
                **_colour(model.geom_rgba[i]),
            }
            for i in range(model.ngeom)
            if model.geom_bodyid[i] in self._bodies and model.geom_rgba[i][3] > 0
        ]

    def lines(self) -> list[dict[str, Any]]:
        """Levers, links and bands: straight from a point of one body to a point of another."""
        model, found = self._model, list[dict[str, Any]]()
        for i in range(model.ntendon):
            first, count = int(model.tendon_adr[i]), int(model.tendon_num[i])
            wraps = range(first, first + count)
            if any(model.wrap_type[k] != mujoco.mjtWrap.mjWRAP_SITE for k in wraps):
                continue
            if model.tendon_rgba[i][3] == 0:
                continue
            sites = [int(model.wrap_objid[k]) for k in wraps]
            # Of several bands of a cell each has a number at the end of its name.
            leg, cell = self._owners.get(model.tendon(i).name.rstrip("0123456789"), (None, None))
            found.append(
                {
                    "bodies": [self._bodies.index(int(model.site_bodyid[k])) for k in sites],
                    "at_mm": [_list(model.site_pos[k] * _MM) for k in sites],
                    "leg": leg,
                    "cell": cell,
                    **_colour(model.tendon_rgba[i]),
                }
            )
        return found

    def placed(self, positions: Floats) -> dict[str, Floats]:
        """Where the bodies are.

        Args:
            positions: (n, nq) of the joints.

        Returns:
            `place`, (n, bodies, 3) in mm, and `turn`, (n, bodies, 4) as quaternions w, x, y, z.
        """
        place = np.empty((len(positions), len(self._bodies), 3))
        turn = np.empty((len(positions), len(self._bodies), 4))
        for k, position in enumerate(positions):
            self._data.qpos[:] = position
            mujoco.mj_kinematics(self._model, self._data)
            place[k] = self._data.xpos[self._bodies] * _MM
            turn[k] = self._data.xquat[self._bodies]
        return {"place": place, "turn": turn}


def _list(values: Any) -> list[float]:
    return [round(float(value), 6) for value in values]


def _colour(rgba: Any) -> dict[str, Any]:
    red, green, blue = (round(float(part) * 255) for part in rgba[:3])
    return {"colour": f"#{red:02x}{green:02x}{blue:02x}", "opacity": round(float(rgba[3]), 3)}
