"""Robots and hoppers as values: legs, body, antennas, arena; the predicted gait and jump."""

from stepwell.robot.arena import Arena, Cylinder, Floor, Goal, Wall, other_layout, other_start
from stepwell.robot.fit import of_arena, of_robot
from stepwell.robot.hopper import Actuator, Hopper, Springs, Task
from stepwell.robot.hopper_fit import landing_length, longest_stretch, snap_of
from stepwell.robot.jump import (
    JumpBound,
    Release,
    after_stop,
    bound_of,
    flight,
    moving_force,
    predicted_stop,
    release,
)
from stepwell.robot.leg_cycles import TOLERANCE, TRIAL, gait, states
from stepwell.robot.parts import Antenna, Blocks, Body, Drive, Foot, Leg, Profile
from stepwell.robot.prediction import (
    DriveNeeds,
    Flip,
    LegPrediction,
    Motion,
    Prediction,
    Push,
    PushEnd,
    known_depths,
    predict,
    predicted_gaits,
    too_soft,
)
from stepwell.robot.robot import Robot
from stepwell.robot.shapes import (
    FROM_PARTS,
    BodyMass,
    Inertial,
    PartRole,
    RobotParts,
    Shape,
    body_names,
    joined_solids,
    with_parts,
)

__all__ = [
    "Actuator",
    "Hopper",
    "JumpBound",
    "Release",
    "Springs",
    "Task",
    "after_stop",
    "bound_of",
    "flight",
    "landing_length",
    "longest_stretch",
    "moving_force",
    "predicted_stop",
    "release",
    "snap_of",
    "Inertial",
    "joined_solids",
    "Antenna",
    "Arena",
    "Blocks",
    "Body",
    "BodyMass",
    "Cylinder",
    "Drive",
    "DriveNeeds",
    "Flip",
    "Floor",
    "Foot",
    "Goal",
    "Leg",
    "LegPrediction",
    "PartRole",
    "PushEnd",
    "Motion",
    "Prediction",
    "Profile",
    "Push",
    "Robot",
    "RobotParts",
    "Shape",
    "Wall",
    "body_names",
    "other_layout",
    "other_start",
    "predict",
    "with_parts",
]
