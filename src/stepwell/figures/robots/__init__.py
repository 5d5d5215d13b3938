"""Robots and arenas, drawn from their values."""

from stepwell.figures.robots.arena import OBSTACLE, TOUCHED, draw_arena, outlines
from stepwell.figures.robots.robot import robot_above, robot_drawing, robot_side
from stepwell.figures.robots.robot_parts import bracket, frame, in_world
