"""Limits of a robot's build: rails, posts, actuator, nose, overlaps; each with a way out."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from stepwell import sequences
from stepwell.base import Floats, ReadOnly, bisected
from stepwell.build import limits
from stepwell.build.build_file import mm
from stepwell.build.layouts import layout as chain_layout
from stepwell.build.limits import ExceededLimit, rounded_up, setting
from stepwell.build.robots.antennas import ROD
from stepwell.build.robots.legs import PINS
from stepwell.build.robots.plan import AntennaPlan
from stepwell.build.robots.robot_freeing import overlap_findings
from stepwell.build.robots.robot_layout import RobotLayout, robot_layout, turned
from stepwell.build.sweeps import MotionSweep
from stepwell.robot import Robot
from stepwell.statics import Path, StaticsError

# Checks of a chain that hold for each leg: its levers, pins, hooks and bands are the same.
_OF_A_LEG = ("slack", "stretch", "bearing", "lever", "pin", "hook")
# A head-on wall that moves an anchor by more than this fraction needs no further look.
_ENOUGH = 0.9
_HALVINGS = 30
# Least displacement of a crank that is tried [m], and halvings of the range of those that fit.
_LEAST_MOVE, _ROUGHLY = 1e-3, 7
# Overlaps that are listed; a robot of wrong sizes has hundreds.
_MOST = 12


def robot_findings(
    layout: RobotLayout, paths: Mapping[str, Path], swept: MotionSweep
) -> tuple[ExceededLimit, ...]:
    """All limits that a robot exceeds, overlaps first.

    Args:
        layout: of the robot.
        paths: of a full cycle of each leg; legs without one are not checked for forces.
        swept: its sweep.
    """
    collisions = swept.collisions[:_MOST]
    return (
        *_rail(layout),
        *_hubs(layout),
        *overlap_findings(layout, collisions),
        *_post(layout),
        *robot_webs(layout),
        *limits.kerf_findings(layout),
        *limits.bed_findings(layout),
        *(one for leg in layout.robot.legs for one in _of_leg(layout, leg.name, paths)),
        *_actuator(layout, paths),
        *_nose(layout),
    )


def leg_paths(robot: Robot) -> dict[str, Path]:
    """The path of a full cycle of each leg on the bench, without ground reaction forces."""
    found: dict[str, Path] = {}
    for leg in robot.legs:
        try:
            found[leg.name] = sequences.cycle(leg.chain).path
        except StaticsError:
            continue
    return found


def peak_force(paths: Mapping[str, Path], robot: Robot) -> float:
    """Largest force of the actuator [N]: all legs at once, and the drag of the floor."""
    return sum(abs(one.peak_force) for one in paths.values()) + robot.floor.drag


def _of_leg(layout: RobotLayout, name: str, paths: Mapping[str, Path]) -> Iterator[ExceededLimit]:
    leg = layout.robot.leg(name)
    for one in limits.findings(chain_layout(leg.chain, layout.build_file), paths.get(name)):
        if one.check in _OF_A_LEG:
            yield replace(one, problem=f"{name} leg: {one.problem}")


def _rail(layout: RobotLayout) -> Iterator[ExceededLimit]:
    """The two sliders of a leg share a rail, so the pivots of the V need a distance."""
    plan, foot = layout.plan, layout.robot.foot
    build_file = layout.build_file
    # The carriage has a pin between its pivot and its slot.
    ahead = max(leg.last - leg.rear for leg in plan.legs)
    slot = PINS + build_file.pin.diameter / 2.0 + build_file.sheet.bridge + plan.slot / 2.0
    least = max(2.0 * plan.core + build_file.robot.gap, foot.span - ahead + slot)
    if foot.span >= least - 1e-7:
        return
    deepest = float(replace(foot, span=least).depth(0.0)) if least < 2.0 * foot.link else 0.0
    depth = float(foot.depth(0.0))
    span = rounded_up(least)
    link = math.sqrt(depth**2 + (span / 2.0) ** 2)
    yield ExceededLimit(
        "rail",
        ("carriage-bar", f"{plan.legs[0].label}-slider-top"),
        foot.span,
        least,
        "m",
        f"foot: it stands {mm(depth)} mm below its pivots, which are foot.span_mm = "
        f"{mm(foot.span)} apart, and the sliders of a rail need {mm(least)} mm: with links of "
        f"{mm(foot.link)} mm the rail allows a depth of {mm(deepest)} mm.",
        f"Use foot.span_mm = {mm(span)} or more; links of foot.link_mm = {mm(rounded_up(link))} "
        f"keep the depth.",
    )


def _hubs(layout: RobotLayout) -> Iterator[ExceededLimit]:
    """The hubs of two antennas need a web between their holes."""
    antennas = layout.robot.antennas
    if len(antennas) < 2:
        return
    apart = math.dist(antennas[0].pivot, antennas[1].pivot)
    pin, edge = layout.build_file.pin, layout.build_file.block.edge
    least = pin.diameter + pin.plate_fit + layout.build_file.sheet.bridge
    least = max(least, 2.0 * edge)
    aligned = layout.plan.antennas[0].aligned
    if apart < least - 1e-7:
        yield ExceededLimit(
            "antenna",
            tuple(f"{one.label}-antenna" for one in layout.plan.antennas),
            apart,
            least,
            "m",
            f"antennas {antennas[0].name} and {antennas[1].name} meet at rest: their hubs are "
            f"{mm(apart)} mm apart and {mm(2.0 * edge)} mm wide.",
            f"Move their pivots to y = {mm(aligned)} and -{mm(aligned)} mm, in line with their "
            f"cranks (antenna.pivot_mm).",
        )


def _post(layout: RobotLayout) -> Iterator[ExceededLimit]:
    """The T-foot hangs above the floor, with room for the screws that touch it."""
    high, screw = layout.plan.heights, layout.build_file.screw
    room = high.foot - high.floor
    if room < screw.head - 1e-7:
        post = layout.build_file.robot.standoff - (screw.head - room)
        value = -rounded_up(-post, 1e-3)
        yield ExceededLimit(
            "post",
            ("t-foot",),
            room,
            screw.head,
            "m",
            f"t-foot: it is {mm(room)} mm above the floor, and the heads of its screws need "
            f"{mm(screw.head)} mm.",
            f"Set {setting(layout, 'robot__standoff', value, 'mm')}.",
            ReadOnly({"robot__standoff": value}),
        )
    half = layout.build_file.robot.link_width / 2.0
    radius = layout.build_file.robot.foot_radius
    if radius <= half:
        value = rounded_up(half + 1e-3, 1e-3)
        yield ExceededLimit(
            "post",
            (f"{layout.plan.legs[0].label}-foot-1",),
            radius,
            half,
            "m",
            f"{layout.plan.legs[0].label}-foot-1: its radius is {mm(radius)} mm, and links of "
            f"{mm(2.0 * half)} mm touch the floor.",
            f"Set {setting(layout, 'robot__foot_radius', value, 'mm')}.",
            ReadOnly({"robot__foot_radius": value}),
        )


def _actuator(layout: RobotLayout, paths: Mapping[str, Path]) -> Iterator[ExceededLimit]:
    own, plan = layout.build_file.linear_actuator, layout.plan
    if own.travel < plan.stroke - 1e-9:
        value = rounded_up(plan.stroke, 1e-3)
        yield ExceededLimit(
            "actuator",
            ("carriage-bar",),
            plan.stroke,
            own.travel,
            "m",
            f"actuator {own.name}: the legs take {mm(plan.stroke)} mm of travel, and "
            f"linear_actuator.travel_mm is {mm(own.travel)}.",
            f"Use an actuator with {setting(layout, 'linear_actuator__travel', value, 'mm')}, or "
            f"legs of less travel.",
            ReadOnly({"linear_actuator__travel": value}),
        )
    need = peak_force(paths, layout.robot)
    if need > own.force:
        value = rounded_up(need, 0.01)
        yield ExceededLimit(
            "actuator",
            ("carriage-bar",),
            need,
            own.force,
            "N",
            f"actuator {own.name}: both legs and the drag of the floor take {need:.3g} N, and "
            f"linear_actuator.force_N is {own.force:.3g}.",
            f"Use an actuator with {setting(layout, 'linear_actuator__force', value, 'N')}, or "
            f"softer bands.",
            ReadOnly({"linear_actuator__force": value}),
        )


def robot_webs(layout: RobotLayout) -> Iterator[ExceededLimit]:
    """Webs of every part; of a crank's stops with the largest displacement that leaves them."""
    for one in limits.webs_findings(layout):
        crank = next(
            (own for own in layout.plan.antennas if f"{own.label}-stop-" in one.problem), None
        )
        if crank is None:
            yield one
            continue
        name, at = crank.antenna.name, layout.robot.antennas.index(crank.antenna)

        def fits(move: float, at: int = at, of: ExceededLimit = one) -> bool:
            antennas = list(layout.robot.antennas)
            antennas[at] = replace(antennas[at], moves=(-move, 0.0))
            other = robot_layout(replace(layout.robot, antennas=antennas), layout.build_file)
            return min(limits.webs_of(other.part(of.parts[0])))[0] >= of.allowed - 1e-9

        most, _ = bisected(fits, _LEAST_MOVE, crank.move, _ROUGHLY) if fits(_LEAST_MOVE) else (0, 0)
        advice = (
            f"Use a displacement of {mm(1e-4 * math.floor(1e4 * most))} mm or less for antenna "
            f"{name} (antenna.moves_mm)."
        )
        yield replace(one, advice=advice) if most else one


def _nose(layout: RobotLayout) -> Iterator[ExceededLimit]:
    """A wall straight ahead must press the antennas before it stops the nose."""
    plan, flips = layout.plan, cache(lambda: layout.robot.predict().flips)
    for one in plan.antennas:
        moved = head_on(one, plan.nose[0])
        if moved >= _ENOUGH * one.move:
            continue
        # The displacement of the anchor for the gait at full swing; 0 for the gait at rest.
        own = (flip.displacement for flip in flips() if flip.antenna == one.antenna.name)
        need = max(own, default=0.0)
        if moved >= need:
            continue
        most, _ = bisected(
            lambda x, one=one, need=need: head_on(one, x) >= need,
            float(one.antenna.pivot[0]),
            plan.nose[0],
            _HALVINGS,
        )
        yield ExceededLimit(
            "nose",
            ("body-plate", f"{one.label}-antenna"),
            plan.nose[0],
            most,
            "m",
            f"body-plate: its nose ends at x = {mm(plan.nose[0])} mm, so a wall straight ahead "
            f"moves the anchor of antenna {one.antenna.name} by {mm(moved)} mm, and its leg needs "
            f"{mm(need)} mm.",
            f"The nose must end at x = {mm(most)} mm or less: use an actuator with a shorter "
            f"linear_actuator.closed_mm, or antennas with a pivot further ahead.",
        )


def head_on(one: AntennaPlan, wall: float) -> float:
    """Displacement of an anchor [m] when a wall straight ahead at x = `wall` [m] is at rest there.

    The rod and its hook are behind the wall at that swing, or the antenna is at its stop.
    """
    antenna = one.antenna
    bent = antenna.side * antenna.hook_angle
    tip = antenna.length, 0.0
    end = tip[0] + antenna.hook * math.cos(bent), antenna.hook * math.sin(bent)

    def behind(swing: float) -> bool:
        turn = antenna.angle + antenna.side * swing
        ahead = max(turned(point, turn)[0] for point in (tip, end))
        return antenna.pivot[0] + ahead + ROD / 2.0 <= wall

    swing = antenna.swing
    if behind(swing):
        swings: Floats = np.linspace(0.0, swing, 241)
        swing = next((float(value) for value in swings if behind(float(value))), swing)
    arm = one.plan.build_file.robot.crank_arm
    turn = one.crank_turn(swing)
    return arm * (math.sin(one.turn / 2.0) - math.sin(one.turn / 2.0 - turn))
