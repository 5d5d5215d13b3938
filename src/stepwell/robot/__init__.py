"""Robots on snapping legs as values: legs, body, antennas, arena, and the predicted gait."""

from stepwell.robot.antenna import Antenna
from stepwell.robot.arena import Arena, Cylinder, Goal, Wall
from stepwell.robot.blocks import Blocks
from stepwell.robot.body import Body
from stepwell.robot.drive import Drive, Profile
from stepwell.robot.floor import Floor
from stepwell.robot.foot import Foot
from stepwell.robot.jitter import other_layout, other_start
from stepwell.robot.leg import Leg
from stepwell.robot.predict import Flip, LegPrediction, Limit, Motion, Prediction, Push
from stepwell.robot.robot import Robot

__all__ = [
    "Antenna",
    "Arena",
    "Blocks",
    "Body",
    "Cylinder",
    "Drive",
    "Flip",
    "Floor",
    "Foot",
    "Goal",
    "Leg",
    "LegPrediction",
    "Limit",
    "Motion",
    "Prediction",
    "Profile",
    "Push",
    "Robot",
    "Wall",
    "other_layout",
    "other_start",
]
