"""What a robot is made of, and where it is put: values only."""

from stepwell.robot.parts.antenna import Antenna
from stepwell.robot.parts.arena import (
    Arena,
    Cylinder,
    Floor,
    Goal,
    Wall,
    other_layout,
    other_start,
)
from stepwell.robot.parts.body import Body
from stepwell.robot.parts.drive import Drive, Profile
from stepwell.robot.parts.leg import Blocks, Foot, Leg
from stepwell.robot.parts.robot import Robot
from stepwell.robot.parts.slips import of_arena, of_robot
