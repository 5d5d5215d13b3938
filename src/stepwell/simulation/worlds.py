"""Robots stepped together on MuJoCo Warp, in single precision: one design a world.

What they are comes from the models that MuJoCo compiles, and what is read of them goes to their
runs, so that nothing of a robot or of a verdict is told twice. Only the stepping is another.
"""

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import fields
from functools import cache
from importlib import import_module
from typing import Any, TypeVar

import numpy as np

from stepwell.base import ExtraError, InputError, grouped, need
from stepwell.robot import Arena, Robot
from stepwell.simulation.engine import SimulatedRun
from stepwell.simulation.mazes import Judge, Outcome
from stepwell.simulation.simulator import Model, Settings, mujoco
from stepwell.simulation.sweeps import Trial, walked

T = TypeVar("T")

STEPS = 100  # that are read from the device at once
CONTACTS = 48  # room for contacts in a world; a robot among walls has some twenty
UNTOLD = "there are more contacts than it has room for"
# What stands still is placed once, so each world is told where everything is at its start.
PLACED = ("xpos", "xquat", "xmat", "geom_xpos", "geom_xmat", "site_xpos", "site_xmat")
# Of what Warp shares between worlds, what may differ: how far sites reach only decides which
# forces are read, and where robots start is told anyway.
SHARED = {"site_size", "key_qpos"}


def screen_walks(
    robots: Sequence[Robot], *, cycles: int = 4, settings: Settings | None = None
) -> tuple[Trial | None, ...]:
    """Walk many robots at once on MuJoCo Warp, on a bare floor: to choose from, not to report.

    Args:
        robots: (n,) robots; those whose models differ in numbers alone are stepped together.
        cycles: of each walk, >= 1.
        settings: of the simulation.

    Returns:
        (n,) what each did, in single precision and not always the same to the last digits; None
        where nothing can be told: the robot has no model, or Warp ran out of room.

    Raises:
        ValueError: no cycles.
        ExtraError: the extra gpu is not installed, or not in the release of MuJoCo.
    """
    if cycles < 1:
        raise InputError(f"cycles = {cycles}: must be >= 1.")

    def step(runs: Sequence[SimulatedRun], end: float) -> None:
        for group in alike(runs):
            Worlds(group).advance(end)

    opened()
    runs = _begun([(robot, None) for robot in robots], settings, record=True)
    able = [run for run in runs if run]
    return _told(runs, dict(zip(able, map(Trial.of, walked(able, cycles, step)), strict=True)))


def screen_mazes(
    entries: Sequence[tuple[Robot, Arena]],
    *,
    limit: float = 600.0,
    settings: Settings | None = None,
) -> tuple[Outcome | None, ...]:
    """Let many robots walk in many arenas at once on MuJoCo Warp: to choose from, not to report.

    Args:
        entries: (n,) robot and arena; those that differ in numbers alone are stepped together.
        limit: time that each is given [s], > 0.
        settings: of the simulation.

    Returns:
        (n,) how each way ended, with the doubts and errors of `screen_walks`.
    """
    if not limit > 0:
        raise InputError(f"limit = {limit} s: must be > 0.")
    opened()
    runs = _begun(entries, settings, record=False)
    judges = {
        run: Judge(arena) for run, (_, arena) in zip(runs, entries, strict=True) if run is not None
    }
    for group in alike(list(judges)):
        _judged(group, judges, limit)
    return _told(runs, {run: one.outcome or Outcome.TIMED_OUT for run, one in judges.items()})


def _begun(
    entries: Sequence[tuple[Robot, Arena | None]], settings: Settings | None, *, record: bool
) -> list[SimulatedRun | None]:
    """Runs at their start; None of a robot that has no model, of which its own run says why."""
    runs: list[SimulatedRun | None] = []
    for robot, arena in entries:
        try:
            runs.append(SimulatedRun(robot, arena, settings or Settings(), record=record))
        except ValueError:
            runs.append(None)
    return runs


def _told(runs: Sequence[SimulatedRun | None], of: dict[SimulatedRun, T]) -> tuple[T | None, ...]:
    """What was found of each run; None where there is none, or nothing is sure."""
    return tuple(None if run is None or UNTOLD in run.stopped else of[run] for run in runs)


def _judged(group: Sequence[SimulatedRun], judges: dict[SimulatedRun, Judge], limit: float) -> None:
    """Step runs of one structure until each has ended or its time is over."""
    going, worlds = list(group), Worlds(group)
    for until in group[0].looks(limit):
        worlds.advance(until, going)
        going = [run for run in going if judges[run].look(run) is None]
        if not going:
            return
        # Who has ended is stepped on for nothing, until it is worth while to leave them behind.
        if len(going) <= len(worlds.runs) / 2:
            worlds = Worlds(going)


def alike(runs: Sequence[SimulatedRun]) -> list[list[SimulatedRun]]:
    """Runs in groups that differ in numbers which Warp keeps for every world."""
    return list(grouped((_structure(run.model), run) for run in runs).values())


class Worlds:
    """Runs of one structure, as `alike` groups them, on a device, each in a world of its own."""

    def __init__(self, runs: Sequence[SimulatedRun]):
        self.runs = list(runs)
        self._now, self._time_step = runs[0].now, runs[0].settings.time_step
        self._warp, self._mjw = opened()
        first, n = copy(runs[0].model), len(runs)
        # Runs stop themselves where a number overflows, and Warp knows no other way.
        first.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        first.site_size[:] = np.max([run.model.site_size for run in runs], axis=0)
        each = {name: [getattr(run.model, name) for run in runs] for name in _batched()}
        differ = {
            name: values
            for name, values in each.items()
            if not all(np.array_equal(value, values[0]) for value in values[1:])
        }
        with _silent(self._warp):
            self._model = self._mjw.put_model(first, batch_sizes=dict.fromkeys(differ, n))
            for name, values in differ.items():
                _fill(getattr(self._model, name), values)
            self._model.opt.warn_overflow = 0  # told below
            rows = 3 * first.neq + first.nv + first.njnt + 2 * first.ntendon + 3 * CONTACTS
            self._data = self._mjw.put_data(
                first, runs[0].data, nworld=n, nconmax=CONTACTS, njmax=rows
            )
            for name in PLACED:
                _fill(getattr(self._data, name), [getattr(run.data, name) for run in runs])
            # The full state begins with the time, then positions, then velocities.
            state, nq, nv = np.stack([run.state for run in runs]), first.nq, first.nv
            _fill(self._data.qpos, state[:, 1 : 1 + nq])
            _fill(self._data.qvel, state[:, 1 + nq : 1 + nq + nv])
            self._step = self._stepping()

    def advance(self, until: float, going: Sequence[SimulatedRun] | None = None) -> None:
        """Step to this time [s]; what is read goes to all runs, or to those that are `going`."""
        takes = set(self.runs if going is None else going)
        total = round((until - self._now) / self._time_step)
        self._now += total * self._time_step
        for done in range(0, total, STEPS):
            self._stretch(min(STEPS, total - done), takes)

    def _stretch(self, steps: int, takes: set[SimulatedRun]) -> None:
        data, copied, n = self._data, self._warp.copy, len(self.runs)
        state = data.qpos.shape[1], data.qvel.shape[1], data.sensordata.shape[1]
        with _silent(self._warp):
            command = np.stack([run.command(steps) for run in self.runs], axis=1)
            commands = self._warp.array(command[:, :, None], dtype=float)
            read = [self._warp.empty((steps, n, width), dtype=float) for width in state]
            for i in range(steps):
                copied(data.ctrl, commands[i])
                self._step()
                for kept, now in zip(read, (data.qpos, data.qvel, data.sensordata), strict=True):
                    copied(kept[i], now)
            positions, speeds, readings = (one.numpy().astype(float) for one in read)
            full = np.array(data.overflow.numpy()) & ~self._harmless
        for world, run in enumerate(self.runs):
            if run not in takes:
                continue
            if full[world] and not run.stopped:
                run.stopped = f"Stopped at {run.now:.3f} s: {UNTOLD}."
            states = np.zeros((steps, run.state.size))
            states[:, 1:] = np.hstack([positions[:, world], speeds[:, world]])
            run.take(states, readings[:, world])

    def _stepping(self) -> Callable[[], None]:
        """One step: on a GPU what it launches is recorded once, or Python would be the slowest."""
        warp, step = self._warp, self._mjw.step
        if not warp.get_device().is_cuda:
            return lambda: step(self._model, self._data)
        with warp.ScopedCapture() as capture:
            step(self._model, self._data)
        return lambda: warp.capture_launch(capture.graph)

    @property
    def _harmless(self) -> int:
        """What Warp reports of a world that loses nothing: a search that was ended early."""
        kind = self._mjw.OverflowType
        return int(kind.ITERATIONS | kind.LS_ITERATIONS)


@cache
def opened() -> tuple[Any, Any]:
    """Warp and MuJoCo Warp; an `ExtraError` if not there, or of another release than MuJoCo."""
    need("gpu")
    warp = import_module("warp")
    with _silent(warp):
        warp.init()
        mjw = import_module("mujoco_warp")
    if mujoco.__version__.split(".")[:2] != mjw.__version__.split(".")[:2]:
        raise ExtraError(
            f"MuJoCo Warp is of release {mjw.__version__}, and MuJoCo of {mujoco.__version__}: "
            f"what the one simulates need not be what the other does. Install both of one release: "
            f"pip install -U mujoco mujoco-warp",
            name="mujoco_warp",
        )
    return warp, mjw


def device() -> tuple[str, bool]:
    """Where worlds are stepped: its name, and whether it is a GPU."""
    warp, _ = opened()
    with _silent(warp):
        default = warp.get_device()
    return str(default.name), bool(default.is_cuda)


@contextmanager
def _silent(warp: Any) -> Iterator[None]:
    """Keep off the screen what Warp tells of its kernels."""
    before = warp.config.log_level
    warp.config.log_level = warp.LOG_ERROR
    try:
        yield
    finally:
        warp.config.log_level = before


@cache
def _batched() -> tuple[str, ...]:
    """What of a model Warp can keep for every world."""
    shapes = {field.name: getattr(field.type, "shape", ()) for field in fields(opened()[1].Model)}
    return tuple(name for name, shape in shapes.items() if shape[:1] == ("*",))


def _structure(model: Model) -> Hashable:
    """All of a model that worlds share, and which of their numbers are there at all."""
    batched = set(_batched())
    parts: list[Hashable] = [model.opt.gravity.tobytes()]
    for field in fields(opened()[1].Model):
        value: Any = getattr(model, field.name, None)
        if field.name in batched:
            # What is nowhere in the first of them may be left out for all.
            parts.append((value.shape, bool(value.any())))
        elif isinstance(value, np.ndarray) and field.name not in SHARED:
            parts.append(value.tobytes())
        elif isinstance(value, int | float):
            parts.append(value)
    return tuple(parts)


def _fill(array: Any, values: Sequence[np.ndarray] | np.ndarray) -> None:
    """Put what each world has into an array of the device."""
    array.assign(np.asarray(values).reshape(array.numpy().shape))
