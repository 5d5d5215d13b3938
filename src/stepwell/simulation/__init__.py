"""Robots simulated: their MuJoCo model, their walks, their way through an arena."""

from stepwell.simulation.convergence import Convergence, Resolution, convergence
from stepwell.simulation.maze import TOUCHED, Change, Contact, Maze, Outcome, maze, mazes
from stepwell.simulation.model import Integrator, Linkage, Settings, mjcf, spec
from stepwell.simulation.sweep import TRIAL, Sweep, Trial, sweep
from stepwell.simulation.video import VideoError, video
from stepwell.simulation.walk import LOADED, Walk, walk

__all__ = [
    "LOADED",
    "TOUCHED",
    "TRIAL",
    "Change",
    "Contact",
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
    "convergence",
    "maze",
    "mazes",
    "mjcf",
    "spec",
    "sweep",
    "video",
    "walk",
]
