"""Trials of a behaviour: walks of a robot with its antennas pressed, row by row of the table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from stepwell.base import ByValue
from stepwell.robot import TURNS, WALKS, Action, Behaviour, Robot, Row
from stepwell.simulation.simulator import Settings
from stepwell.simulation.sweeps import Trial, sweep

CYCLES = 4


@dataclass(frozen=True, slots=True, eq=False)
class RowTrial(ByValue):
    """A walk with the antennas of one row pressed all the time: the row and the trial."""

    row: Row
    trial: Trial

    @property
    def right(self) -> bool:
        """Whether the robot moves as the row says: see `moves_as`."""
        return moves_as(self.row.motion, self.trial)


def moves_as(action: Action, trial: Trial) -> bool:
    """Whether the mean motion per cycle is that of an action.

    A robot walks from 0.1 u_max per cycle on, and turns from 3° per cycle on.
    """
    if trial.stopped or not math.isfinite(trial.advance):
        return False
    way = (trial.advance > WALKS) - (trial.advance < -WALKS)
    side = (trial.turn > TURNS) - (trial.turn < -TURNS)
    if action is Action.ANY:
        return True
    if action in (Action.TURN_LEFT, Action.VEER_LEFT):
        return side > 0
    if action in (Action.TURN_RIGHT, Action.VEER_RIGHT):
        return side < 0
    wanted = {Action.FORWARD: 1, Action.BACKWARD: -1, Action.STOP: 0}
    return not side and way == wanted[action]


def behaviour_trials(
    behaviour: Behaviour,
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
