"""Robots on snapping legs as values: legs, body, antennas, arena, and the predicted gait."""

from stepwell.robot.gait.predict import Flip, LegPrediction, Limit, Motion, Prediction, Push
from stepwell.robot.parts.antenna import Antenna
from stepwell.robot.parts.arena import Arena, Cylinder, Goal, Wall
from stepwell.robot.parts.blocks import Blocks
from stepwell.robot.parts.body import Body
from stepwell.robot.parts.drive import Drive, Profile
from stepwell.robot.parts.floor import Floor
from stepwell.robot.parts.foot import Foot
from stepwell.robot.parts.jitter import other_layout, other_start
from stepwell.robot.parts.leg import Leg
from stepwell.robot.parts.robot import Robot

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
