"""A robot's build: layout, sweep, limits, masses, and the robot that the parts make."""

from dataclasses import dataclass, field, replace
from functools import cached_property

from stepwell import base
from stepwell.build.build_file import BuildFile
from stepwell.build.builds import BandUse, band_use
from stepwell.build.limits import ExceededLimit
from stepwell.build.part import Part
from stepwell.build.robots.masses import body_mass
from stepwell.build.robots.robot_layout import RobotLayout, robot_layout
from stepwell.build.robots.robot_limits import leg_paths, peak_force, robot_findings, robot_webs
from stepwell.build.robots.robot_sweep import robot_sweep
from stepwell.build.robots.solids import robot_parts
from stepwell.build.sweeps import MotionSweep
from stepwell.mechanism import Cell
from stepwell.robot import BodyMass, Drive, Robot, RobotParts, body_names, with_parts
from stepwell.statics import Path


@dataclass(frozen=True, eq=False, repr=False)
class RobotBuild(base.ByValue, base.Drawn):
    """The solid parts of a robot, whether they move free of each other, and what limits them.

    The sweep takes seconds and is computed when it or the findings are first read.

    Attributes:
        drawing, build_file: the robot as designed, and the sizes and material.
        layout: parts, fasteners, bands and cords with their places.
        swept: the sweep, if it is known.
    """

    drawing: Robot
    build_file: BuildFile
    layout: RobotLayout
    swept: MotionSweep | None = field(default=None, compare=False)

    def __repr__(self):
        return f"RobotBuild({self.layout!r}, {self.build_file.sheet.material})"

    @cached_property
    def sweep(self) -> MotionSweep:
        """Overlaps and clearances at all angles of all cells and antennas."""
        return self.swept or robot_sweep(self.layout)

    @property
    def parts(self) -> tuple[Part, ...]:
        """All cut parts."""
        return self.layout.parts

    @cached_property
    def findings(self) -> tuple[ExceededLimit, ...]:
        """Exceeded limits, overlaps first; empty if it can be built."""
        return robot_findings(self.layout, self._paths, self.sweep)

    @cached_property
    def _paths(self) -> dict[str, Path]:
        return leg_paths(self.drawing)

    @property
    def peak_force(self) -> float:
        """Largest force of the actuator [N]: both legs and the drag of the floor."""
        return peak_force(self._paths, self.drawing)

    @property
    def can_be_built(self) -> bool:
        """Whether its parts move free of each other and no limit is exceeded."""
        return self.sweep.free and not self.findings

    @property
    def title(self) -> str:
        """Of the design."""
        return self.drawing.title or "Robot"

    @cached_property
    def masses(self) -> tuple[BodyMass, ...]:
        """Mass, centre and inertia of every rigid body."""
        return tuple(body_mass(self.layout, name) for name in body_names(self.drawing))

    @cached_property
    def made(self) -> RobotParts:
        """Shapes and masses of all rigid bodies.

        Raises:
            ValueError: holes of a part cross each other; the text is that of the finding.
        """
        try:
            return robot_parts(self.layout, self.build_file.title)
        except base.InputError as error:
            worst = min(robot_webs(self.layout), key=lambda one: one.value, default=None)
            if worst is None:
                raise
            raise base.InputError(f"{worst.problem} {worst.advice}") from error

    @cached_property
    def robot(self) -> Robot:
        """The robot that the parts make.

        Its masses and its centre of mass are those of the parts, its feet those of the build file,
        and its period is at least the shortest one of the actuator.
        """
        own = self.build_file
        foot = replace(self.drawing.foot, radius=own.robot.foot_radius)
        return with_parts(replace(self.drawing, foot=foot, drive=self._drive), self.made)

    @property
    def _drive(self) -> Drive:
        """The drive with the speed of the actuator, and a longer period if it needs one."""
        least = self.least_period
        period = max(self.drawing.drive.period, least)
        speed = self.build_file.linear_actuator.speed
        return replace(self.drawing.drive, speed=speed, period=period)

    @property
    def least_period(self) -> float:
        """Shortest period of a cycle of the actuator [s]."""
        speed = self.build_file.linear_actuator.speed
        return replace(self.drawing.drive, speed=speed, period=1e9).least_period

    @cached_property
    def mass(self) -> float:
        """Mass of all parts and fasteners, actuator, battery and board [kg]."""
        return sum(one.mass for one in self.masses)

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of mass of the robot at rest [m]."""
        x, y, z = (
            sum(one.mass * float(one.centre[i]) for one in self.masses) / self.mass
            for i in range(3)
        )
        return x, y, z

    def mass_of(self, *bodies: str) -> float:
        """Mass of these rigid bodies together [kg]."""
        return sum(one.mass for one in self.masses if one.body in bodies)

    @property
    def group_masses(self) -> dict[str, float]:
        """Mass of the body, the carriage, and groups of bodies of the first leg [kg]."""
        leg = self.drawing.legs[0]
        inner, outer = leg.chain.names
        groups = {
            "body": ["body"],
            "middle block with slider": [f"{leg.name}.{inner}.block", f"{leg.name}.slider"],
            "outer block": [f"{leg.name}.{outer}.block"],
            "carriage": ["carriage"],
            "foot with links": [f"{leg.name}.{k}" for k in ("foot", "link front", "link rear")],
        }
        return {name: self.mass_of(*bodies) for name, bodies in groups.items()}

    @cached_property
    def sheet_mass(self) -> float:
        """Mass of all cut parts [kg]."""
        return sum(part.mass(self.build_file.sheet.density) for part in self.layout.parts)

    @cached_property
    def bands(self) -> tuple[BandUse, ...]:
        """The bands with their hooks, lengths and tensions."""
        return tuple(
            band_use(self.layout.cell(one), one, self.build_file) for one in self.layout.bands
        )

    def band_cell(self, one: BandUse) -> Cell:
        """The cell of a band."""
        return self.layout.plan.legs[one.cell // 2].cells[one.cell % 2]

    def band_words(self, one: BandUse) -> tuple[str, str, str]:
        """Name of a band's cell, and of its two hooks."""
        leg = self.drawing.legs[one.cell // 2]
        inner, outer = one.holes
        return f"{leg.name} {leg.chain.names[one.cell % 2]}", inner, outer

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader has to know of this build, a sentence each."""
        notes: list[str] = []
        period, own = self.drawing.drive.period, self.build_file.linear_actuator
        if self.least_period > period * (1.0 + 1e-9):
            notes.append(
                f"The design has a period of {period:.3g} s, and the actuator needs "
                f"{self.least_period:.3g} s for a cycle at "
                f"{base.to_unit(own.speed, 'mm/s'):.3g} mm/s: the robot of the parts has the "
                f"longer period."
            )
        for one in self.bands:
            if not one.fits:
                packs = ", ".join(
                    f"{base.to_unit(length, 'mm'):.4g}"
                    for length in self.build_file.band.free_lengths
                )
                cell = self.band_words(one)[0]
                notes.append(
                    f"Band {one.number + 1} of {cell}: no band of the pack ({packs} mm) has its "
                    f"rest length of {base.to_unit(one.rest_length, 'mm'):.4g} mm."
                )
        return tuple(notes)


def build_robot(
    robot: Robot,
    build_file: BuildFile,
    *,
    progress: base.Progress = None,
    swept: MotionSweep | None = None,
) -> RobotBuild:
    """The solid parts of a robot, swept over all states and antenna positions.

    Args:
        robot: two legs of two cells each, and up to two antennas.
        build_file: sizes and material.
        progress: called with (done, total) pairs of bodies of the sweep, which is then computed
            at once.
        swept: the sweep of this robot and build file, if it is known.

    Raises:
        ValueError: a robot for which there is no layout; the text names the part and the number.
    """
    layout = robot_layout(robot, build_file)
    if swept is None and progress is not None:
        swept = robot_sweep(layout, progress)
    return RobotBuild(robot, build_file, layout, swept)
