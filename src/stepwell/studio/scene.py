"""A robot in motion as the page shows it: its parts, its samples, and whole runs made small."""

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
            "wall_mm": to_unit(HEIGHT, "mm"),
            "legs": [{"name": leg.name, "cells": list(leg.chain.names)} for leg in robot.legs],
            "antennas": [
                {
                    "name": one.name,
                    "side": one.side,
                    "swing_deg": math.degrees(one.swing),
                    "most_mm": to_unit(math.hypot(*one.moves), "mm") if one.connected else 0.0,
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
                "size_mm": _list(to_unit(model.geom_size[i], "mm")),
                "at_mm": _list(to_unit(model.geom_pos[i], "mm")),
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
                    "at_mm": [_list(to_unit(model.site_pos[k], "mm")) for k in sites],
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
    """Where a robot was, what its actuator and antennas did, and in which states its legs were.

    Args:
        walk: a run.
        scene: of its robot.
        rows: of its samples.
    """
    codes = [
        [-1 if one is None else int(one, 2) for one in states(_shares(walk, k)[rows])]
        for k in range(len(walk.robot.legs))
    ]
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


def _shares(walk: Walk, leg: int) -> np.ndarray[Any, Any]:
    full = walk.robot.legs[leg].chain.full_travels
    return walk.travel[:, leg, : len(full)] / np.array(full)


# So often what is new is sent [s].
_EVERY = 0.2


class Live:
    """Sends the samples of a run as they come.

    Args:
        robot, arena: of the run.
        ask: of the page, which is shown them.
    """

    def __init__(self, robot: Robot, arena: Arena | None, ask: Ask):
        self._scene, self._ask = Scene(robot, arena), ask
        self._sent, self._last = 0, monotonic()

    def look(self, so_far: Callable[[], Walk]) -> None:
        """Send what is new, not too often."""
        if monotonic() - self._last >= _EVERY:
            self._ask.show(self.view(so_far()))
            self._last = monotonic()

    def view(self, walk: Walk, **told: Any) -> View:
        """The samples that were not sent yet.

        Args:
            walk: so far.
            told: what else the page is told.
        """
        new = slice(self._sent, None)
        header = {"first": self._sent, **told}
        self._sent = len(walk.time)
        return View(header, samples_of(walk, self._scene, new))


# What a number is rounded to, in its unit; poses are looked at and not read.
_STEPS = {"time": 1e-4, "place": 0.05, "turn": 1e-4, "state": 1.0}
_STEP = 1e-3
# Compressed, a page of so much stays below a megabyte; a browser holds so many samples with ease.
_MOST_BYTES, _MOST_SAMPLES = 600_000, 30_000


def walked(result: Walk | Maze) -> View:
    """All that is to be seen of a run, from the start of its first cycle on.

    Every block holds, of each of its columns in turn, the differences from the sample before in
    whole `steps`: those of a gait come again and again, and compress to a hundredth.

    Args:
        result: a walk, or a way through an arena.

    Raises:
        ValueError: a run that was over before its first sample.
    """
    walk = result.walk if isinstance(result, Maze) else result
    if not len(walk.time):
        raise InputError(f"the walk has no samples. {walk.stopped}")
    scene = Scene(walk.robot, walk.arena)
    settled = min(int(np.searchsorted(walk.time, 0.0)), len(walk.time) - 1)
    every = 1 + (len(walk.time) - settled) // _MOST_SAMPLES
    blocks = samples_of(walk, scene, slice(settled, None, every))
    # Obstacles end what comes again; then fewer samples have to do.
    while _size(told := _differences(blocks)) > _MOST_BYTES and len(blocks["time"]) > 2:
        blocks = {name: block[::2] for name, block in blocks.items()}
    is_maze = isinstance(result, Maze)
    header = {
        **scene.told(),
        "title": walk.robot.title,
        "version": __version__,
        "arena": None if walk.arena is None else arena_tables(walk.arena),
        "steps": {name: _STEPS.get(name, _STEP) for name in told},
        "record": account(result).record,
        "outcome": str(result.outcome) if is_maze else "",
        "assumptions": simulation_assumptions(walk),
    }
    return View(header, told)


def _differences(blocks: dict[str, np.ndarray[Any, Any]]) -> dict[str, np.ndarray[Any, Any]]:
    found: dict[str, np.ndarray[Any, Any]] = {}
    for name, block in blocks.items():
        columns = block.reshape(len(block), -1).T
        whole = np.round(columns / _STEPS.get(name, _STEP)).astype(np.int32)
        found[name] = np.diff(whole, axis=1, prepend=np.int32(0))
    return found


def _size(blocks: dict[str, np.ndarray[Any, Any]]) -> int:
    return sum(len(zlib.compress(block.tobytes(), 9)) for block in blocks.values())


# A robot has many parts; it is at its pace in its second cycle.
_POSES, _CYCLES = 30, 2.0


def walking(robot: Robot) -> View:
    """Parts, lines and poses of the second cycle of a walk.

    Raises:
        ExtraError: MuJoCo is not installed.
    """
    scene, found = Scene(robot), walk_of(robot, _CYCLES)
    last = np.flatnonzero(found.time >= found.time[-1] - robot.drive.period)
    rows = last[np.linspace(0, len(last) - 1, _POSES).astype(int)]
    header = {"parts": scene.parts(), "lines": scene.lines()}
    return View(header, scene.placed(found.positions[rows]))
