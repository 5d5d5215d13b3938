"""Walks of many robots, in parallel on all cores."""

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import base
from stepwell.kernels import cores
from stepwell.robot import TRIAL, Arena, Robot
from stepwell.simulation.engine import SimulatedRun
from stepwell.simulation.simulator import Settings, mujoco, quietly, rollout
from stepwell.simulation.walks import Walk, recorded

if TYPE_CHECKING:
    import xarray as xr

# Robots that are stepped together, per core: enough to keep the cores busy to the end.
PER_CORE = 8
CHUNK = 500  # steps at a time
# Sizes that models have in common if one buffer serves the steps of all of them.
_SIZES = (
    *("nq", "nv", "nbody", "njnt", "ngeom", "nsite", "ntendon", "nwrap", "neq", "nsensordata"),
    *("nM", "nD", "nbvh"),
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Trial(base.ByValue):
    """Result of one robot of a sweep.

    Attributes:
        advance, sideways: mean displacement per cycle over u_max [1], after the first cycle.
        turn: mean rotation to the left per cycle [rad], after the first cycle.
        gaits: for each leg the states of the last cycle, "" without a cycle.
        work: of the actuator per cycle [J].
        stopped: reason of an early end, "" without one.
    """

    advance: float
    sideways: float
    turn: float
    gaits: tuple[str, ...]
    work: float
    stopped: str

    @classmethod
    def of(cls, walk: Walk) -> "Trial":
        """The trial of a walk."""
        late, nothing = slice(min(1, walk.cycles - 1), None), float("nan")
        each = (walk.advance, walk.sideways, walk.turn)
        return cls(
            *(float(values[late].mean()) if walk.cycles else nothing for values in each),
            gaits=tuple(gaits[-1] if gaits else "" for gaits in walk.gaits.values()),
            work=walk.work / walk.cycles if walk.cycles else nothing,
            stopped=walk.stopped,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Sweep(base.ByValue, base.Drawn):
    """Results of many robots: `values` (n,) by the parameter's name, and (n,) `trials`.

    `arena` is the title of the arena, "" for a bare floor.
    """

    values: Mapping[str, Sequence[float]] = field(repr=False)
    trials: tuple[Trial, ...] = field(repr=False)
    arena: str = ""

    def to_xarray(self) -> "xr.Dataset":
        """A data set with one row per trial, with units."""
        base.need("tables")
        import xarray as xr

        columns: dict[str, xr.Variable] = {
            name: xr.Variable("trial", np.asarray(values)) for name, values in self.values.items()
        }
        for q in TRIAL[:4]:
            columns[q.name] = xr.Variable("trial", np.array(self._all(q)), {"units": q.si})
        gaits = np.array([trial.gaits for trial in self.trials], dtype=str)
        columns["gait"] = xr.Variable(("trial", "leg"), gaits.reshape(len(self.trials), -1))
        stopped = np.array([trial.stopped for trial in self.trials], dtype=str)
        columns["stopped"] = xr.Variable("trial", stopped)
        return xr.Dataset(columns)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write one line per trial, with units in the headings; raises `OSError` on failure."""
        *numbers, gaits, stopped = TRIAL
        legs = enumerate(zip(*self._all(gaits), strict=True), 1)
        given = self.values.items()
        columns = [
            *((base.Quantity(name), [repr(float(v)) for v in values]) for name, values in given),
            *((q, self._all(q)) for q in numbers),
            *((base.Quantity(f"gait_{i}"), list(each)) for i, each in legs),
            (stopped, self._all(stopped)),
        ]
        base.write_csv(path, columns, 6)

    def _all(self, quantity: base.Quantity) -> list[Any]:
        return [quantity.of(trial) for trial in self.trials]

    def __repr__(self):
        names = ", ".join(self.values)
        failed = sum(bool(trial.stopped) for trial in self.trials)
        ended = f", {failed} stopped early" if failed else ""
        return f"Sweep({len(self.trials)} robots over {names or 'nothing'}{ended})"


def sweep(
    robots: Sequence[Robot],
    *,
    values: Mapping[str, Sequence[float]] | None = None,
    arenas: Sequence[Arena] | None = None,
    cycles: int = 4,
    settings: Settings | None = None,
    threads: int | None = None,
    keep: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Simulate walks of many robots, on a bare floor or in arenas, in parallel on all cores.

    Args:
        robots: (n,) robots.
        values: varied parameters by name, (n,) numbers each; only stored in the result.
        arenas: (n,) arena of each robot; a bare floor by default. Walks do not end at a goal.
        cycles: of each walk, >= 1.
        settings: of the simulation.
        threads: number of parallel runs; all cores by default.
        keep: folder for finished robots; to resume an interrupted sweep, call it again with the
            same robots.
        progress: called with (done, total) robots.

    Returns:
        Results of the robots, in the order given; they do not depend on the number of threads.

    Raises:
        ValueError: no cycles, values or arenas of other lengths, or a folder that holds another
            sweep.
        ModuleNotFoundError: MuJoCo is not installed.
        OSError: the folder cannot be written.
    """
    settings = settings or Settings()
    values = dict(values or {})
    _require_usable(values, len(robots), arenas, cycles)
    threads = threads or cores()
    entries = list(zip(robots, arenas or [None] * len(robots), strict=True))
    kept = _Kept(keep, entries, cycles, settings) if keep is not None else None
    trials: dict[int, Trial] = kept.trials() if kept is not None else {}
    missing = [i for i in range(len(robots)) if i not in trials]
    for first in range(0, len(missing), PER_CORE * threads):
        batch = missing[first : first + PER_CORE * threads]
        step = partial(_step_together, threads=threads)
        walks = walked([SimulatedRun(*entries[i], settings) for i in batch], cycles, step)
        trials |= (new := dict(zip(batch, map(Trial.of, walks), strict=True)))
        if kept is not None:
            kept.add(new)
        base.notify(progress, len(trials), len(robots))
    title = (arenas[0].title or "without a name") if arenas else ""
    return Sweep(values, tuple(trials[i] for i in range(len(robots))), title)


def _require_usable(
    values: Mapping[str, Sequence[float]], count: int, arenas: Sequence[Arena] | None, cycles: int
) -> None:
    """Refuse no cycles, too many robots, and values or arenas of another number than `count`."""
    if cycles < 1:
        raise base.InputError(f"cycles = {cycles}: must be >= 1.")
    for name, numbers in values.items():
        if len(numbers) != count:
            raise base.InputError(
                f"values[{name!r}] has {len(numbers)} numbers: must have {count}, one per robot."
            )
    if arenas is not None and len(arenas) != count:
        raise base.InputError(f"arenas has {len(arenas)} arenas: must have {count}.")
    base.require("robots", count, "these are")


def walked(
    runs: Sequence[SimulatedRun], cycles: int, step: Callable[[Sequence[SimulatedRun], float], None]
) -> list[Walk]:
    """The walk of every run; models of one size are stepped together.

    `step` advances runs from their start to a time [s].
    """
    alike: dict[tuple[int, ...], list[SimulatedRun]] = {}
    for run in runs:
        period = run.robot.drive.period
        run.require_affordable(cycles * period)
        key = (*(getattr(run.model, size) for size in _SIZES), round(period * 1e9))
        alike.setdefault(key, []).append(run)
    for group in alike.values():
        step(group, cycles * group[0].robot.drive.period)
    return [recorded(run) for run in runs]


def _step_together(runs: Sequence[SimulatedRun], end: float, threads: int) -> None:
    """Step runs with models of one size to this time [s], on all threads."""
    models = [run.model for run in runs]
    data = [mujoco.MjData(models[0]) for _ in range(min(threads, len(runs)))]
    state = np.stack([run.state for run in runs])
    total = round((end - runs[0].now) / runs[0].settings.time_step)
    with quietly(), rollout.Rollout(nthread=len(data)) as pool:
        for first in range(0, total, CHUNK):
            steps = min(CHUNK, total - first)
            command = np.stack([run.command(steps) for run in runs])[:, :, None]
            states, readings = pool.rollout(models, data, state, command)
            state = states[:, -1].copy()
            for run, taken, read in zip(runs, states, readings, strict=True):
                run.take(taken, read)


class _Kept:
    """Finished trials in a folder, one file for every batch."""

    def __init__(
        self,
        folder: str | os.PathLike[str],
        entries: Sequence[tuple[Robot, Arena | None]],
        cycles: int,
        given: Settings,
    ):
        self.folder = Path(folder)
        prints = [_fingerprint(*entry) for entry in entries]
        text = repr((base.__version__, cycles, given, prints))
        request = hashlib.sha256(text.encode()).hexdigest()
        self.folder.mkdir(parents=True, exist_ok=True)
        note = self.folder / "sweep.json"
        if not note.exists():
            base.write_atomic(note, json.dumps({"request": request, "robots": len(entries)}) + "\n")
        elif json.loads(note.read_text("utf-8")).get("request") != request:
            raise base.InputError(
                f"{self.folder} holds another sweep (other robots, cycles or settings); use "
                f"another folder, or remove this one."
            )

    def trials(self) -> dict[int, Trial]:
        return {
            int(number): Trial(**(trial | {"gaits": tuple(trial["gaits"])}))
            for file in sorted(self.folder.glob("part-*.json"))
            for number, trial in json.loads(file.read_text("utf-8")).items()
        }

    def add(self, trials: Mapping[int, Trial]) -> None:
        record = {number: asdict(trial) for number, trial in trials.items()}
        base.write_atomic(self.folder / f"part-{min(trials):06d}.json", json.dumps(record) + "\n")


def _fingerprint(robot: Robot, arena: Arena | None) -> str:
    """All inputs of a robot's walk, as text."""
    parts = (robot.legs, robot.body, robot.foot, robot.blocks, robot.floor, robot.drive)
    cells = [
        [(cell.bands, cell.lever, cell.limit, cell.friction) for cell in leg.chain.levers]
        for leg in robot.legs
    ]
    made = (
        []
        if robot.made is None
        else [
            (name, array.tobytes())
            for shape in robot.made.shapes
            for name, array in ((shape.body, shape.vertices), (str(shape.collides), shape.faces))
        ]
    )
    masses = [] if robot.made is None else robot.made.masses
    where = [] if arena is None else [asdict(arena)]
    return repr((parts, cells, robot.antennas, *([made, masses] if made else []), *where))
