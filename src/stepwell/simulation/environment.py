"""A robot in an arena as an environment of Gymnasium: the action is the stroke."""

from dataclasses import dataclass, replace
from enum import StrEnum
from importlib import import_module
from math import ceil, dist
from typing import Any, ClassVar

import numpy as np

from stepwell.base import ByValue, Floats, InputError, check, need
from stepwell.robot import Arena, Robot, other_start
from stepwell.simulation.arenas.surroundings import obstacle_names
from stepwell.simulation.drawing import Camera, DrawingProcess, Frame, view_angles
from stepwell.simulation.engine import SimulatedRun
from stepwell.simulation.model import spec
from stepwell.simulation.simulator import Settings

need("env")
gymnasium: Any = import_module("gymnasium")

ID = "stepwell/Robot-v0"
FAR = 100.0  # largest coordinate in an observation [m]
FORCE = 100.0  # largest force in an observation [N]
AROUND = 0.35  # what a rendered picture shows round the robot [m]


class Reward(StrEnum):
    """What an environment rewards, over u_max, the largest step of the legs [1]."""

    GOAL = "goal"
    ADVANCE = "advance"


@dataclass(frozen=True, slots=True, eq=False)
class Episode(ByValue):
    """Options of an environment; a `ValueError` refuses values out of range.

    Args:
        reward: "goal" for the decrease of the distance to the goal, "advance" for the displacement
            along the heading at the start, both over u_max; by default "goal" in an arena with
            a goal.
        interval: time between two actions [s], > 0, a multiple of the time step.
        limit: time after which an episode is truncated [s], > 0.
        random_start: shift the start by up to 40 mm and 10° at each reset, as `other_start`.
        size: width and height of rendered pictures [pixels].
        settings: of the simulation.
    """

    reward: Reward | str | None = None
    interval: float = 0.1
    limit: float = 600.0
    random_start: bool = False
    size: tuple[int, int] = (480, 270)
    settings: Settings = Settings()

    def __post_init__(self):
        check.fields(self, check.positive, interval="s", limit="s")
        if self.reward is not None:
            check.fields(self, check.one_of, reward=Reward)
        steps = self.interval / self.settings.time_step
        if abs(steps - round(steps)) > 1e-6 or steps < 1:
            raise InputError(
                f"interval = {self.interval:g} s: must be a multiple of the time step, "
                f"{self.settings.time_step:g} s."
            )

    @property
    def steps(self) -> int:
        """Time steps between two actions."""
        return round(self.interval / self.settings.time_step)


class RobotEnv(gymnasium.Env):
    """A robot in an arena as an environment of Gymnasium.

    Action: one number from -1, no stroke, to 1, the full stroke. The command moves towards it at
    the speed of the robot's own drive, 2 amplitude / period, at most.

    Observation: a vector of the quantities that `names` lists with their units; all are bounded.

    An episode is terminated at the goal, or when the robot falls over or the simulation becomes
    unstable; it is truncated at the time limit. `info` has `time` [s] and `outcome`, the reason of
    the termination or "".

    Args:
        robot: any robot.
        arena: obstacles, start and goal; a bare floor by default.
        render_mode: "rgb_array" for pictures by `render`, None for none.
        episode: arguments of `Episode`.

    Raises:
        ValueError: an unknown render mode, a reward "goal" without a goal, or as for `Episode`.
        ExtraError: Gymnasium is not installed.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(
        self,
        robot: Robot,
        arena: Arena | None = None,
        *,
        render_mode: str | None = None,
        **episode: Any,
    ):
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError(f"render_mode = {render_mode!r}: must be 'rgb_array' or None.")
        self.robot, self.arena, self.render_mode = robot, arena or Arena(), render_mode
        self.episode = Episode(**episode)
        self.goal = self.arena.goal
        usual = Reward.GOAL if self.goal else Reward.ADVANCE
        self.reward = Reward(self.episode.reward or usual)
        if self.reward is Reward.GOAL and self.goal is None:
            raise InputError("reward = 'goal': this arena has no goal; use reward = 'advance'.")
        given = self.episode.settings
        interval = self.episode.steps * given.time_step
        settle = ceil(given.settle / interval - 1e-9) * interval
        self._settings = replace(given, sample=interval, settle=settle)
        quantities = self._quantities()
        self.names = tuple(quantities)
        low, high = np.array([*quantities.values()], np.float32).T
        box = gymnasium.spaces.Box
        self.observation_space = box(low, high, dtype=np.float32)
        self.action_space = box(-1.0, 1.0, (1,), np.float32)
        self._run: SimulatedRun | None = None
        self._drawing: DrawingProcess | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode: the robot at rest with every cell in state 0, stroke 0."""
        super().reset(seed=seed)
        arena = self.arena
        if self.episode.random_start:
            arena = other_start(arena, int(self.np_random.integers(2**31)))
        self._run = run = SimulatedRun(self.robot, arena, self._settings)
        run.advance(0.0)
        self._command, self._sample = 0.0, self._readings(run)
        self._begin = self._place()
        return self._observation(), {"time": 0.0, "outcome": ""}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Move the command towards an action for one interval."""
        run, drive = self._started(), self.robot.drive
        share = (float(np.clip(np.asarray(action).ravel()[0], -1.0, 1.0)) + 1.0) / 2.0
        change = share * drive.amplitude - self._command
        # A command is that at the beginning of its time step.
        moved = np.arange(self.episode.steps + 1) * self._settings.time_step
        moved *= 2.0 * drive.amplitude / drive.period
        commands = self._command + np.clip(change, -moved, moved)
        before, self._command = self._place(), float(commands[-1])
        run.advance(run.now + self._settings.sample, commands[:-1])
        if not run.stopped:
            self._sample = self._readings(run)
        x, y, _ = self._place()
        reached = self.goal is not None and self.goal.reached(x, y)
        outcome = run.stopped or ("reached the goal" if reached else "")
        late = run.now >= self.episode.limit - self._settings.time_step / 2
        info = {"time": float(run.now), "outcome": outcome}
        return self._observation(), self._gain(before), bool(outcome), late and not outcome, info

    def render(self) -> Frame | None:
        """A picture of the present position (height, width, 3), None without a render mode."""
        if self.render_mode is None:
            return None
        run = self._started()
        if self._drawing is None:
            sides = AROUND * np.array([[-1, -1, 0], [1, -1, 0], [-1, 1, 0], [1, 1, 0]])
            camera = Camera(self.episode.size, view_angles((90.0, -62.0)), lit=2 * AROUND)
            model = spec(run.robot, run.arena, run.settings).compile()
            self._drawing = DrawingProcess(model, [camera.round(sides)])
        # The full state begins with the time and the joint positions.
        return self._drawing.frames(run.state[1 : 1 + run.model.nq])[0].copy()

    def close(self) -> None:
        """End the process that draws."""
        if self._drawing is not None:
            self._drawing.close()
            self._drawing = None

    def _started(self) -> SimulatedRun:
        if self._run is None:
            raise InputError("the episode has not begun: call reset() first.")
        return self._run

    def _readings(self, run: SimulatedRun) -> Floats:
        """The last sample: forces are means over the interval."""
        return run._data[-1][-1]

    def _read(self, name: str) -> Floats:
        return self._sample[self._started().where[name]]

    def _place(self) -> tuple[float, float, float]:
        """Position (x, y) [m] and heading [rad]."""
        (x, y, _), (w, i, j, k) = self._read("body.position"), self._read("body.attitude")
        return float(x), float(y), float(np.arctan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k)))

    def _gain(self, before: tuple[float, float, float]) -> float:
        x, y, _ = self._place()
        if self.reward is Reward.GOAL and self.goal is not None:
            gain = dist(before[:2], self.goal.at) - dist((x, y), self.goal.at)
        else:
            heading = self._begin[2]
            gain = (x - before[0]) * np.cos(heading) + (y - before[1]) * np.sin(heading)
        return float(gain / self.robot.u_max)

    def _quantities(self) -> dict[str, tuple[float, float]]:
        """Name with unit, and both bounds, of every number of an observation."""
        robot, stroke = self.robot, self.robot.drive.amplitude
        legs = {
            f"{leg.name}.{cell} travel over full travel [1]": (-1.0, 2.0)
            for leg in robot.legs
            for cell in leg.chain.names
        }
        feet = {f"{leg.name} foot force [N]": (0.0, FORCE) for leg in robot.legs}
        angles = {f"{one.name} antenna [rad]": (-1.0, one.swing + 1.0) for one in robot.antennas}
        touch = {f"{one.name} antenna force [N]": (0.0, FORCE) for one in robot.antennas}
        goal = ("goal ahead [m]", "goal to the left [m]") if self.goal else ()
        return {
            "stroke [m]": (-stroke, 2.0 * stroke),
            "x [m]": (-FAR, FAR),
            "y [m]": (-FAR, FAR),
            "cosine of heading [1]": (-1.0, 1.0),
            "sine of heading [1]": (-1.0, 1.0),
            **dict.fromkeys(goal, (-2 * FAR, 2 * FAR)),
            **legs,
            **feet,
            **angles,
            **touch,
        } | ({"obstacle force [N]": (0.0, FORCE)} if obstacle_names(self.arena) else {})

    def _observation(self) -> np.ndarray:
        robot, (x, y, heading) = self.robot, self._place()
        turn = np.array([np.cos(heading), np.sin(heading)])
        parts = [self._read("stroke"), np.array([x, y]), turn]
        if self.goal is not None:
            away = np.subtract(self.goal.at, (x, y))
            parts.append(np.array([away @ turn, away @ [-turn[1], turn[0]]]))
        for leg in robot.legs:
            travels = [self._read(f"{leg.name}.{cell}.travel") for cell in leg.chain.names]
            parts.append(np.concatenate(travels) / leg.chain.full_travels)
        parts += [self._read(f"{leg.name}.sole") for leg in robot.legs]
        parts += [self._read(f"{one.name}.antenna") for one in robot.antennas]
        parts += [self._read(f"{one.name}.feeler") for one in robot.antennas]
        if names := obstacle_names(self.arena):
            parts.append(np.array([sum(float(self._read(name)[0]) for name in names)]))
        space = self.observation_space
        return np.clip(np.concatenate(parts), space.low, space.high).astype(np.float32)


def make_env(
    robot: Robot, arena: Arena | None = None, *, render_mode: str | None = None, **episode: Any
) -> Any:
    """A `RobotEnv` with the usual wrappers of Gymnasium, such as the check of the order of calls.

    Arguments and errors as for `RobotEnv`. Its id is "stepwell/Robot-v0".
    """
    return gymnasium.make(ID, robot=robot, arena=arena, render_mode=render_mode, **episode)


if ID not in gymnasium.registry:
    gymnasium.register(ID, entry_point=f"{__name__}:RobotEnv")
