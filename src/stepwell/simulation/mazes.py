"""Runs in an arena: the walk, contacts with obstacles, and changes of gait."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from threading import Event
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Drawn, InputError, brief, notify
from stepwell.kernels import cores
from stepwell.robot import Arena, Robot
from stepwell.simulation.arenas.surroundings import obstacle_names
from stepwell.simulation.engine import SimulatedRun
from stepwell.simulation.simulator import Settings
from stepwell.simulation.walks import Walk, recorded

TOUCHED = 1e-3  # an obstacle that carries more than this [N] has been touched
PRESSED = 0.05  # an antenna turned by more than this fraction of its swing is pressed
APART = 1.0  # presses within this time [s] count as one
FREE_FOR = 10  # cycles at the end of a run that decide whether it walks on ...
STEADY = np.radians(5.0)  # ... with a heading that varies by no more than this [rad] ...
ADVANCING = 0.4  # ... and this much of u_max or more a cycle [1]
STUCK_FOR = 120.0  # a robot that stays this long [s] ...
STUCK_WITHIN = 0.060  # ... within this distance [m] is trapped


class Outcome(Enum):
    """Outcome of a run in an arena."""

    REACHED = "reached the goal"
    TIMED_OUT = "ran out of time"
    TRAPPED = "kept moving without advance"
    STOPPED = "stopped early"

    def __str__(self):
        return self.value


class Contact(NamedTuple):
    """A contact that presses an antenna.

    Attributes:
        antenna: its name.
        begin, end: start and end of the contact [s].
        swing, moved: largest rotation [rad], and displacement of the anchor there [m]; 0 if the
            antenna is disconnected.
    """

    antenna: str
    begin: float
    end: float
    swing: float
    moved: float

    def __repr__(self):
        return brief(self)


class GaitChange(NamedTuple):
    """A change of gait of a leg: time [s], leg, gait before and after."""

    time: float
    leg: str
    before: str
    after: str

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, slots=True, eq=False)
class Maze(ByValue, Drawn):
    """A run of a robot in an arena: all samples, the outcome, and the time limit [s]."""

    walk: Walk
    arena: Arena
    outcome: Outcome
    limit: float

    @property
    def touched(self) -> dict[str, float | None]:
        """Time of the first contact with each obstacle [s], None without one; walls first."""
        forces = self.walk.obstacle_force > TOUCHED
        return {
            name: float(self.walk.time[forces[:, i].argmax()]) if forces[:, i].any() else None
            for i, name in enumerate(obstacle_names(self.arena))
        }

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """All contacts of the antennas, by start."""
        contacts: list[Contact] = []
        for i, antenna in enumerate(self.walk.robot.antennas):
            swing = self.walk.antenna[:, i]
            for first, last in _stretches(self.walk.time, swing > PRESSED * antenna.swing):
                begin, end = self.walk.time[[first, last]]
                most = float(swing[first : last + 1].max())
                moved = most * antenna.gear if antenna.connected else 0.0
                contacts.append(Contact(antenna.name, float(begin), float(end), most, moved))
        return tuple(sorted(contacts, key=lambda contact: contact.begin))

    @property
    def changes(self) -> tuple[GaitChange, ...]:
        """All changes of a leg's gait from one cycle to the next, at the start of the later one."""
        period = self.walk.robot.drive.period
        changes = (
            GaitChange(i * period, leg, before, after)
            for leg, gaits in self.walk.gaits.items()
            for i, (before, after) in enumerate(pairwise(gaits), 1)
            if after != before
        )
        return tuple(sorted(changes, key=lambda change: change.time))

    @property
    def walks_on(self) -> bool:
        """Whether it ended free: antennas at rest, steady heading, and advance.

        That is, over the last ten cycles no antenna was turned by more than a twentieth of its
        swing, the heading stayed within 5°, and the advance was at least 2/5 of u_max per cycle.
        """
        walk = self.walk
        if walk.stopped or walk.cycles < FREE_FOR:
            return False
        late = walk.time >= walk.time[-1] - FREE_FOR * walk.robot.drive.period
        most = np.array([antenna.swing for antenna in walk.robot.antennas])
        pressed = (walk.antenna[late] > PRESSED * most).any()
        ends = np.hypot(np.diff(walk.x[late][[0, -1]]), np.diff(walk.y[late][[0, -1]]))[0]
        step = ends / FREE_FOR / walk.robot.u_max
        return bool(not pressed and np.ptp(walk.yaw[late]) <= STEADY and step >= ADVANCING)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.walk.duration

    @property
    def end(self) -> tuple[float, float] | None:
        """Position at the end [m]; None for a run that ended before its first sample."""
        walk = self.walk
        return (float(walk.x[-1]), float(walk.y[-1])) if len(walk.time) else None

    @property
    def ending(self) -> str:
        """How and when it ended; without a goal, the turn at the last obstacle, if any."""
        if self.outcome is Outcome.TIMED_OUT and self.arena.goal is None:
            return self._turn() or f"walked for {self.duration:.0f} s, no goal in the arena"
        ending = f"{self.outcome} after {self.duration:.0f} s"
        if self.outcome is Outcome.REACHED or self.arena.goal is None or self.end is None:
            return ending
        distance = math.dist(self.end, self.arena.goal.at)
        return f"{ending}, {distance:.2f} m from the centre of the goal"

    def _turn(self) -> str:
        """The turn away from the last obstacle; "" without one."""
        walk, loaded = self.walk, self.walk.obstacle_force > TOUCHED
        if not (self.contacts and loaded.any()):
            return ""
        last = int(np.argwhere(loaded)[-1, 1])
        turn = float(np.degrees(walk.yaw[-1] - walk.yaw[loaded[:, last].argmax()]))
        free, side = max(one.end for one in self.contacts), "left" if turn > 0 else "right"
        text = f"away from {obstacle_names(self.arena)[last]} ({abs(turn):.0f}° to the {side})"
        if free < walk.time[-1] - APART:
            text = f"turned {text} at {free:.0f} s"
        else:
            text = f"turning {text} after {walk.duration:.0f} s"
        return text if abs(turn) > np.degrees(STEADY) else ""

    def __repr__(self):
        touched = sum(time is not None for time in self.touched.values())
        return (
            f"Maze({self.arena.title or 'arena'}: {self.ending}, "
            f"{touched} of {len(self.touched)} obstacles touched)"
        )


class Judge:
    """Decides the outcome of a run in progress; None until it ends."""

    def __init__(self, arena: Arena):
        self.outcome: Outcome | None = None
        self._goal = arena.goal
        self._places: list[tuple[float, float, float]] = []

    def look(self, run: SimulatedRun) -> Outcome | None:
        """Check a run at its present state: its outcome, None if it has not ended."""
        # The full state begins with the time and the body's place.
        x, y = float(run.state[1]), float(run.state[2])
        self._places.append((run.now, x, y))
        if run.stopped:
            self.outcome = Outcome.STOPPED
        elif self._goal is not None and self._goal.reached(x, y):
            self.outcome = Outcome.REACHED
        elif self._stuck():
            self.outcome = Outcome.TRAPPED
        return self.outcome

    def _stuck(self) -> bool:
        now, x, y = self._places[-1]
        if now - self._places[0][0] < STUCK_FOR:
            return False
        recent = np.array([place for place in self._places if now - place[0] <= STUCK_FOR])
        return bool((np.hypot(recent[:, 1] - x, recent[:, 2] - y) < STUCK_WITHIN).all())


def maze(
    robot: Robot,
    arena: Arena,
    *,
    limit: float = 600.0,
    settings: Settings | None = None,
    progress: Callable[[float, float], None] | None = None,
    look: Callable[[Callable[[], Walk]], None] | None = None,
) -> Maze:
    """Simulate a robot in an arena until it reaches the goal, is trapped or the time is over.

    `look` is as for `walk`. All else as for `Robot.maze`.
    """
    if not limit > 0:
        raise InputError(f"limit = {limit} s: must be > 0.")
    run, judge = SimulatedRun(robot, arena, settings or Settings()), Judge(arena)
    for now in run.chunks(limit):
        notify(progress, max(now, 0.0), limit)
        if look is not None:
            look(lambda: recorded(run))
        if judge.look(run) is not None:
            break
    outcome = judge.outcome or Outcome.TIMED_OUT
    return Maze(recorded(run), arena, outcome, limit)


def mazes(
    entries: Sequence[tuple[Robot, Arena]],
    *,
    limit: float = 600.0,
    settings: Settings | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Maze, ...]:
    """Simulate many robots in many arenas, in parallel on all cores.

    Args:
        entries: (n,) robot and arena.
        limit: simulated time of each [s], > 0.
        settings: of the simulation.
        threads: number of parallel runs; all cores by default.
        progress: called with (done, total) entries.

    Returns:
        (n,) results and errors as those of `maze`.
    """
    # The time stepping releases Python's lock, so threads are enough.
    stop = Event()

    def stop_if_asked(_now: float, _limit: float) -> None:
        if stop.is_set():
            raise KeyboardInterrupt

    with ThreadPoolExecutor(threads or cores()) as pool:
        ways = [
            pool.submit(maze, robot, arena, limit=limit, settings=settings, progress=stop_if_asked)
            for robot, arena in entries
        ]
        waiting = set(ways)
        try:
            while waiting:
                finished, waiting = wait(waiting, 0.1, FIRST_COMPLETED)
                if progress is not None and finished:
                    progress(len(ways) - len(waiting), len(ways))
        except BaseException:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise
        return tuple(way.result() for way in ways)


def _stretches(time: np.ndarray, held: np.ndarray) -> list[tuple[int, int]]:
    """First and last sample of every stretch in which `held` is true, short gaps bridged."""
    samples = np.flatnonzero(held)
    parts = np.split(samples, np.flatnonzero(np.diff(time[samples]) > APART) + 1)
    return [(int(part[0]), int(part[-1])) for part in parts if len(part)]
