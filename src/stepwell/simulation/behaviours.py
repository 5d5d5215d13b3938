"""Robots with a compiled behaviour, simulated: walks row by row of the table, and arenas."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from stepwell.base import ByValue, Drawn, Progress, notify
from stepwell.robot import (
    CURVE,
    TURNS,
    WALKS,
    Action,
    Arena,
    BehaviourRow,
    Compiled,
    CompiledDesign,
    Robot,
    RobotBehaviour,
    RowMargin,
    rows_of,
)
from stepwell.simulation.mazes import Maze, mazes
from stepwell.simulation.simulator import Settings
from stepwell.simulation.sweeps import Trial, sweep

CYCLES = 4
# Turn in a cycle of a curve in the simulation [rad]: that of the closed form, and 1° more or less.
CURVES = (CURVE[0] - math.radians(1.0), CURVE[1] + math.radians(1.0))


@dataclass(frozen=True, slots=True, eq=False)
class RowTrial(ByValue):
    """A walk with the antennas of one row pressed all the time: the row and the trial."""

    row: BehaviourRow
    trial: Trial

    @property
    def right(self) -> bool:
        """Whether the robot moves as the row says: see `moves_as`."""
        return moves_as(self.row.motion, self.trial)


def moves_as(action: Action, trial: Trial) -> bool:
    """Whether the mean motion per cycle is that of an action.

    A robot walks from 0.1 u_max per cycle on, and turns from 3° per cycle on. A curve is a walk
    that turns by 1.5° to 7° per cycle.
    """
    if trial.stopped or not math.isfinite(trial.advance):
        return False
    way = (trial.advance > WALKS) - (trial.advance < -WALKS)
    side = (trial.turn > TURNS) - (trial.turn < -TURNS)
    if action is Action.ANY:
        return True
    if action.curve:
        return way > 0 and CURVES[0] <= action.curve * trial.turn <= CURVES[1]
    if action in (Action.TURN_LEFT, Action.VEER_LEFT):
        return side > 0
    if action in (Action.TURN_RIGHT, Action.VEER_RIGHT):
        return side < 0
    if action in (Action.BACK_LEFT, Action.BACK_RIGHT):
        return way < 0 and (side > 0) == (action is Action.BACK_LEFT) and side != 0
    wanted = {Action.FORWARD: 1, Action.BACKWARD: -1, Action.STOP: 0}
    return not side and way == wanted[action]


def behaviour_trials(
    behaviour: RobotBehaviour,
    robots: Sequence[Robot],
    *,
    cycles: int = CYCLES,
    settings: Settings | None = None,
    threads: int | None = None,
) -> tuple[tuple[RowTrial, ...], ...]:
    """Simulate walks of robots on a flat floor, for each contact of a behaviour.

    Args:
        behaviour: the table.
        robots: (n,) robots with the antennas of the table.
        cycles: of each walk, >= 1; the first one does not count.
        settings: of the simulation.
        threads: number of parallel runs; all cores by default.

    Returns:
        (n,) trials of all rows of the table.

    Raises:
        ValueError: no cycles, or a robot without these antennas.
        ModuleNotFoundError: MuJoCo is not installed.
    """
    walks = [
        robot.pressed({name: swings[name] for name in behaviour.touched(row.contact)})
        for robot in robots
        for swings in [{one.name: one.swing for one in robot.antennas}]
        for row in behaviour.rows
    ]
    trials = sweep(walks, cycles=cycles, settings=settings, threads=threads).trials
    count = len(behaviour.rows)
    return tuple(
        tuple(map(RowTrial, behaviour.rows, trials[first : first + count]))
        for first in range(0, len(trials), count)
    )


@dataclass(frozen=True, slots=True, eq=False)
class CompiledRobot(ByValue, Drawn):
    """The result of a compiler: designs in closed form, and their simulated walks.

    Attributes:
        compiled: the designs, or the rows that exclude each other.
        trials: rows of each design that was simulated, in the order of `compiled.designs`; the
            last one has all rows, if any has.
        arenas: runs of the chosen design through arenas.
        made: the chosen robot with the masses of its parts; None if they were not given.
        made_rows: margins of its rows.
        made_trials: its walks.
    """

    compiled: Compiled
    trials: tuple[tuple[RowTrial, ...], ...]
    arenas: tuple[Maze, ...] = ()
    made: Robot | None = None
    made_rows: tuple[RowMargin, ...] = ()
    made_trials: tuple[RowTrial, ...] = ()

    @property
    def verified(self) -> bool:
        """Whether a design has all rows in the simulation too."""
        return bool(self.trials) and all(row.right for row in self.trials[-1])

    @property
    def design(self) -> CompiledDesign | None:
        """The first design with all rows in the simulation; else the first one, if any."""
        designs = self.compiled.designs
        return designs[len(self.trials) - 1 if self.verified else 0] if designs else None

    @property
    def walked(self) -> tuple[RowTrial, ...]:
        """The walks of `design`; empty if it was not simulated."""
        return self.trials[-1 if self.verified else 0] if self.trials else ()

    @property
    def robot(self) -> Robot:
        """The robot of `design`; without one the given robot."""
        return self.compiled.behaviour.robot if self.design is None else self.design.robot

    def in_arenas(
        self, arenas: Sequence[Arena], *, limit: float = 600.0, progress: Progress | None = None
    ) -> CompiledRobot:
        """The same result with runs of its robot through arenas, each up to `limit` [s]."""
        entries = [(self.robot, arena) for arena in arenas]
        return replace(self, arenas=mazes(entries, limit=limit, progress=progress))

    def with_parts(self, made: Robot) -> CompiledRobot:
        """The same result with margins and walks of its robot as made, from a build of it."""
        behaviour, design = self.compiled.behaviour, self.design
        if design is None:
            return self
        rows = rows_of(behaviour, made, design.places.wiring)
        (trials,) = behaviour_trials(behaviour, [made])
        return replace(self, made=made, made_rows=rows, made_trials=trials)

    def __repr__(self):
        verdict = "verified" if self.verified else "not verified"
        return f"CompiledRobot({self.compiled!r}, {verdict} by {len(self.trials)} simulated)"


def verified(
    compiled: Compiled, *, most: int = 5, progress: Progress | None = None
) -> CompiledRobot:
    """Simulate the designs of a compiler one by one, until one of them has all rows.

    Args:
        compiled: the result in closed form.
        most: largest number of simulated designs; 0 simulates none.
        progress: called with (done, total) designs.

    Raises:
        ModuleNotFoundError: MuJoCo is not installed.
    """
    trials: list[tuple[RowTrial, ...]] = []
    designs = compiled.designs[:most]
    for design in designs:
        trials += behaviour_trials(compiled.behaviour, [design.robot])
        notify(progress, len(trials), len(designs))
        if all(row.right for row in trials[-1]):
            break
    return CompiledRobot(compiled, tuple(trials))
