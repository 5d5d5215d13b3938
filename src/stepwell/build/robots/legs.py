"""Parts of a leg: blocks, levers, the sliders in their rail, and the V with its foot."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from stepwell.base import Vec2
from stepwell.build.build_file import mm
from stepwell.build.contour import Contour
from stepwell.build.part import Hole
from stepwell.build.plates import Fastener
from stepwell.build.robots import plan as plans
from stepwell.build.robots.making import Maker, PartFrame, united
from stepwell.build.robots.plan import GAP, LegPlan, RobotPlan
from stepwell.build.stack import pin_length
from stepwell.robot import PartRole

# A hook, or a joint's pin with a hook above it: x, and the distance from the joints away from the
# other block [m].
Hooks = Sequence[Vec2]
# From the middle of a slider to its two pins, and half the width of a tenon [m].
PINS, _TENON = 9e-3, 3e-3
# Half the width of a tab with the V's pivot, and its edge below the pivot [m].
_TAB, _BELOW = 6e-3, 4.5e-3


# The two cells of a leg in names of parts.
PLACES = ("inner", "outer")


@dataclass(frozen=True)
class LegMaker:
    """Makes the parts of one leg."""

    make: Maker
    plan: RobotPlan
    leg: LegPlan

    def name(self, part: str) -> str:
        """Name of a part or a fastener of this leg."""
        return f"{self.leg.label}-{part}"

    def body(self, part: str) -> str:
        """Name of a rigid body of this leg."""
        return f"{self.leg.leg.name}.{part}"

    def cell(self, number: int) -> str:
        """Name of a cell of this leg."""
        return self.leg.leg.chain.names[number]

    def at(self, x: float, across: float) -> Vec2:
        """A point at a distance `across` from the midline on this leg's side [m]."""
        return x, self.leg.side * across

    def plate(
        self,
        name: str,
        base: float,
        boxes: Sequence[tuple[float, float, float, float]],
        *,
        holes: Sequence[Hole] = (),
        cutouts: Sequence[Contour] = (),
    ) -> None:
        """A flat part of rectangles (x0, across0, x1, across1); holes as in the robot's frame."""
        (x, y), side = self.at(boxes[0][0], boxes[0][1]), self.leg.side
        moved = [
            (x0 - x, min(side * a, side * b) - y, x1 - x, max(side * a, side * b) - y)
            for x0, a, x1, b in boxes
        ]
        outline = united(moved, self.plan.build_file.sheet.corner)
        self.make.part(
            self.name(name),
            base,
            outline,
            PartFrame(x, y),
            holes=[
                Hole((one.centre[0] - x, one.centre[1] - y), one.diameter, one.name, one.use)
                for one in holes
            ],
            cutouts=[one.moved(-x, -y) for one in cutouts],
        )

    def blocks(self) -> None:
        """All blocks, levers, sliders and the V."""
        self._middle_block()
        self._outer_block()
        self._levers()
        self._slider()
        self._links()

    def hooks(self, cell: int, end: str) -> Hooks:
        """The hooks of a cell on its inner ("p") or outer ("q") block."""
        if end == "p":
            return list(dict.fromkeys((b.p[1], -b.p[0]) for b in self.leg.cells[cell].bands))
        return list(dict.fromkeys((b.q[1], b.q[0]) for b in self.leg.cells[cell].bands))

    def hook_name(self, cell: int, end: str, number: int) -> str:
        """The name of a hook by its number in `hooks`."""
        return self.name(f"{PLACES[cell]}-{end}{number + 1 if number else ''}")

    def joint_pins(self, cell: int, at: tuple[float, float]) -> None:
        """The two pins of a pair of joints, with shims on both sides of the levers."""
        high = self.plan.heights
        for number in (0, 1):
            x = at[0] + (number - 0.5) * self.plan.build_file.lever.spacing
            joint = (self.body(self.cell(cell)), number)
            name = self.name(f"{PLACES[cell]}-{'ab'[number]}")
            self.make.pin(name, self.at(x, at[1]), (high.bottom, high.roof), joint=joint)
            shim = self.plan.build_file.lever.shim
            bases = (high.middle - shim, high.middle + self.plan.thick)
            self.make.shims(name, self.at(x, at[1]), bases, joint)

    def hook_pins(self, cell: int, end: str, joints: tuple[float, float], away: float) -> None:
        """Hooks on a block; `joints` is the midpoint, `away` the direction from the other block."""
        high, build_file = self.plan.heights, self.plan.build_file
        for number, (along, across) in enumerate(self.hooks(cell, end)):
            name = self.hook_name(cell, end, number)
            at = self.at(joints[0] - along, joints[1] + away * across)
            self.make.pin(name, at, (high.top, self.plan.hook_top), use="hook")
            made = self.make.fasteners[-1]
            hook = build_file.hook
            size = f"tube {mm(hook.diameter)} x {mm(hook.cap_width)}, {mm(hook.cap)} long"
            self.make.add(
                Fastener(
                    name,
                    "cap",
                    size,
                    hook.cap_width,
                    self.make.body,
                    at,
                    made.high - hook.cap,
                    made.high,
                )
            )

    def hook_tab(
        self, hooks: Hooks, joints: tuple[float, float], away: float
    ) -> list[tuple[float, float, float, float]]:
        """A rectangle of the top plate around hooks that lie beyond the plate; none if all fit."""
        build_file = self.plan.build_file
        edge = build_file.hook.diameter / 2.0 + build_file.sheet.bridge
        beyond = [one for one in hooks if one[1] > self.plan.back - edge]
        if not beyond:
            return []
        across = max(one[1] for one in beyond) + edge + 1e-3
        xs = [joints[0] - one[0] for one in beyond]
        ends = sorted((joints[1], joints[1] + away * across))
        return [(min(xs) - edge - 1e-3, ends[0], max(xs) + edge + 1e-3, ends[1])]

    def spares(
        self,
        cell: int,
        end: str,
        joints: tuple[float, float],
        away: float,
        tabs: Sequence[tuple[float, float, float, float]],
    ) -> list[Hole]:
        """Holes on the grid in line with the joints' midpoint, for other anchors, as far as the
        plate and the tabs on it reach.
        """
        build_file = self.plan.build_file
        pitch, wide = build_file.grid.pitch, build_file.hook.diameter + build_file.pin.plate_fit
        edge = wide / 2.0 + build_file.sheet.bridge
        reach = self.plan.back
        for x0, y0, x1, y1 in tabs:
            if x0 + edge <= joints[0] <= x1 - edge:
                reach = max(reach, abs(y0 - joints[1]), abs(y1 - joints[1]))
        least = wide + build_file.sheet.bridge - 1e-9
        places = [k * pitch for k in range(1, int((reach - edge) / pitch + 1e-9) + 1)]
        return [
            Hole(
                self.at(joints[0], joints[1] + away * place),
                wide,
                f"{PLACES[cell]}-{end}{mm(place)}mm",
                "grid",
            )
            for place in places
            if all(math.dist((0.0, place), one) >= least for one in self.hooks(cell, end))
        ]

    def _middle_block(self) -> None:
        plan, leg, high = self.plan, self.leg, self.plan.heights
        first, _ = leg.cells
        self.make.now(self.body(f"{self.cell(0)}.block"), PartRole.MIDDLE_BLOCK)
        row = leg.middle
        x0, x1 = leg.outer - plan.half, leg.inner + plan.half
        face, back = row - plans.near(first) / 2.0, row + plan.back
        face2 = row - plans.near(leg.cells[1]) / 2.0
        # The faces of the two cells differ if their levers do.
        split = (leg.outer + plan.half + leg.front) / 2.0
        plate = [(x0, face2, split, back), (split, face, x1, back)]
        pin = row - plans.mean_reach(first)
        half = plan.tab / 2.0
        tab = (leg.front - half, pin - half, leg.front + half, back)
        hooks = [*self.hooks(1, "p")], [*self.hooks(0, "q")]
        tabs = [
            *self.hook_tab(hooks[0], (leg.outer, row), 1.0),
            *self.hook_tab(hooks[1], (leg.inner, row), 1.0),
        ]
        spares = [
            *self.spares(1, "p", (leg.outer, row), 1.0, tabs),
            *self.spares(0, "q", (leg.inner, row), 1.0, tabs),
        ]
        self.plate("middle-bottom", high.bottom, [*plate, tab])
        spacer = (x0, row + plan.spacer, x1, back)
        self.plate("middle-spacer", high.middle, [spacer, tab])
        self.plate("middle-top", high.top, [*plate, *tabs], holes=spares)
        for x, kind in ((leg.outer, "outer"), (leg.inner, "inner")):
            self._clamps(f"middle-{kind}", x, row + plan.pin_row)
        self.joint_pins(0, (leg.inner, row))
        self.joint_pins(1, (leg.outer, row))
        self.make.pin(
            self.name("slider-pin"),
            self.at(leg.front, pin),
            (high.slide, high.slide + pin_length(high.middle + plan.thick - high.slide)),
        )
        self.hook_pins(0, "q", (leg.inner, row), 1.0)
        self.hook_pins(1, "p", (leg.outer, row), 1.0)

    def _clamps(self, name: str, x: float, across: float) -> None:
        """Two pins that hold the plates of a block together behind a pair of joints."""
        high = self.plan.heights
        out = self.plan.half - self.plan.build_file.pin.diameter / 2.0
        out -= self.plan.build_file.sheet.bridge + 1e-3
        for number, way in enumerate((-1.0, 1.0)):
            at = self.at(x + way * out, across)
            self.make.pin(self.name(f"{name}-{number + 1}"), at, (high.bottom, high.roof))
            shim = self.plan.build_file.lever.shim
            bases = (high.middle - shim, high.middle + self.plan.thick)
            self.make.shims(self.name(f"{name}-{number + 1}"), at, bases)

    def _outer_block(self) -> None:
        plan, leg, high = self.plan, self.leg, self.plan.heights
        cell = leg.cells[1]
        self.make.now(self.body(f"{self.cell(1)}.block"), PartRole.OUTER_BLOCK)
        row = leg.outer_row
        x0, x1 = leg.last - plan.half, leg.last + plan.half
        plate = (x0, row - plan.back, x1, row + plans.near(cell) / 2.0)
        hooks = self.hooks(1, "q")
        tabs = self.hook_tab(hooks, (leg.last, row), -1.0)
        spares = self.spares(1, "q", (leg.last, row), -1.0, tabs)
        self.plate("outer-bottom", high.bottom, [plate])
        self.plate("outer-spacer", high.middle, [(x0, row - plan.back, x1, row - plan.spacer)])
        self.plate("outer-top", high.top, [plate, *tabs], holes=spares)
        self._clamps("outer", leg.last, row - plan.pin_row)
        self.joint_pins(1, (leg.last, row))
        low = high.roof - pin_length(high.roof - high.slide - plan.thick / 2.0)
        self.make.pin(
            self.name("carriage-pin"), self.at(leg.last, row), (max(low, high.slide), high.roof)
        )
        self.hook_pins(1, "q", (leg.last, row), -1.0)

    def _levers(self) -> None:
        build_file, leg = self.plan.build_file, self.leg
        hole = build_file.pin.diameter + build_file.pin.lever_fit
        rows = ((0, leg.body, leg.row, 1.0), (1, leg.outer, leg.middle, -1.0))
        for number, x, row, way in rows:
            cell = leg.cells[number]
            along, across = (
                cell.lever * math.sin(cell.limit),
                way * cell.lever * math.cos(cell.limit),
            )
            angle = math.atan2(leg.side * across, along)
            for index in (0, 1):
                name = f"{self.cell(number)}.lever {index + 1}"
                self.make.now(self.body(name), PartRole.LEVER)
                start = x + (index - 0.5) * build_file.lever.spacing
                self.make.part(
                    self.name(f"lever-{PLACES[number]}-{index + 1}"),
                    self.plan.heights.middle,
                    Contour.slot((0.0, 0.0), (cell.lever, 0.0), build_file.lever.width),
                    PartFrame(*self.at(start, row), angle),
                    holes=(Hole((0.0, 0.0), hole, "inner"), Hole((cell.lever, 0.0), hole, "outer")),
                )

    def _slider(self) -> None:
        """The middle slider with the V's front pivot: flange, core in the rail, slotted top."""
        plan, leg, high = self.plan, self.leg, self.plan.heights
        own = plan.build_file.robot
        self.make.now(self.body("slider"), PartRole.MIDDLE_BLOCK)
        mean = leg.row
        reach = plans.swing(leg.cells[0]) / 2.0
        wide = own.rail / 2.0 + own.flange
        slot = Contour.slot(
            self.at(leg.front, mean - reach), self.at(leg.front, mean + reach), plan.slot
        )
        offsets = (-(plan.thick + GAP), plan.thick + GAP)
        self.rider("slider", leg.front, offsets)
        end = plan.core + 0.5e-3
        self.plate(
            "slider-top",
            high.slide,
            [(leg.front - end, mean - wide, leg.front + end, mean + wide)],
            cutouts=[slot],
        )

    def rider(self, name: str, x: float, offsets: Sequence[float]) -> None:
        """Flange and core of a slider, and its tabs with the V's pivot at x."""
        plan, leg, high = self.plan, self.leg, self.plan.heights
        own = plan.build_file.robot
        wide = own.rail / 2.0 + own.flange
        narrow = own.rail / 2.0 - own.rail_fit
        half = plan.thick / 2.0
        mortises = []
        for offset in offsets:
            low = self.at(x - _TENON, leg.row + offset - half)
            up = self.at(x + _TENON, leg.row + offset + half)
            y0, y1 = sorted((low[1], up[1]))
            mortises.append(Contour.of([(low[0], y0), (up[0], y0), (up[0], y1), (low[0], y1)]))
        for kind, base, reach in (("flange", high.flange, wide), ("core", high.rail, narrow)):
            self.plate(
                f"{name}-{kind}",
                base,
                [(x - plan.core, leg.row - reach, x + plan.core, leg.row + reach)],
                cutouts=mortises,
            )
        top = high.slide + plan.thick
        for number, way in enumerate((-1.0, 1.0)):
            at = self.at(x + way * PINS, leg.row)
            low = top - pin_length(top - high.flange)
            self.make.pin(self.name(f"{name}-{number + 1}"), at, (low, top))
            shim = plan.build_file.lever.shim
            bases = (high.rail - shim, high.rail + plan.thick)
            self.make.shims(self.name(f"{name}-{number + 1}"), at, bases)
        pivot = (self.body("V"), 0 if len(offsets) > 1 else 1)
        for number, offset in enumerate(offsets):
            end = high.rail + plan.thick
            corners = [
                (-_TAB, -_BELOW),
                (_TAB, -_BELOW),
                (_TAB, high.flange),
                (_TENON, high.flange),
                (_TENON, end),
                (-_TENON, end),
                (-_TENON, high.flange),
                (-_TAB, high.flange),
            ]
            radii = [plan.build_file.sheet.corner] * 2 + [0.0] * 6
            self.make.part(
                self.name(f"{name}-tab{number + 1 if len(offsets) > 1 else ''}"),
                leg.side * leg.row + offset - half,
                Contour.rounded(corners, radii),
                PartFrame(x, 0.0, 0.0, upright=True),
            )
        middle = leg.side * leg.row
        reach = 1.5 * plan.thick + GAP
        self.make.pin(
            self.name(f"{name}-pivot"),
            (x, 0.0),
            (middle - reach, middle + reach),
            joint=pivot,
            upright=True,
        )

    def _links(self) -> None:
        """One front link, two rear links, and the foot of two discs."""
        plan, leg = self.plan, self.leg
        own, foot = plan.build_file.robot, plan.robot.foot
        hole = plan.build_file.pin.diameter + plan.build_file.pin.lever_fit
        depth = float(foot.depth(0.0))
        apex = (leg.front + leg.rear) / 2.0
        middle, half = leg.side * leg.row, plan.thick / 2.0
        outer = plan.thick + GAP
        outline = Contour.slot((0.0, 0.0), (foot.link, 0.0), own.link_width)
        holes = (Hole((0.0, 0.0), hole, "pivot"), Hole((foot.link, 0.0), hole, "foot"))
        for end, x, offsets in (("front", leg.front, (0.0,)), ("rear", leg.rear, (-outer, outer))):
            self.make.now(self.body(f"link {end}"), PartRole.LINK)
            angle = math.atan2(-depth, apex - x)
            for number, offset in enumerate(offsets):
                self.make.part(
                    self.name(f"link-{end}{number + 1 if len(offsets) > 1 else ''}"),
                    middle + offset - half,
                    outline,
                    PartFrame(x, 0.0, angle, upright=True),
                    holes=holes,
                )
        self.make.now(self.body("foot"), PartRole.FOOT)
        for number, way in enumerate((-1.0, 1.0)):
            self.make.part(
                self.name(f"foot-{number + 1}"),
                middle + way * 2.0 * outer - half,
                Contour.circle((0.0, 0.0), own.foot_radius),
                PartFrame(apex, -depth, 0.0, upright=True),
            )
        reach = 2.0 * outer + half
        self.make.pin(
            self.name("foot-pin"),
            (apex, -depth),
            (middle - reach, middle + reach),
            joint=(self.body("V"), 2),
            upright=True,
        )
