"""Simulation of robots in MuJoCo: model, walks, runs in an arena, sweeps, videos."""

from stepwell.simulation.comparison import (
    Convergence,
    GaitComparison,
    Resolution,
    compare_gaits,
    convergence,
)
from stepwell.simulation.exports import exchange, mjcf, sdf
from stepwell.simulation.mazes import TOUCHED, Contact, GaitChange, Maze, Outcome, maze, mazes
from stepwell.simulation.model import HEIGHT, obstacle_names, spec
from stepwell.simulation.simulator import Integrator, Linkage, Settings, mujoco
from stepwell.simulation.sweeps import Sweep, Trial, sweep
from stepwell.simulation.videos import VideoError, drawing_system, video
from stepwell.simulation.walks import LOADED, Walk, walk
from stepwell.simulation.worlds import device, screen_mazes, screen_walks

__all__ = [
    "GaitChange",
    "Contact",
    "GaitComparison",
    "Convergence",
    "Integrator",
    "Linkage",
    "Maze",
    "Outcome",
    "Resolution",
    "Settings",
    "Sweep",
    "Trial",
    "VideoError",
    "Walk",
    "compare_gaits",
    "convergence",
    "device",
    "exchange",
    "maze",
    "mazes",
    "mjcf",
    "screen_mazes",
    "screen_walks",
    "sdf",
    "spec",
    "sweep",
    "video",
    "walk",
]
