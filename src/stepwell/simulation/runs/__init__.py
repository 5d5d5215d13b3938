"""Walks, mazes, sweeps and videos: what a robot did."""

from stepwell.simulation.runs.comparison import GaitComparison, compare_gaits
from stepwell.simulation.runs.convergence import Convergence, Resolution, convergence
from stepwell.simulation.runs.maze import TOUCHED, Contact, GaitChange, Maze, Outcome, maze, mazes
from stepwell.simulation.runs.sweep import TRIAL, Sweep, Trial, sweep
from stepwell.simulation.runs.video import VideoError, drawing_system, video
from stepwell.simulation.runs.walk import LOADED, Walk, walk
from stepwell.simulation.runs.worlds import device, screen_mazes, screen_walks
