"""A robot for the page: parts, samples, and compressed runs."""

import math
import zlib
from collections.abc import Callable
from time import monotonic
from typing import Any

import numpy as np

from stepwell.accounts import account, simulation_assumptions
from stepwell.base import Floats, InputError, __version__, to_unit
from stepwell.files import arena_tables
from stepwell.robot import Arena, Robot, states
from stepwell.simulation import HEIGHT, Maze, Walk, mujoco, obstacle_names, spec, walk as walk_of
from stepwell.studio.ask import Ask, View
from stepwell.studio.motion import design_text

_SHAPES = {
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "ball",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "rod",
}


class Scene:
    """A robot as rigid parts on moving bodies."""

    def __init__(self, robot: Robot, arena: Arena | None = None):
        self._robot = robot
        self._model = model = spec(robot, arena).compile()
        self._data = mujoco.MjData(model)
        around = {"world", *(obstacle_names(arena) if arena is not None else ())}
        self._bodies = [i for i in range(model.nbody) if model.body(i).name not in around]
        self._owners = {
            f"{leg.name}.{name}.band": (k, i)
            for k, leg in enumerate(robot.legs)
            for i, name in enumerate(leg.chain.names)
        }

    @property
    def start(self) -> Floats:
        """Joint positions (1, nq) in the start pose with every cell in state 0."""
        return np.asarray(self._model.key_qpos[:1])

    def header(self) -> dict[str, Any]:
        """Constant parts of the scene, and names of legs and antennas."""
        robot = self._robot
        antennas = [
            {
                "name": one.name,
                "side": one.side,
                "swing_deg": math.degrees(one.swing),
                "most_mm": to_unit(math.hypot(*one.moves), "mm") if one.connected else 0.0,
            }
            for one in robot.antennas
        ]
        return {
            **self.shape(),
            "wall_mm": to_unit(HEIGHT, "mm"),
            "legs": [{"name": leg.name, "cells": list(leg.chain.names)} for leg in robot.legs],
            "antennas": antennas,
            "period_s": robot.drive.period,
        }

    def shape(self) -> dict[str, Any]:
        """The parts and the lines of the robot."""
        return {"parts": self._parts(), "lines": self._lines()}

    def _parts(self) -> list[dict[str, Any]]:
        """Boxes, balls and rods with size, position on their body, and colour."""
        model = self._model
        return [
            {
                "shape": _SHAPES[int(model.geom_type[i])],
                "body": self._bodies.index(int(model.geom_bodyid[i])),
                # A box's half edges; a ball's radius; a rod's radius and half its length.
                "size_mm": _list(to_unit(model.geom_size[i], "mm")),
                "at_mm": _list(to_unit(model.geom_pos[i], "mm")),
                "turn": _list(model.geom_quat[i]),
                **_colour(model.geom_rgba[i]),
            }
            for i in range(model.ngeom)
            if model.geom_bodyid[i] in self._bodies and model.geom_rgba[i][3] > 0
        ]

    def _lines(self) -> list[dict[str, Any]]:
        """Levers, links and bands: straight lines between points of two bodies."""
        model, lines = self._model, list[dict[str, Any]]()
        for i in range(model.ntendon):
            first = int(model.tendon_adr[i])
            wraps = slice(first, first + int(model.tendon_num[i]))
            straight = np.all(model.wrap_type[wraps] == int(mujoco.mjtWrap.mjWRAP_SITE))
            if not straight or model.tendon_rgba[i][3] == 0:
                continue
            sites = model.wrap_objid[wraps].tolist()
            # If a cell has several bands, each name ends with a number.
            leg, cell = self._owners.get(model.tendon(i).name.rstrip("0123456789"), (None, None))
            lines.append(
                {
                    "bodies": [self._bodies.index(int(model.site_bodyid[k])) for k in sites],
                    "at_mm": [_list(to_unit(model.site_pos[k], "mm")) for k in sites],
                    "leg": leg,
                    "cell": cell,
                    **_colour(model.tendon_rgba[i]),
                }
            )
        return lines

    def placed(self, positions: Floats) -> dict[str, Floats]:
        """Poses of the bodies for (n, nq) positions of the joints.

        `place` is (n, bodies, 3) in mm, `turn` (n, bodies, 4) quaternions w, x, y, z.
        """
        place = np.empty((len(positions), len(self._bodies), 3))
        turn = np.empty((len(positions), len(self._bodies), 4))
        for k, position in enumerate(positions):
            self._data.qpos[:] = position
            mujoco.mj_kinematics(self._model, self._data)
            place[k] = to_unit(self._data.xpos[self._bodies], "mm")
            turn[k] = self._data.xquat[self._bodies]
        return {"place": place, "turn": turn}


def _list(values: Any) -> list[float]:
    return [round(float(value), 6) for value in values]


def _colour(rgba: Any) -> dict[str, Any]:
    red, green, blue = (round(float(part) * 255) for part in rgba[:3])
    return {"colour": f"#{red:02x}{green:02x}{blue:02x}", "opacity": round(float(rgba[3]), 3)}


def samples_of(
    walk: Walk, scene: Scene, rows: slice | np.ndarray[Any, Any]
) -> dict[str, np.ndarray[Any, Any]]:
    """Samples of a walk: positions, actuator, antennas, forces and states of the legs."""
    codes: list[list[int]] = []
    for k, leg in enumerate(walk.robot.legs):
        full = np.array(leg.chain.full_travels)
        labels = states(walk.travel[rows, k, : len(full)] / full)
        codes.append([-1 if one is None else int(one, 2) for one in labels])
    gears = [one.gear if one.connected else 0.0 for one in walk.robot.antennas]
    return {
        "time": walk.time[rows],
        "x": to_unit(walk.x[rows], "mm"),
        "y": to_unit(walk.y[rows], "mm"),
        "yaw": np.degrees(walk.yaw[rows]),
        "stroke": to_unit(walk.stroke[rows], "mm"),
        "antenna": np.degrees(walk.antenna[rows]),
        "moved": to_unit(walk.antenna[rows] * np.array(gears), "mm"),
        "foot_force": walk.foot_force[rows],
        # A leg's state as a binary number; -1 in transit.
        "state": np.array(codes, np.int32).reshape(len(codes), -1).T,
        **scene.placed(walk.positions[rows]),
    }


# Seconds between two messages with new samples.
_EVERY = 0.2


class Live:
    """Sends the samples of a run to the page during the simulation."""

    def __init__(self, robot: Robot, arena: Arena | None, ask: Ask):
        self._scene, self._ask = Scene(robot, arena), ask
        self._sent, self._last = 0, monotonic()

    def look(self, so_far: Callable[[], Walk]) -> None:
        """Send new samples, at most once per `_EVERY`."""
        if monotonic() - self._last >= _EVERY:
            self._ask.show(self.view(so_far()))
            self._last = monotonic()

    def view(self, walk: Walk, **header: Any) -> View:
        """The samples since the last message, with further entries of the header."""
        first, self._sent = self._sent, len(walk.time)
        return View({"first": first, **header}, samples_of(walk, self._scene, slice(first, None)))


# Rounding of numbers in their units; poses need less precision.
_STEPS = {"time": 1e-4, "place": 0.05, "turn": 1e-4, "state": 1.0}
_STEP = 1e-3
# Limits: compressed bytes for a page below a megabyte, and samples for a browser.
_MOST_BYTES, _MOST_SAMPLES = 600_000, 30_000


def walked(result: Walk | Maze) -> View:
    """A run for the replay, from the start of its first cycle.

    Every block contains, column by column, the differences between samples in
    whole `steps`: those of a gait repeat and compress to 1 %. A run that
    ended before its first sample is refused.
    """
    walk = result.walk if isinstance(result, Maze) else result
    if not len(walk.time):
        raise InputError(f"the walk has no samples. {walk.stopped}")
    scene = Scene(walk.robot, walk.arena)
    settled = min(int(np.searchsorted(walk.time, 0.0)), len(walk.time) - 1)
    every = 1 + (len(walk.time) - settled) // _MOST_SAMPLES
    blocks = samples_of(walk, scene, slice(settled, None, every))
    # With obstacles the motion does not repeat; then fewer samples are kept.
    while _size(differences := _differences(blocks)) > _MOST_BYTES and len(blocks["time"]) > 2:
        blocks = {name: block[::2] for name, block in blocks.items()}
    header = {
        **scene.header(),
        "title": walk.robot.title,
        "version": __version__,
        "toml": design_text(walk.robot),
        "arena": None if walk.arena is None else arena_tables(walk.arena),
        "steps": {name: _STEPS.get(name, _STEP) for name in differences},
        "record": account(result).record,
        "outcome": result.ending if isinstance(result, Maze) else "",
        "assumptions": simulation_assumptions(walk),
    }
    return View(header, differences)


def _differences(blocks: dict[str, np.ndarray[Any, Any]]) -> dict[str, np.ndarray[Any, Any]]:
    differences: dict[str, np.ndarray[Any, Any]] = {}
    for name, block in blocks.items():
        columns = block.reshape(len(block), -1).T
        whole = np.round(columns / _STEPS.get(name, _STEP)).astype(np.int32)
        differences[name] = np.diff(whole, axis=1, prepend=np.int32(0))
    return differences


def _size(blocks: dict[str, np.ndarray[Any, Any]]) -> int:
    return sum(len(zlib.compress(block.tobytes(), 9)) for block in blocks.values())


# A robot has many parts; its gait is steady in the second cycle.
_POSES, _CYCLES = 30, 2.0


def walking(robot: Robot) -> View:
    """Parts, lines and poses of the second cycle of a walk."""
    scene, motion = Scene(robot), walk_of(robot, _CYCLES)
    last = np.flatnonzero(motion.time >= motion.time[-1] - robot.drive.period)
    rows = last[np.linspace(0, len(last) - 1, _POSES).astype(int)]
    return View(scene.shape(), scene.placed(motion.positions[rows]))
