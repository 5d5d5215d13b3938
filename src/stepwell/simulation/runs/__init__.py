"""Walks, mazes, sweeps and videos: what a robot did."""

from stepwell.simulation.runs.convergence import Convergence, Resolution, convergence
from stepwell.simulation.runs.maze import TOUCHED, Change, Contact, Maze, Outcome, maze, mazes
from stepwell.simulation.runs.sweep import Sweep, Trial, sweep
from stepwell.simulation.runs.video import VideoError, video
from stepwell.simulation.runs.walk import LOADED, Walk, walk

__all__ = [
    "LOADED",
    "TOUCHED",
    "Change",
    "Contact",
    "Convergence",
    "Maze",
    "Outcome",
    "Resolution",
    "Sweep",
    "Trial",
    "VideoError",
    "Walk",
    "convergence",
    "maze",
    "mazes",
    "sweep",
    "video",
    "walk",
]
