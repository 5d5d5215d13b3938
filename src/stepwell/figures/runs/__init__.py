"""What a robot did, or will do."""

from stepwell.figures.runs.contacts import contacts
from stepwell.figures.runs.gait import gait
from stepwell.figures.runs.maze import maze
from stepwell.figures.runs.maze_timeline import maze_timeline
from stepwell.figures.runs.prediction import prediction
from stepwell.figures.runs.sweep import sweep
from stepwell.figures.runs.trajectory import trajectories, trajectory
