"""Simulation of robots in MuJoCo: model, walks, runs in an arena, sweeps, videos."""

from stepwell.simulation.comparison import (
    Convergence,
    GaitComparison,
    Resolution,
    compare_gaits,
    convergence,
)
from stepwell.simulation.drawing import VideoError, drawing_system, view_angles
from stepwell.simulation.exports import exchange, mjcf, sdf
from stepwell.simulation.mazes import TOUCHED, Contact, GaitChange, Maze, Outcome, maze, mazes
from stepwell.simulation.model import HEIGHT, obstacle_names, spec
from stepwell.simulation.simulator import Integrator, Linkage, Settings, mujoco
from stepwell.simulation.sweeps import Sweep, Trial, sweep
from stepwell.simulation.videos import View, picture, video
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
    "View",
    "Walk",
    "compare_gaits",
    "convergence",
    "device",
    "exchange",
    "maze",
    "mazes",
    "mjcf",
    "picture",
    "screen_mazes",
    "screen_walks",
    "sdf",
    "spec",
    "sweep",
    "video",
    "view_angles",
    "walk",
]
