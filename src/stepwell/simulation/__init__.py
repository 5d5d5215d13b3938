"""Simulation in MuJoCo: walks, arenas, jumps, sweeps, videos, exports, environments."""

from typing import TYPE_CHECKING

from stepwell.base import late
from stepwell.simulation.arenas.surroundings import HEIGHT, obstacle_names
from stepwell.simulation.behaviours import CompiledRobot, RowTrial, behaviour_trials, verified
from stepwell.simulation.comparison import (
    Convergence,
    GaitComparison,
    Resolution,
    compare_gaits,
    convergence,
)
from stepwell.simulation.drawing import VideoError, drawing_system, view_angles
from stepwell.simulation.exports import exchange, mjcf, sdf
from stepwell.simulation.hoppers.jumps import HalvedStep, Jump, RecordFactor, jump
from stepwell.simulation.hoppers.run import EnergyFlow, Hop, JumpSettings
from stepwell.simulation.hoppers.video import jump_video
from stepwell.simulation.mazes import TOUCHED, Contact, GaitChange, Maze, Outcome, maze, mazes
from stepwell.simulation.model import spec
from stepwell.simulation.simulator import Integrator, Linkage, Settings, mujoco
from stepwell.simulation.sweeps import Sweep, Trial, sweep
from stepwell.simulation.videos import picture, video
from stepwell.simulation.walks import LOADED, Walk, walk
from stepwell.simulation.worlds import device, screen_mazes, screen_walks

if TYPE_CHECKING:
    from stepwell.simulation.environment import Episode, Reward, RobotEnv, make_env

__all__ = [
    "GaitChange",
    "CompiledRobot",
    "Contact",
    "Episode",
    "GaitComparison",
    "Convergence",
    "EnergyFlow",
    "HalvedStep",
    "Hop",
    "Integrator",
    "Jump",
    "JumpSettings",
    "RecordFactor",
    "Linkage",
    "Maze",
    "Outcome",
    "Resolution",
    "Reward",
    "RobotEnv",
    "RowTrial",
    "Settings",
    "Sweep",
    "Trial",
    "VideoError",
    "Walk",
    "behaviour_trials",
    "compare_gaits",
    "convergence",
    "device",
    "exchange",
    "make_env",
    "maze",
    "mazes",
    "jump",
    "jump_video",
    "mjcf",
    "picture",
    "screen_mazes",
    "screen_walks",
    "sdf",
    "spec",
    "sweep",
    "verified",
    "video",
    "view_angles",
    "walk",
]

# Gymnasium is imported with them.
_LATE = {"environment": ("Episode", "Reward", "RobotEnv", "make_env")}
__getattr__, __dir__ = late("stepwell.simulation", _LATE, __all__)
