"""A robot as a value: legs, body, floor, drive, antennas."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from stepwell.base import ByValue, Drawn, InputError, Vec2, require, to_unit
from stepwell.robot.arena import Arena, Floor
from stepwell.robot.fit import of_robot, problems, refuse_slips
from stepwell.robot.parts import Antenna, Blocks, Body, Drive, Foot, Leg
from stepwell.robot.shapes import RobotParts

if TYPE_CHECKING:
    from stepwell.robot.prediction import Prediction
    from stepwell.simulation import Maze, Settings, Walk

Progress = Callable[[float, float], None]


@dataclass(frozen=True, slots=True, eq=False)
class Robot(ByValue, Drawn):
    """Legs on one actuator, under a body on a passive support, the T-foot.

    Args:
        legs: two or more, all with the same full stroke.
        body: carried by the legs.
        foot, blocks: the V and the foot, and the moving blocks, of every leg.
        floor: under the robot.
        drive: the command that all legs share.
        antennas: none or several.
        title: name in reports.
        sources: source of each number, by key of the design file: "paper", "authors' notes",
            "measured", "from the parts" or "assumed". Missing keys are assumed.
        unusual: True to accept sizes far off the legs' stroke and bands, as for a Cell.
        made: all parts that can be cut, with their masses, as of a build; they belong to these
            numbers, see `with_parts`. Without them the robot is drawn and simulated as plain
            blocks.

    Raises:
        ValueError: a geometry that cannot walk, with every reason: strokes that do not match the
            drive, legs or supports that collide, a centre of mass outside the supports, links that
            are too short, an antenna on no leg; or sizes that are probably in another unit.

    Source: Kamp et al. 2024, Figs. 3 and 4.
    """

    legs: Sequence[Leg]
    body: Body = Body()
    foot: Foot = Foot()
    blocks: Blocks = Blocks()
    floor: Floor = Floor()
    drive: Drive = Drive()
    antennas: Sequence[Antenna] = ()
    title: str = ""
    sources: Mapping[str, str] = field(default_factory=dict, hash=False, repr=False)
    unusual: bool = field(default=False, compare=False)
    made: RobotParts | None = field(default=None, repr=False)
    # Whether the sizes were checked for wrong units; `replace` passes it on to the copies.
    _asked: bool = field(default=False, repr=False, compare=False, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "legs", tuple(self.legs))
        object.__setattr__(self, "antennas", tuple(self.antennas))
        object.__setattr__(self, "sources", dict(self.sources))
        require("legs", len(self.legs), "the robot has")
        require("antennas", len(self.antennas), "the robot has")
        refuse_slips(self, of_robot(self))
        if reasons := problems(self):
            raise InputError("\n".join(reasons))

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        blocks = sum(sum(self.blocks.masses(len(leg.chain))) + self.foot.mass for leg in self.legs)
        antennas = sum(antenna.mass for antenna in self.antennas)
        return self.body.mass + self.blocks.carriage + blocks + antennas

    @property
    def weight(self) -> float:
        """Mass times gravity [N]."""
        return self.mass * self.floor.gravity

    @property
    def u_max(self) -> float:
        """The largest step that the legs can make in a cycle [m]."""
        return max(leg.stroke for leg in self.legs)

    @property
    def support_friction(self) -> float:
        """Coulomb's coefficient [1] under the passive support, from the floor's drag."""
        return self.floor.support_friction(self.mass)

    @property
    def pivot_height(self) -> float:
        """Height of the legs' pivots above the plane of the supports [m]."""
        return float(self.foot.depth(0.0)) - self.foot.below

    def leg(self, name: str) -> Leg:
        """The leg of that name; or a `ValueError`."""
        legs = {leg.name: leg for leg in self.legs}
        if name not in legs:
            raise InputError(f"leg = {name!r}: must be one of {', '.join(map(repr, legs))}.")
        return legs[name]

    def with_anchors(
        self, leg: str, cell: int | str, p: Vec2 | None = None, q: Vec2 | None = None
    ) -> Robot:
        """The same robot with the anchors p, q [m] of one cell of one leg moved; None keeps one.

        The cell is an index, 0 for the innermost, or a name. A `ValueError` refuses other cells and
        impossible anchors.
        """
        return self._with_leg(self.leg(leg).with_anchors(cell, p, q))

    def pressed(self, swings: Mapping[str, float]) -> Robot:
        """The same robot with antennas pressed by `swings` [rad], as displaced anchors.

        A `ValueError` refuses unknown antennas, and rotations outside 0 to the antenna's `swing`.
        """
        robot, antennas = self, {antenna.name: antenna for antenna in self.antennas}
        for name, swing in swings.items():
            if name not in antennas:
                allowed = ", ".join(map(repr, antennas)) or "none: this robot has no antennas"
                raise InputError(f"antenna = {name!r}: must be one of {allowed}.")
            antenna = antennas[name]
            if not 0 <= swing <= antenna.swing:
                raise InputError(
                    f"swing = {math.degrees(swing):.6g} deg of antenna {name!r}: must be from 0 "
                    f"to {math.degrees(antenna.swing):.6g} deg."
                )
            if antenna.connected:
                leg, share = robot.leg(antenna.leg), swing / antenna.swing
                robot = robot._with_leg(leg.with_moved_anchor(antenna.cell, antenna.moves, share))
        return robot

    def _with_leg(self, leg: Leg) -> Robot:
        return replace(self, legs=tuple(leg if one.name == leg.name else one for one in self.legs))

    def predict(self) -> Prediction:
        """Predict gait, advance and limits of a cycle from statics, without simulation.

        Every leg is followed exactly through its equilibria, with the ground reaction force on its
        foot and the floor's drag as loads; then friction decides how the body slides. The theory
        page of the robot derives both. The result has gait, advance, drag limits, antenna
        thresholds and uncertainties of every leg.

        Raises:
            StaticsError: the quasi-static path could not be followed; the text has an action.
        """
        from stepwell.robot.prediction import predict

        return predict(self)

    def walk(
        self,
        cycles: float = 8,
        *,
        arena: Arena | None = None,
        settings: Settings | None = None,
        start: Walk | None = None,
        progress: Progress | None = None,
    ) -> Walk:
        """Simulate a walk in MuJoCo, driven by loading and unloading of the actuator.

        The position command is the only input. The same robot, settings and computer give identical
        numbers.

        Args:
            cycles: number of cycles of loading and unloading, > 0; fractions are allowed.
            arena: obstacles and start; a bare floor by default.
            settings: of the simulation.
            start: an earlier walk to continue, of this robot or of one with other numbers only, for
                example another anchor. The command continues without a jump.
            progress: called with (done, total) [s].

        Raises:
            ValueError: no cycles, a start that ended early, or a part without a simulator model.
            ModuleNotFoundError: MuJoCo is not installed.
        """
        from stepwell.simulation import walk

        return walk(self, cycles, arena=arena, settings=settings, start=start, progress=progress)

    def maze(
        self,
        arena: Arena,
        *,
        limit: float = 600.0,
        settings: Settings | None = None,
        progress: Progress | None = None,
    ) -> Maze:
        """Simulate a robot in an arena until it reaches the goal, is trapped or the time is over.

        The actuator loads and unloads all the time, and only the antennas steer.

        Args:
            arena: obstacles, start and goal; without a goal the robot walks for the whole time.
            limit: simulated time [s], > 0.
            settings: of the simulation.
            progress: called with (done, total) [s].

        Raises:
            ValueError: no time, or a robot that the simulator does not support.
            ModuleNotFoundError: MuJoCo is not installed.
        """
        from stepwell.simulation import maze

        return maze(self, arena, limit=limit, settings=settings, progress=progress)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        legs = ", ".join(leg.name for leg in self.legs)
        antennas = f", {len(self.antennas)} antennas" if self.antennas else ""
        return (
            f"Robot({title}legs {legs}{antennas}, {to_unit(self.mass, 'g'):.0f} g, "
            f"{to_unit(self.drive.amplitude, 'mm'):g} mm in {self.drive.period:g} s)"
        )
