"""A robot's build: its parts, their masses, and the robot that they make."""

from dataclasses import dataclass, replace
from functools import cached_property

from stepwell import base
from stepwell.build.build_file import BuildFile
from stepwell.build.robots.robot_layout import RobotLayout, robot_layout
from stepwell.build.robots.solids import robot_parts
from stepwell.robot import Drive, Robot, RobotParts, with_parts


@dataclass(frozen=True, eq=False, repr=False)
class RobotBuild(base.ByValue, base.Drawn):
    """The solid parts of a robot.

    Attributes:
        design, build_file: the robot as designed, and the sizes and material.
        layout: parts, fasteners, bands and cords with their places.
    """

    design: Robot
    build_file: BuildFile
    layout: RobotLayout

    def __repr__(self):
        return f"RobotBuild({self.layout!r}, {self.build_file.sheet.material})"

    @cached_property
    def made(self) -> RobotParts:
        """Shapes and masses of all rigid bodies."""
        return robot_parts(self.layout, self.build_file.title)

    @cached_property
    def robot(self) -> Robot:
        """The robot that the parts make.

        Its masses and its centre of mass are those of the parts, its feet those of the build file,
        and its period is at least the shortest one of the actuator.
        """
        own = self.build_file
        foot = replace(self.design.foot, radius=own.robot.foot_radius)
        return with_parts(replace(self.design, foot=foot, drive=self._drive), self.made)

    @property
    def _drive(self) -> Drive:
        """The drive with the speed of the actuator, and a longer period if it needs one."""
        drive = self.design.drive
        slow = replace(drive, speed=self.build_file.linear_actuator.speed, period=1e9)
        return replace(slow, period=max(drive.period, slow.least_period))

    @property
    def mass(self) -> float:
        """Mass of all parts and fasteners, actuator and battery [kg]."""
        return self.made.mass


def build_robot(robot: Robot, build_file: BuildFile) -> RobotBuild:
    """The solid parts of a robot; `stepwell.build.build` has the arguments.

    Raises:
        ValueError: a robot for which there is no layout; the text names the part and the number.
    """
    return RobotBuild(robot, build_file, robot_layout(robot, build_file))
