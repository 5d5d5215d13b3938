"""Robots on snapping legs as values: legs, body, antennas, arena, and the predicted gait."""

from stepwell.robot.gait import Flip, LegPrediction, Limit, Motion, Prediction, Push
from stepwell.robot.parts import (
    Antenna,
    Arena,
    Blocks,
    Body,
    Cylinder,
    Drive,
    Floor,
    Foot,
    Goal,
    Leg,
    Profile,
    Robot,
    Wall,
    other_layout,
    other_start,
)

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
