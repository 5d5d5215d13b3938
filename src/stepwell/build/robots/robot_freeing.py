"""Ways out of overlaps of a robot's parts: another place, a smaller swing, shifted anchors."""

import math
from collections.abc import Iterable
from itertools import combinations

from stepwell.base import Vec2
from stepwell.build.build_file import mm
from stepwell.build.limits import ExceededLimit, rounded_up
from stepwell.build.robots.robot_layout import RobotBand, RobotLayout, robot_layout
from stepwell.build.robots.robot_sweep import RobotOverlap, SweptRobot
from stepwell.build.sweeps import compare

# Step of a shift of anchors [m], and number of steps that are tried in either direction.
_STEP, _MOST_STEPS = 5e-3, 6


def overlap_findings(
    layout: RobotLayout, overlaps: Iterable[RobotOverlap]
) -> tuple[ExceededLimit, ...]:
    """The findings of overlaps, each with the change of the design or build file that frees it."""
    shifts = _Shifts(layout)
    return tuple(_finding(layout, one, shifts) for one in overlaps)


def _finding(layout: RobotLayout, one: RobotOverlap, shifts: "_Shifts") -> ExceededLimit:
    parts = [name.rpartition(" ")[2] if name[:4] == "pin " else name for name in one.parts]
    where = [
        f"{name[0]} {_cell_name(layout, name)} from {math.degrees(low):.3g} to "
        f"{math.degrees(high):.3g} degrees"
        for name, low, high in one.ranges
        if name[0] not in ("stroke", "across")
    ]
    where += [
        f"stroke from {mm(low)} to {mm(high)} mm"
        for name, low, high in one.ranges
        if name[0] == "stroke"
    ]
    if not where and one.ranges:
        where = ["some strokes"]
    at = f" at {', '.join(where)}" if where else " at rest"
    states = f" (states {', '.join(one.states)} included)" if one.states else ""
    return ExceededLimit(
        "collision",
        one.parts,
        one.overlap,
        0.0,
        "m",
        f"{one.parts[0]} and {one.parts[1]} overlap by {mm(one.overlap)} mm{at}{states}.",
        _way_out(layout, parts, one, shifts),
    )


def _cell_name(layout: RobotLayout, name: tuple[str, int | str]) -> str:
    if name[0] == "antenna":
        return str(name[1])
    return layout.robot.leg(name[0]).chain.names[int(name[1])]


def _way_out(layout: RobotLayout, parts: list[str], one: RobotOverlap, shifts: "_Shifts") -> str:
    antennas = {f"{antenna.label}-antenna" for antenna in layout.plan.antennas} & {*parts}
    far = mm(rounded_up(one.overlap + 1e-3, 1e-3))
    if _any_with(parts, "cord"):
        aligned = mm(layout.plan.antennas[0].aligned)
        return (
            f"Move the pivots of the antennas to y = {aligned} and -{aligned} mm, where the cords "
            f"run along the body (antenna.pivot_mm)."
        )
    if len(antennas) == 2 or _any_with(parts, "hub", "spacer"):
        return f"Move the pivots of the two antennas {far} mm or more apart (antenna.pivot_mm)."
    if antennas:
        return _way_out_of_antenna(layout, parts, one, far)
    if _any_with(parts, "band", "hook") or any(part.endswith("-top") for part in parts):
        return shifts.freeing(frozenset(_owner(layout, name) for name in one.parts))
    if {"actuator", "battery", "board"} & {*parts}:
        return f"Use a smaller one, or legs {far} mm or more further from the midline (leg.at_mm)."
    return (
        f"Move the leg or the support {far} mm or more apart (leg.at_mm, body.supports_mm), or use "
        f"smaller parts in the build file."
    )


def _any_with(parts: list[str], *words: str) -> bool:
    return any(word in part for part in parts for word in words)


def _way_out_of_antenna(
    layout: RobotLayout, parts: list[str], one: RobotOverlap, far: str | float
) -> str:
    if "actuator" in parts or any(part.startswith("holder") for part in parts):
        own = layout.build_file.linear_actuator
        return (
            f"Use an actuator with a linear_actuator.closed_mm of "
            f"{mm(own.closed - rounded_up(one.overlap, 1e-3) - 1e-3)} or less, or antennas with "
            f"less swing."
        )
    swings = [low for name, low, _ in one.ranges if name[0] == "antenna"]
    if swings and min(swings) > 0.02:
        degrees = math.floor(math.degrees(min(swings)) - 1.0)
        return f"Use swing_deg = {degrees} or less for this antenna, or a pivot further ahead."
    return f"Move the pivot of this antenna {far} mm or more ahead (antenna.pivot_mm)."


class _Shifts:
    """Shifts of both anchors of a band along x of its cell: they leave q - p, and so the motion."""

    def __init__(self, layout: RobotLayout):
        self.layout = layout
        self._robots: dict[tuple[str, int, float], SweptRobot] = {}
        self._known: dict[frozenset[str], str] = {}

    def freeing(self, owners: frozenset[str]) -> str:
        """The shortest shift that frees two bodies, as an advice."""
        if owners not in self._known:
            self._known[owners] = self._shortest(owners)
        return self._known[owners]

    def _shortest(self, owners: frozenset[str]) -> str:
        layout = self.layout
        ways: list[tuple[float, str, str]] = []
        for band in layout.bands:
            if not {*band.bodies, _band_name(layout, band)} & owners:
                continue
            leg = layout.robot.leg(band.leg)
            number = band.cell % 2
            for way in (-1.0, 1.0):
                shifts = (way * steps * _STEP for steps in range(1, _MOST_STEPS + 1))
                shift = next((x for x in shifts if self._frees(band, x, owners)), None)
                if shift is not None:
                    name = f"{band.leg} {leg.chain.names[number]}"
                    p, q = (f"({mm(x)}, {mm(y)})" for x, y in self._anchors(band, shift))
                    ways.append((abs(shift), name, f"p = {p} and q = {q} mm"))
        if not ways:
            return "Use anchors of this band that are closer together, off the other part."
        _, name, anchors = min(ways)
        return (
            f"Use {anchors} for the bands of {name}: both are shifted, and the motion stays the "
            f"same."
        )

    def _frees(self, band: RobotBand, shift: float, owners: frozenset[str]) -> bool:
        """Whether two bodies never meet once the anchors of a band are shifted."""
        swept = self._shifted(band, shift)
        return all(
            result.hit is None and not result.undecided
            for pair in combinations(swept.some(owners), 2)
            for result in compare(swept, *pair)
        )

    def _shifted(self, band: RobotBand, shift: float) -> SweptRobot:
        key = band.leg, band.cell % 2, shift
        if key not in self._robots:
            p, q = self._anchors(band, shift)
            moved = self.layout.robot.with_anchors(*key[:2], p=p, q=q)
            self._robots[key] = SweptRobot(robot_layout(moved, self.layout.build_file))
        return self._robots[key]

    def _anchors(self, band: RobotBand, shift: float) -> tuple[Vec2, Vec2]:
        one = self.layout.robot.leg(band.leg).chain.levers[band.cell % 2].bands[0]
        (px, py), (qx, qy) = one.p, one.q
        return (px + shift, py), (qx + shift, qy)


def _owner(layout: RobotLayout, name: str) -> str:
    """The body of a part, a fastener, a box or a band by its name in a collision."""
    if name in layout.body:
        return layout.body[name]
    for fastener in layout.fasteners:
        if name == f"{fastener.use} {fastener.name}":
            return str(fastener.block)
    for box in layout.boxes:
        if name == box.name:
            return "rod" if name == "rod" else box.body
    return name


def _band_name(layout: RobotLayout, band: RobotBand) -> str:
    cell = layout.robot.leg(band.leg).chain.names[band.cell % 2]
    return f"band {band.number + 1} of {band.leg}.{cell}"
