"""Robots simulated: their MuJoCo model, their walks, their way through an arena."""

from stepwell.physics.convergence import Convergence, Resolution, convergence
from stepwell.physics.maze import Change, Contact, Maze, Outcome, maze, mazes
from stepwell.physics.model import mjcf, spec
from stepwell.physics.settings import Integrator, Linkage, Settings
from stepwell.physics.sweep import Sweep, Trial, sweep
from stepwell.physics.video import VideoError, video
from stepwell.physics.walk import Walk, walk

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
