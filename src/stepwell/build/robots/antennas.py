"""Parts of an antenna: the rod with its hub, the crank that displaces an anchor, its two stops."""

import math
from dataclasses import dataclass

from stepwell.base import ByValue, Vec2
from stepwell.build.build_file import mm
from stepwell.build.contour import Contour
from stepwell.build.part import Hole
from stepwell.build.plates import Fastener
from stepwell.build.robots.legs import PLACES, LegMaker
from stepwell.build.robots.making import Maker, PartFrame, ribbon
from stepwell.build.robots.plan import AntennaPlan
from stepwell.build.stack import pin_length_below
from stepwell.robot import PartRole

# From the crank's pivot along its anchor arm to the two stops [m].
STOP_AT = 8e-3
# Half the thickness of the cord [m].
CORD = 0.4e-3
# Width of a rod, and from its hub to where it is as narrow [m].
ROD, _SHOULDER = 4e-3, 8e-3


@dataclass(frozen=True, slots=True, eq=False)
class Cord(ByValue):
    """A cord in tension from the hub of an antenna to its crank.

    Attributes:
        antenna, parts: its name, and the names of its rod and its crank.
        hub, crank: bodies of its ends.
        start, end: of the cord [m], in the robot's body frame and the reference pose.
    """

    antenna: str
    parts: tuple[str, str]
    hub: str
    crank: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]

    @property
    def diameter(self) -> float:
        """Thickness of the cord [m]."""
        return 2.0 * CORD


def width(one: AntennaPlan) -> float:
    """Width of hubs and cranks [m]: the hole of a joint and a web on both sides."""
    build_file = one.plan.build_file
    return build_file.pin.diameter + build_file.pin.lever_fit + 2.0 * build_file.sheet.bridge


def antenna_parts(make: Maker, leg: LegMaker, one: AntennaPlan) -> Cord:
    """All parts of an antenna; returns its cord."""
    start = _rod(make, leg, one)
    end = _crank(make, leg, one)
    name = one.antenna.name
    parts = f"{one.label}-antenna", f"{one.label}-crank"
    return Cord(name, parts, f"{name}.antenna", f"{name}.crank", start, end)


def _rod(make: Maker, leg: LegMaker, one: AntennaPlan) -> tuple[float, float, float]:
    plan, antenna, high = one.plan, one.antenna, one.plan.heights
    own, build_file = plan.build_file.robot, plan.build_file
    px, py = antenna.pivot
    make.now("body", PartRole.PIN)
    joint = (f"{antenna.name}.antenna", 0)
    hole = build_file.pin.diameter + build_file.pin.lever_fit
    spread = high.flange if one.under else high.slide
    disc = Contour.circle((0.0, 0.0), build_file.block.edge)
    make.part(f"{one.label}-antenna-spacer", spread, disc, PartFrame(px, py))
    ends = (
        (high.under, high.rail + plan.thick) if one.under else (high.rail, high.above + plan.thick)
    )
    make.pin(f"{one.label}-hub", (px, py), ends, joint=joint)
    if one.under:
        # Flush with the body plate, over which the other antenna passes.
        make.fasteners[-1] = _lowered(make.fasteners[-1], ends[1])
    make.now(f"{antenna.name}.antenna", PartRole.ANTENNA)
    rod = antenna.angle
    arm = math.atan2(leg.leg.side * math.cos(antenna.swing / 2.0), -math.sin(antenna.swing / 2.0))
    way = arm - rod
    tip = (antenna.length, 0.0)
    hub = width(one)
    points: list[Vec2] = [
        (own.cord_arm * math.cos(way), own.cord_arm * math.sin(way)),
        (0.0, 0.0),
        (hub / 2.0, 0.0),
        (_SHOULDER, 0.0),
        tip,
    ]
    if antenna.hook > 0.0:
        bent = antenna.side * antenna.hook_angle
        points.append(
            (tip[0] + antenna.hook * math.cos(bent), tip[1] + antenna.hook * math.sin(bent))
        )
    make.part(
        f"{one.label}-antenna",
        one.base,
        ribbon(points, [hub] * 3 + [ROD] * (len(points) - 3)),
        PartFrame(px, py, rod),
        holes=[Hole((0.0, 0.0), hole, "hub"), Hole(points[0], 2.0 * CORD + 2e-4, "cord")],
    )
    return (
        px + own.cord_arm * math.cos(arm),
        py + own.cord_arm * math.sin(arm),
        one.base + plan.thick / 2.0,
    )


def _lowered(pin: Fastener, high: float) -> Fastener:
    from dataclasses import replace

    return replace(pin, low=high - (pin.high - pin.low), high=high)


def _crank(make: Maker, leg: LegMaker, one: AntennaPlan) -> tuple[float, float, float]:
    """The crank on the body's block; its stops give the displacement of the anchor."""
    plan, high, build_file = one.plan, one.plan.heights, one.plan.build_file
    name, own = one.antenna.name, one.plan.build_file.robot
    side, (x, inboard) = leg.leg.side, one.pivot
    row = leg.leg.row
    at = leg.at(x, row - inboard)
    hole = build_file.pin.diameter + build_file.pin.lever_fit
    make.now("body", PartRole.BODY)
    ends = (high.bottom, high.crank + plan.thick)
    make.pin(f"{one.label}-crank-pivot", at, ends, joint=(f"{name}.crank", 0))
    make.shims(f"{one.label}-crank-pivot", at, [high.roof], (f"{name}.crank", 0))
    half, away = one.turn / 2.0, width(one) / 2.0 + build_file.pin.diameter / 2.0
    reach = high.crank + plan.thick - high.top
    length = pin_length_below(reach)
    size = f"ISO 8734 {mm(build_file.pin.diameter)} x {mm(length)}"
    for number, way in enumerate((1.0, -1.0)):
        # The stop at rest lies outboard of the arm, the one at full displacement inboard.
        along = (-math.cos(half), way * math.sin(half))
        normal = (math.sin(half), way * math.cos(half))
        spot = leg.at(
            x + STOP_AT * along[0] + away * normal[0],
            row - inboard + STOP_AT * along[1] + away * normal[1],
        )
        make.add(
            Fastener(
                f"{one.label}-stop-{number + 1}",
                "stop",
                size,
                build_file.pin.diameter,
                "body",
                spot,
                high.top,
                high.top + length,
            )
        )
    make.now(f"{name}.crank", PartRole.CRANK)
    arm, cord = own.crank_arm, one.cord_arm
    anchor = (-arm * math.cos(half), side * arm * math.sin(half))
    end = (-cord * math.sin(half), -side * cord * math.cos(half))
    make.part(
        f"{one.label}-crank",
        high.crank,
        ribbon([end, (0.0, 0.0), anchor], [width(one)] * 3),
        PartFrame(*at),
        holes=[Hole((0.0, 0.0), hole, "pivot"), Hole(end, 2.0 * CORD + 2e-4, "cord")],
    )
    hook = (at[0] + anchor[0], at[1] + anchor[1])
    make.pin(leg.name(f"{PLACES[0]}-p"), hook, (high.crank, plan.hook_top), use="hook")
    made, own_hook = make.fasteners[-1], build_file.hook
    size = f"tube {mm(own_hook.diameter)} x {mm(own_hook.cap_width)}, {mm(own_hook.cap)} long"
    low = made.high - own_hook.cap
    make.add(Fastener(made.name, "cap", size, own_hook.cap_width, make.body, hook, low, made.high))
    return at[0] + end[0], at[1] + end[1], high.crank + plan.thick / 2.0
