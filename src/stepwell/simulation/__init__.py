"""Robots simulated: their MuJoCo model, their walks, their way through an arena."""

from stepwell.simulation.convergence import Convergence, Resolution, convergence
from stepwell.simulation.maze import Change, Contact, Maze, Outcome, maze, mazes
from stepwell.simulation.model.model import mjcf, spec
from stepwell.simulation.model.settings import Integrator, Linkage, Settings
from stepwell.simulation.sweep import Sweep, Trial, sweep
from stepwell.simulation.video import VideoError, video
from stepwell.simulation.walk import Walk, walk

__all__ = [
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
