"""Parallel stepping of robots on MuJoCo Warp, in single precision: one design per world.

The models are those compiled by MuJoCo, and the readings go to the usual runs, so that models and
verdicts are defined once. Only the time stepping differs.
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

STEPS = 100  # read from the device at once
CONTACTS = 48  # capacity for contacts in a world; a robot among walls has some twenty
FULL = "there are more contacts than the capacity"
# Fixed bodies are placed once, so each world gets all places at its start.
PLACED = ("xpos", "xquat", "xmat", "geom_xpos", "geom_xmat", "site_xpos", "site_xmat")
# Fields shared by all worlds of Warp that may differ: the size of a site only decides which forces
# are read, and the start of a robot is set separately.
SHARED = {"site_size", "key_qpos"}


def screen_walks(
    robots: Sequence[Robot], *, cycles: int = 4, settings: Settings | None = None
) -> tuple[Trial | None, ...]:
    """Simulate walks of many robots on MuJoCo Warp, on a bare floor, as a prefilter.

    Args:
        robots: (n,) robots; those whose models differ in numbers only are stepped together.
        cycles: of each walk, >= 1.
        settings: of the simulation.

    Returns:
        (n,) results in single precision, which may differ in the last digits between runs; None
        without a result: the robot has no model, or the capacity of Warp was exceeded.

    Raises:
        ValueError: no cycles.
        ExtraError: the extra gpu is missing, or of another release than MuJoCo.
    """
    if cycles < 1:
        raise InputError(f"cycles = {cycles}: must be >= 1.")

    def step(runs: Sequence[SimulatedRun], end: float) -> None:
        for group in alike(runs):
            Worlds(group).advance(end)

    opened()
    runs = _begun([(robot, None) for robot in robots], settings, record=True)
    able = [run for run in runs if run]
    return _sure(runs, dict(zip(able, map(Trial.of, walked(able, cycles, step)), strict=True)))


def screen_mazes(
    entries: Sequence[tuple[Robot, Arena]],
    *,
    limit: float = 600.0,
    settings: Settings | None = None,
) -> tuple[Outcome | None, ...]:
    """Simulate many robots in many arenas on MuJoCo Warp, as a prefilter.

    Args:
        entries: (n,) robot and arena; those that differ in numbers only are stepped together.
        limit: simulated time of each [s], > 0.
        settings: of the simulation.

    Returns:
        (n,) outcomes, with the uncertainty and errors of `screen_walks`.
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
    return _sure(runs, {run: one.outcome or Outcome.TIMED_OUT for run, one in judges.items()})


def _begun(
    entries: Sequence[tuple[Robot, Arena | None]], settings: Settings | None, *, record: bool
) -> list[SimulatedRun | None]:
    """Runs at their start; None for a robot without a model, whose own run gives the reason."""
    runs: list[SimulatedRun | None] = []
    for robot, arena in entries:
        try:
            runs.append(SimulatedRun(robot, arena, settings or Settings(), record=record))
        except ValueError:
            runs.append(None)
    return runs


def _sure(runs: Sequence[SimulatedRun | None], of: dict[SimulatedRun, T]) -> tuple[T | None, ...]:
    """Results of the runs; None without a run, or if its contacts exceeded the capacity."""
    return tuple(None if run is None or FULL in run.stopped else of[run] for run in runs)


def _judged(group: Sequence[SimulatedRun], judges: dict[SimulatedRun, Judge], limit: float) -> None:
    """Step runs of one structure until each has ended or its time is over."""
    going, worlds = list(group), Worlds(group)
    for until in group[0].looks(limit):
        worlds.advance(until, going)
        going = [run for run in going if judges[run].look(run) is None]
        if not going:
            return
        # Ended runs are still stepped, until removing them is worth the cost.
        if len(going) <= len(worlds.runs) / 2:
            worlds = Worlds(going)


def alike(runs: Sequence[SimulatedRun]) -> list[list[SimulatedRun]]:
    """Runs grouped by structure: within a group only numbers kept per world differ."""
    return list(grouped((_structure(run.model), run) for run in runs).values())


class Worlds:
    """Runs of one structure, as grouped by `alike`, on a device, one world each."""

    def __init__(self, runs: Sequence[SimulatedRun]):
        self.runs = list(runs)
        self._now, self._time_step = runs[0].now, runs[0].settings.time_step
        self._warp, self._mjw = opened()
        first, n = copy(runs[0].model), len(runs)
        # Runs detect overflows themselves; Warp supports only automatic reset.
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
            self._model.opt.warn_overflow = 0  # reported below
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
        """Step to this time [s]; the readings go to all runs, or to those in `going`."""
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
                run.stopped = f"Stopped at {run.now:.3f} s: {FULL}."
            states = np.zeros((steps, run.state.size))
            states[:, 1:] = np.hstack([positions[:, world], speeds[:, world]])
            run.take(states, readings[:, world])

    def _stepping(self) -> Callable[[], None]:
        """Function for one step; on a GPU a captured graph, since Python would be slower."""
        warp, step = self._warp, self._mjw.step
        if not warp.get_device().is_cuda:
            return lambda: step(self._model, self._data)
        with warp.ScopedCapture() as capture:
            step(self._model, self._data)
        return lambda: warp.capture_launch(capture.graph)

    @property
    def _harmless(self) -> int:
        """Flags of Warp without loss of contacts: a solver that reached its iteration limit."""
        kind = self._mjw.OverflowType
        return int(kind.ITERATIONS | kind.LS_ITERATIONS)


@cache
def opened() -> tuple[Any, Any]:
    """Warp and MuJoCo Warp; `ExtraError` if missing, or of another release than MuJoCo."""
    need("gpu")
    warp = import_module("warp")
    with _silent(warp):
        warp.init()
        mjw = import_module("mujoco_warp")
    if mujoco.__version__.split(".")[:2] != mjw.__version__.split(".")[:2]:
        raise ExtraError(
            f"MuJoCo Warp {mjw.__version__} and MuJoCo {mujoco.__version__} may give different "
            f"results. Install the same release of both: pip install -U mujoco mujoco-warp",
            name="mujoco_warp",
        )
    return warp, mjw


def device() -> tuple[str, bool]:
    """The device that steps worlds: its name, and whether it is a GPU."""
    warp, _ = opened()
    with _silent(warp):
        default = warp.get_device()
    return str(default.name), bool(default.is_cuda)


@contextmanager
def _silent(warp: Any) -> Iterator[None]:
    """Suppress Warp's messages about its kernels."""
    before = warp.config.log_level
    warp.config.log_level = warp.LOG_ERROR
    try:
        yield
    finally:
        warp.config.log_level = before


@cache
def _batched() -> tuple[str, ...]:
    """Fields of a model that Warp keeps per world."""
    shapes = {field.name: getattr(field.type, "shape", ()) for field in fields(opened()[1].Model)}
    return tuple(name for name, shape in shapes.items() if shape[:1] == ("*",))


def _structure(model: Model) -> Hashable:
    """Key of a model: all shared fields, and which of the fields per world are in use."""
    batched = set(_batched())
    parts: list[Hashable] = [model.opt.gravity.tobytes()]
    for field in fields(opened()[1].Model):
        value: Any = getattr(model, field.name, None)
        if field.name in batched:
            # A field that is zero in the first model may be left out for all.
            parts.append((value.shape, bool(value.any())))
        elif isinstance(value, np.ndarray) and field.name not in SHARED:
            parts.append(value.tobytes())
        elif isinstance(value, int | float):
            parts.append(value)
    return tuple(parts)


def _fill(array: Any, values: Sequence[np.ndarray] | np.ndarray) -> None:
    """Copy the values of all worlds into an array of the device."""
    array.assign(np.asarray(values).reshape(array.numpy().shape))
